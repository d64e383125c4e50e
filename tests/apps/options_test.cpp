// What is typed reaches what is made of it: one option at a time, in the behaviour and in the motion.
#include <algorithm>
#include <ostream>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "backends/registry.h"
#include "tests/apps/run_program.h"

namespace crossgait {
namespace {

using nlohmann::json;

// A brief walk, on ground where a seed matters, with an option that takes the place of its own.
std::string walk_with(const std::string& typed) {
  std::string command = "walk";
  for (const std::string usual : {"--terrain rough", "--seconds .3", "--settle .1"}) {
    const bool replaced = typed.substr(0, typed.find(' ')) == usual.substr(0, usual.find(' '));
    command += " " + (replaced ? typed : usual);
  }
  return command.find(typed) == std::string::npos ? command + " " + typed : command;
}

struct WalkOption {
  std::string typed;
  std::string place;      ///< in the provenance's behaviour, as a JSON pointer
  json value;             ///< that stands there then, and not without the option
  bool in_motion = true;  ///< whether it moves otherwise with it
};
std::ostream& operator<<(std::ostream& out, const WalkOption& option) { return out << option.typed; }

class OptionsOfAWalk : public testing::TestWithParam<WalkOption> {
 protected:
  static void SetUpTestSuite() { plain_ = run_json(walk_with("")); }
  static json plain_;
};
json OptionsOfAWalk::plain_;

TEST_P(OptionsOfAWalk, ReachIt) {
  ASSERT_FALSE(available_engines().empty());
  const auto& [typed, place, value, in_motion] = GetParam();
  const json walk = run_json(walk_with(typed));
  const json::json_pointer at(place);
  EXPECT_NE(plain_["provenance"]["behaviour"].at(at), value) << "says nothing: it is so without the option";
  EXPECT_EQ(walk["provenance"]["behaviour"].at(at), value);
  EXPECT_EQ(walk["final_position_m"] != plain_["final_position_m"], in_motion) << walk["final_position_m"];
}

INSTANTIATE_TEST_SUITE_P(
    OneByOne, OptionsOfAWalk,
    testing::Values(
        WalkOption{"--robot scara_quadruped_long", "/robot/name", "scara_quadruped_long"},
        WalkOption{"--terrain waves", "/terrain", "waves"}, WalkOption{"--seed 7", "/terrain_seed", 7},
        WalkOption{"--physics-dt .0005", "/physics_dt", 5e-4},
        WalkOption{"--friction .2", "/contact/friction/0", .2},
        WalkOption{"--contact impratio=10", "/contact/impratio/0", 10.0},
        WalkOption{"--gait walk", "/gait", "walk"},
        WalkOption{"--set step_length=.02", "/parameters/step_length", .02},
        WalkOption{"--speed .1", "/command", {{"vx", .1}, {"vy", 0}, {"yaw_rate", 0}}},
        WalkOption{"--command .1,.05,.2", "/command", {{"vx", .1}, {"vy", .05}, {"yaw_rate", .2}}},
        WalkOption{"--seconds .2", "/seconds", .2}, WalkOption{"--control-dt .001", "/control_dt", .001},
        WalkOption{"--settle .3", "/settle_seconds", .3},
        // It does not fall: nothing ends early.
        WalkOption{"--terminations fell", "/terminations", {"diverged", "fell"}, false},
        WalkOption{"--no-compensation", "/compensation", false},
        WalkOption{"--no-heading-hold", "/heading_hold", false}),
    [](const auto& test) {
      std::string name = test.param.place.substr(1);
      std::replace(name.begin(), name.end(), '/', '_');
      return name + "_" + std::to_string(test.index);
    });

// Sorted, to tell two YAML files apart by their lines.
std::vector<std::string> sorted_lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  std::sort(lines.begin(), lines.end());
  return lines;
}

std::vector<std::string> lines_added(const std::string& before, const std::string& after) {
  const std::vector<std::string> a = sorted_lines(before), b = sorted_lines(after);
  std::vector<std::string> added;
  std::set_difference(b.begin(), b.end(), a.begin(), a.end(), std::back_inserter(added));
  return added;
}

struct EnvOption {
  std::string typed;
  std::vector<std::string> lines;  ///< what is then new in the environment's YAML, sorted; and nothing else
};

// A gait brings parameters of its own, and a robot their sizes: these are looked at elsewhere.
TEST(OptionsOfAnEnvironment, ChangeWhatTheyNameAndNothingElse) {
  const std::string plain = run_program("env --yaml").out;
  std::vector<EnvOption> options{
      {"--terrain rough", {"terrain: 'rough'"}},
      {"--terrain-seed 9", {"terrain_seed: 9"}},
      {"--set step_length=.02", {"  step_length: 0.02"}},
      {"--set physics_dt=.0005", {"physics_dt: 0.0005"}},
      {"--set 'command={vx: .1}'", {"command: {vx: 0.1, vy: 0, yaw_rate: 0}"}},
      {"--adapt cycle_time", {"adapt: [cycle_time]"}},
      {"--residual-scale .02", {"residual_scale: 0.02"}},
      {"--policy-dt .02", {"policy_dt: 0.02"}},
      {"--friction .4", {"friction: 0.4"}},
      {"--episode-seconds 3", {"episode_seconds: 3"}},
      {"--command .1,.2,.3", {"command: {vx: 0.1, vy: 0.2, yaw_rate: 0.3}"}},
  };
  for (const std::string& engine : available_engines()) {
    const bool quoted = engine.find('@') != std::string::npos;
    if (engine != available_engines().front())
      options.push_back({"--engine " + engine, {"engine: " + (quoted ? "'" + engine + "'" : engine)}});
  }
  for (const auto& [typed, lines] : options) {
    const ProgramResult changed = run_program("env --yaml " + typed);
    EXPECT_EQ(changed.exit_code, 0) << typed << ": " << changed.err;
    EXPECT_EQ(lines_added(plain, changed.out), lines) << typed;
  }
}

TEST(OptionsOfAnEnvironment, SetKeysOfAPolicysEnvironment) {
  const std::string base = "walk --policy serial_joints --seconds .1 ";
  const json finer = run_json(base + "--set physics_dt=.0005"), plain = run_json(base);
  EXPECT_EQ(finer["physics_steps"], 2 * plain["physics_steps"].get<int>());  // of 1 ms otherwise
  const ProgramResult unknown = run_program(base + "--set physics_td=.0005");
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_NE(unknown.err.find("physics_dt"), std::string::npos) << unknown.err;
  const ProgramResult of_gait = run_program(base + "--set step_length=.05");
  EXPECT_EQ(of_gait.exit_code, 2);
  EXPECT_NE(of_gait.err.find("an environment whose actions adapt a gait"), std::string::npos) << of_gait.err;
}

}  // namespace
}  // namespace crossgait
