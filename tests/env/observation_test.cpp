#include "env/observation.h"

#include <algorithm>
#include <set>

#include "physics/core/error.h"
#include "tests/physics/core/config_error.h"
#include "tests/support/engine_test.h"
#include "tests/support/environments.h"

namespace crossgait {
namespace {

EnvConfig adapting(std::size_t parameters, bool terrain) {
  EnvConfig config;
  config.adapt = {"step_height", "step_length",  "cycle_time",
                  "body_height", "stance_width", "foot_clearance"};
  config.adapt.resize(parameters);
  if (terrain) config.observation.emplace_back("terrain");
  return config;
}

class Layouts : public EngineTest {};
CROSSGAIT_FOR_EVERY_BACKEND(Layouts);

TEST_P(Layouts, HaveTheGuidesSizesAndOneNamePerNumber) {
  for (const std::size_t parameters : {std::size_t{4}, std::size_t{5}, std::size_t{6}}) {
    for (const bool terrain : {false, true}) {
      const QuadrupedEnv env(adapting(parameters, terrain), find_engine(GetParam()));
      EXPECT_EQ(env.action_size(), parameters + 12);                           // 16, 17, 18
      EXPECT_EQ(env.observation_size(), 65 + parameters + (terrain ? 8 : 0));  // 69, 70, 71; 77, ...
      std::set<std::string> names;
      for (const Layout* layout : {&env.action_layout(), &env.observation_layout()}) {
        for (const LayoutEntry& entry : layout->entries) {
          EXPECT_TRUE(names.insert(entry.name).second) << entry.name;
          EXPECT_LT(entry.min, entry.max) << entry.name;
          EXPECT_FALSE(entry.unit.empty()) << entry.name;
        }
      }
      EXPECT_EQ(env.action_layout().entries.front().name, "delta.step_height");
      EXPECT_EQ(env.action_layout().entries[parameters].name, "residual.FL.x");
      EXPECT_EQ(env.action_layout().entries.back().name, "residual.RR.z");
    }
  }
}

TEST_P(Layouts, ReadAsWhatTheirNamesSay) {
  EnvConfig config = adapting(4, true);
  config.terrain = "rough";
  for (const ObservationBlock& block : observation_blocks()) {
    if (!block.standard && block.name != "terrain") scenes::observe(config, block.name);
  }
  config.command = VelocityCommand{0.1, 0.02, 0.3};
  QuadrupedEnv env(config, find_engine(GetParam()));
  std::vector<double> seen(env.observation_size());
  env.reset(1, seen);
  Random random(1);
  std::vector<double> action;
  for (int i = 0; i < 200; ++i) {
    action = scenes::random_action(random, env.action_size());
    ASSERT_FALSE(env.step(action, seen).done());
  }
  const auto at = [&](const std::string& name) {
    const auto index = env.observation_layout().find(name);
    EXPECT_TRUE(index) << name;
    return seen.at(index.value_or(0));
  };
  const RobotState& state = env.world().state();
  EXPECT_EQ(at("p_WB.z"), state.p_WB.z());
  EXPECT_EQ(at("q_WB.w"), state.q_WB.w());
  EXPECT_EQ(at("q_WB.x"), state.q_WB.x());
  EXPECT_EQ(at("v_WB.y"), state.v_WB.y());
  EXPECT_EQ(at("w_WB.x"), state.w_WB.x());
  const RobotDescription& robot = env.world().robot();
  for (const int i : robot.actuated_joints()) {
    EXPECT_EQ(at("q." + robot.joint(i).name), state.q[i]);
    EXPECT_EQ(at("qd." + robot.joint(i).name), state.qd[i]);
  }
  EXPECT_EQ(at("p_WF.RL.z"), env.feet().p_WF[Leg::RL].z());
  EXPECT_EQ(at("v_WF.FR.x"), env.feet().v_WF[Leg::FR].x());
  for (const Leg leg : kLegs)
    EXPECT_EQ(at("contact." + std::string(name(leg))), env.info().contacts[leg].touching ? 1 : 0);
  const ParameterRow& row = find_parameter("body_height");
  EXPECT_EQ(at("param.body_height"), row.normalise(env.info().parameters->body_height));
  const double yaw = roll_pitch_yaw(state.q_WB).z();
  const Terrain& ground = env.world().spec().terrain;
  EXPECT_NEAR(at("terrain.front"),
              ground.height(state.p_WB.x() + 0.15 * std::cos(yaw), state.p_WB.y() + 0.15 * std::sin(yaw)),
              1e-15);
  const std::pair<const char*, double> ring[] = {
      {"front", 0},  {"front_left", 45},   {"left", 90},   {"back_left", 135},
      {"back", 180}, {"back_right", -135}, {"right", -90}, {"front_right", -45}};
  for (const auto& [place, degrees] : ring) {
    const double angle = yaw + degrees * M_PI / 180;
    EXPECT_NEAR(
        at(std::string("terrain.") + place),
        ground.height(state.p_WB.x() + 0.15 * std::cos(angle), state.p_WB.y() + 0.15 * std::sin(angle)),
        1e-12)
        << place;
  }
  for (const char* place :
       {"front", "front_right", "right", "back_right", "back", "back_left", "left", "front_left"}) {
    // The ray test of an engine is exact to 2e-6 m (design, parity-measurements.md).
    EXPECT_NEAR(at(std::string("engine_terrain.") + place), at(std::string("terrain.") + place), 2e-6);
    EXPECT_EQ(at(std::string("terrain_local.") + place),
              at(std::string("terrain.") + place) - ground.height(state.p_WB.x(), state.p_WB.y()));
  }
  EXPECT_EQ(at("command.vy"), 0.02);
  EXPECT_NEAR(std::atan2(at("phase.sin"), at("phase.cos")),
              std::remainder(2 * M_PI * env.gait()->phase(), 2 * M_PI), 1e-12);
  EXPECT_NEAR(at("gravity_B.z"), -state.q_WB.toRotationMatrix()(2, 2), 1e-12);
  EXPECT_NEAR(at("v_B.x"), state.q_WB.toRotationMatrix().col(0).dot(state.v_WB), 1e-12);
  EXPECT_NEAR(at("w_B.z"), state.q_WB.toRotationMatrix().col(2).dot(state.w_WB), 1e-12);
  EXPECT_EQ(at("height"), state.p_WB.z() - ground.height(state.p_WB.x(), state.p_WB.y()));
  EXPECT_EQ(at("last.residual.FL.x"), action[4]);
  for (const LayoutEntry& entry : env.observation_layout().entries) {
    EXPECT_GE(at(entry.name), entry.min - 1e-9) << entry.name;  // a unit quaternion's rounding
    EXPECT_LE(at(entry.name), entry.max + 1e-9) << entry.name;
  }
}

TEST_P(Layouts, TheHashTellsThemApart) {
  std::set<std::string> hashes;
  for (const std::size_t parameters : {std::size_t{4}, std::size_t{5}, std::size_t{6}}) {
    for (const bool terrain : {false, true}) {
      const QuadrupedEnv env(adapting(parameters, terrain), find_engine(GetParam()));
      hashes.insert(layout_hash(env.observation_layout(), env.action_layout()));
    }
  }
  EXPECT_EQ(hashes.size(), 6U);
  EXPECT_EQ(layout_difference({"a", "b"}, {"a", "c"}), "entry 1 is c, expected b");
  EXPECT_EQ(layout_difference({"a", "b"}, {"a"}),
            "has 1 entries where 2 were expected; entry 1 is none, expected b");
  EXPECT_EQ(layout_difference({"a"}, {"a"}), "");
}

TEST_P(Layouts, OfARobotOfAnotherSizeAreOfItsSize) {
  EnvConfig config;
  config.robot = "serial_quadruped";
  config.terrain = "rough";
  config.observation.emplace_back("terrain");
  QuadrupedEnv env(config, find_engine(GetParam()));
  std::vector<double> seen(env.observation_size());
  env.reset(1, seen);
  const std::vector<double> nothing(env.action_size(), 0);
  while (env.world().state().time < 3) ASSERT_FALSE(env.step(nothing, seen).terminated);
  const RobotState& state = env.world().state();
  const double scale = 0.288 / 0.062, yaw = roll_pitch_yaw(state.q_WB).z();
  EXPECT_DOUBLE_EQ(env.info().parameters->body_height, 0.062 * scale);
  EXPECT_GT(state.p_WB.x(), 0.5) << "two and a half seconds of .5 m/s, but for the start";
  const double x = state.p_WB.x() + 0.15 * scale * std::cos(yaw),
               y = state.p_WB.y() + 0.15 * scale * std::sin(yaw);
  EXPECT_NEAR(seen.at(env.observation_layout().find("terrain.front").value()),
              env.world().spec().terrain.height(x, y), 1e-12);
  // A full step of a parameter that adapts is as much larger.
  std::vector<double> up = nothing;
  up[0] = 1;
  const double before = env.info().parameters->step_height;
  ASSERT_FALSE(env.step(up, seen).terminated);
  EXPECT_NEAR(env.info().parameters->step_height - before, find_parameter("step_height").delta_scale * scale,
              1e-12);
}

TEST(ObservationBlocks, SayWhatTheyAre) {
  for (const ObservationBlock& block : observation_blocks()) EXPECT_FALSE(block.help.empty()) << block.name;
}

TEST(ObservationBlocks, UnknownNamesListTheKnown) {
  const ConfigError error = config_error([] { (void)find_observation_block("smell"); });
  EXPECT_EQ(error.found(), "'smell'");
  for (const ObservationBlock& block : observation_blocks())
    EXPECT_NE(error.expected().find(block.name), std::string::npos) << error.expected();
  for (const ObservationBlock& block : observation_blocks())
    EXPECT_EQ(&find_observation_block(block.name), &block);
}

}  // namespace
}  // namespace crossgait
