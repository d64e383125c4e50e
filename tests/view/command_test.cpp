// What a viewer may say, and what is refused before anything is done.
#include "view/command.h"

#include <gtest/gtest.h>

#include "tests/physics/core/config_error.h"

namespace crossgait {
namespace {

TEST(ViewCommand, SaysWhatItSays) {
  const auto drive =
      std::get<DriveCommand>(parse_view_command(R"({"do": "drive", "vx": 0.2, "vy": -0.1, "yaw_rate": 1})"));
  EXPECT_EQ(drive.velocity.vx, 0.2);
  EXPECT_EQ(drive.velocity.vy, -0.1);
  EXPECT_EQ(drive.velocity.yaw_rate, 1);
  const auto set = std::get<ParameterCommand>(
      parse_view_command(R"({"do": "set", "name": "body_height", "value": 0.06})"));
  EXPECT_EQ(set.name, "body_height");
  EXPECT_EQ(set.value, 0.06);
  const auto push = std::get<PushCommand>(parse_view_command(R"({"do": "push", "impulse": [1, -2, 0.5]})"));
  EXPECT_EQ(push.impulse, Vector3(1, -2, 0.5));
  const auto terrain = std::get<TerrainCommand>(
      parse_view_command(R"({"do": "terrain", "terrain": "rough", "seed": 18446744073709551615})"));
  EXPECT_EQ(terrain.seed, 18446744073709551615U);
  const auto engines =
      std::get<EnginesCommand>(parse_view_command(R"({"do": "engines", "engines": ["a", "b"]})"));
  EXPECT_EQ(engines.engines, (std::vector<std::string>{"a", "b"}));
  EXPECT_TRUE(std::get<PauseCommand>(parse_view_command(R"({"do": "pause", "on": true})")).on);
  EXPECT_EQ(std::get<GaitCommand>(parse_view_command(R"({"do": "gait", "gait": "walk"})")).gait, "walk");
  EXPECT_EQ(std::get<CurveCommand>(parse_view_command(R"({"do": "curve", "curve": "bezier"})")).curve,
            "bezier");
  EXPECT_FALSE(std::get<RecordCommand>(parse_view_command(R"({"do": "record", "on": false})")).on);
  EXPECT_TRUE(std::holds_alternative<StandCommand>(parse_view_command(R"({"do": "stand"})")));
}

struct Refused {
  std::string text, element;
};

TEST(ViewCommand, RefusesWhatIsNoCommand) {
  const std::vector<Refused> refused{
      {"", "JSON"},
      {"drive", "JSON"},
      {"[1]", "JSON"},
      {R"({"do": "fly"})", "do"},
      {R"({"vx": 1})", "do"},
      {R"({"do": 1})", "do"},
      {R"({"do": "drive", "vx": 1, "vy": 0})", "yaw_rate"},
      {R"({"do": "drive", "vx": "1", "vy": 0, "yaw_rate": 0})", "vx"},
      {R"({"do": "drive", "vx": 1, "vy": 0, "yaw_rate": 0, "gait": "trot"})", "gait"},
      {R"({"do": "push", "impulse": [1, 2]})", "impulse"},
      {R"({"do": "push", "impulse": [1, 2, "3"]})", "impulse"},
      {R"({"do": "push", "impulse": [1, 2, 1e999]})", "JSON"},
      {R"({"do": "terrain", "terrain": "rough", "seed": -1})", "seed"},
      {R"({"do": "terrain", "terrain": "rough", "seed": 1.5})", "seed"},
      {R"({"do": "pause", "on": 1})", "on"},
      {R"({"do": "engines", "engines": [["mujoco"]]})", "JSON"},
      {R"({"do": "engines", "engines": [[["mujoco"]]]})", "JSON"},
      {std::string(kMaxCommandBytes + 1, ' '), "JSON"},
      {std::string(kMaxCommandBytes, '['), "JSON"},
  };
  for (const auto& [text, element] : refused)
    EXPECT_EQ(config_error([&text = text] { parse_view_command(text); }).element(), element) << text;
}

}  // namespace
}  // namespace crossgait
