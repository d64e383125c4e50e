// The environment on engines that declare MuJoCo's contact law: the same observations to 1e-10 over 1000
// random actions. And a golden trajectory for every set of laws, against changes that nobody meant.
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>

#include <fmt/ranges.h>

#include "physics/core/text.h"
#include "tests/support/engine_test.h"
#include "tests/support/environments.h"

namespace crossgait {
namespace {

EnvConfig blocks_on(const std::string& terrain, bool (*with)(const ObservationBlock&)) {
  EnvConfig config;
  config.terrain = terrain;
  config.observation.clear();
  for (const ObservationBlock& block : observation_blocks()) {
    // A ray test is the engine's own and exact to 2e-6 m only.
    if (block.name != "engine_terrain" && with(block)) scenes::observe(config, block.name);
  }
  return config;
}

// Joint targets at 50 Hz of one of the bundled robots, no further from home than it can stand.
EnvConfig commanded_joints(const std::string& robot) {
  EnvConfig config = joint_environment();
  config.robot = robot;
  config.joints.scale.all = 0.1;
  return config;
}

/// Names of engines of the first one's laws.
std::vector<std::string> matched_engines() {
  std::vector<std::string> matched;
  for (const std::string& name : available_engines()) {
    if (find_engine(name).info.laws == find_engine(available_engines().front()).info.laws)
      matched.push_back(name);
  }
  return matched;
}

struct SeenDifference {
  double worst = 0;
  std::string where;
};

/// Of what two engines see under the same random actions.
SeenDifference largest_difference(const EnvConfig& config, const std::vector<std::string>& engines,
                                  int steps) {
  const auto exact = [](const std::string& name) {
    // So that what differs is not where an iteration stopped.
    return with_change(find_engine(name), [](WorldSpec& world) { world.solver.tolerance = 1e-12; });
  };
  QuadrupedEnv a(config, exact(engines[0])), b(config, exact(engines[1]));
  std::vector<double> x(a.observation_size()), y(x.size());
  a.reset(1, x);
  b.reset(1, y);
  Random random(3);
  SeenDifference difference;
  for (int i = 0; i < steps; ++i) {
    const std::vector<double> action = scenes::random_action(random, a.action_size());
    const StepResult result = a.step(action, x), other = b.step(action, y);
    EXPECT_EQ(result.done(), other.done());
    if (result.done()) break;
    for (std::size_t k = 0; k < x.size(); ++k) {
      if (std::abs(x[k] - y[k]) <= difference.worst) continue;
      difference = {std::abs(x[k] - y[k]),
                    a.observation_layout().entries[k].name + " in step " + std::to_string(i)};
    }
  }
  return difference;
}

TEST(EnvironmentParity, MatchedEnginesSeeTheSame) {
  const std::vector<std::string> engines = matched_engines();
  if (engines.size() < 2) GTEST_SKIP() << "no two engines declare the same contact law";
  for (const char* terrain : {"flat", "rough"}) {
    const SeenDifference difference =
        largest_difference(blocks_on(terrain, [](const ObservationBlock&) { return true; }), engines, 1000);
    measured(std::string(terrain) + ", largest difference of an observation", difference.worst);
    // Measured 5.4e-12 (rates of joints, rad/s); twenty times that.
    EXPECT_LT(difference.worst, 1e-10) << difference.where;
  }
}

TEST(EnvironmentParity, MatchedEnginesSeeTheSameUnderJointActions) {
  const std::vector<std::string> engines = matched_engines();
  if (engines.size() < 2) GTEST_SKIP() << "no two engines declare the same contact law";
  for (const char* robot : {"scara_quadruped", "serial_quadruped"}) {
    const SeenDifference difference = largest_difference(commanded_joints(robot), engines, 100);
    measured(std::string(robot) + ", largest difference under joint actions", difference.worst);
    EXPECT_LT(difference.worst, 1e-10) << difference.where;  // measured 3.5e-13 in 2 s
  }
}

/// What is recorded: of motion, targets and ground. Blocks of settings, and those that say in other numbers
/// what these do, are not of it.
bool is_recorded(const ObservationBlock& block) {
  const std::set<std::string_view> in_other_numbers{"joint_targets", "base_orientation_xyzw",
                                                    "roll_pitch_yaw"};
  return scenes::needs_no_setting(block) && !in_other_numbers.contains(block.name);
}

/// What is recorded, by the names of its entries, and an observation every 25 steps of 200 under fixed
/// actions.
struct Recording {
  std::vector<std::string> names;
  std::vector<std::vector<double>> lines;
};

Recording golden_run(const std::string& world) {
  QuadrupedEnv env(blocks_on("rough", is_recorded), find_engine(world));
  Recording out;
  for (const LayoutEntry& entry : env.observation_layout().entries) out.names.push_back(entry.name);
  std::vector<double> seen(env.observation_size());
  env.reset(1, seen);
  out.lines.push_back(seen);
  Random random(4);
  for (int i = 1; i <= 200; ++i) {
    std::vector<double> action = scenes::random_action(random, env.action_size());
    for (double& a : action) a *= 0.3;
    env.step(action, seen);
    if (i % 25 == 0) out.lines.push_back(seen);
  }
  return out;
}

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> out;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) out.push_back(cell);
  return out;
}

void write_golden(const std::string& path, const Recording& run) {
  std::ofstream out(path);
  out.precision(12);
  out << fmt::format("{}\n", fmt::join(run.names, ","));
  for (const auto& line : run.lines) {
    for (std::size_t k = 0; k < line.size(); ++k) out << (k == 0 ? "" : ",") << line[k];
    out << "\n";
  }
}

/// Engines of the same laws see the same: "contact-mujoco_loops-mujoco".
std::string name_of(const Laws& laws) {
  return test_name("contact " + laws.contact) + "-" + test_name("loops " + laws.loops);
}

class GoldenObservations : public EngineTest {};
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(GoldenObservations);
INSTANTIATE_TEST_SUITE_P(EveryEngine, GoldenObservations, ::testing::ValuesIn(own_engines()), engine_of_test);

// Meant changes of physics, gait or layout: run with CROSSGAIT_WRITE_GOLDEN=1 and look at the difference.
TEST_P(GoldenObservations, AreAsRecorded) {
  // 400 ms of contact make 1e-6 of the last bit of another machine's float64, and something else of
  // float32's.
  if (capabilities().precision != Precision::kFloat64)
    GTEST_SKIP() << "needs: Capabilities::precision is float64";
  const std::string path =
      CROSSGAIT_SOURCE_DIR "/tests/parity/golden/" + name_of(find_engine(GetParam()).info.laws) + ".csv";
  const Recording run = golden_run(GetParam());
  if (std::getenv("CROSSGAIT_WRITE_GOLDEN") != nullptr) return write_golden(path, run);
  std::istringstream in(read_text_file(path, kTraceBudget));
  std::string text;
  ASSERT_TRUE(std::getline(in, text)) << path;
  const std::vector<std::string> recorded = cells_of(text);
  for (std::size_t i = 0; i < run.lines.size(); ++i) {
    ASSERT_TRUE(std::getline(in, text)) << path << " ends at line " << i;
    const std::vector<std::string> cells = cells_of(text);
    ASSERT_EQ(cells.size(), recorded.size()) << path << " line " << i + 2;
    for (std::size_t k = 0; k < cells.size(); ++k) {
      // By name: a block that came after the recording is not of it.
      const auto entry = std::find(run.names.begin(), run.names.end(), recorded[k]);
      ASSERT_NE(entry, run.names.end()) << recorded[k] << " is not observed any more";
      const std::optional<double> expected = parse_number(cells[k]);
      ASSERT_TRUE(expected) << cells[k];
      // Another machine's sine may differ in the last bit; 400 ms of contact make at most this of it.
      ASSERT_NEAR(run.lines[i][static_cast<std::size_t>(entry - run.names.begin())], *expected,
                  1e-6 * (1 + std::abs(*expected)))
          << recorded[k] << " of line " << i + 2;
    }
  }
  EXPECT_FALSE(std::getline(in, text)) << path << " is longer";
}

}  // namespace
}  // namespace crossgait
