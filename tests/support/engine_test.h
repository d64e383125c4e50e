// Suites that run once for every world in the registry. A further engine joins them unedited.
#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "backends/bundled_engines.h"
#include "backends/registry.h"
#include "scenes/scenes.h"

namespace crossgait {

class EngineTest : public ::testing::TestWithParam<std::string> {
 protected:
  static std::unique_ptr<PhysicsBackend> make(const WorldSpec& spec) { return make_world(GetParam(), spec); }
  static std::unique_ptr<PhysicsBackend> make(const scenes::RobotPtr& robot) {
    return make(scenes::world_of(robot));
  }
  /// Returns what the world declares: the only thing that a test may skip or choose by.
  static Capabilities capabilities() { return find_engine(GetParam()).info.capabilities; }
  /// Returns the distance from 1 to the engine's next number: what bounds of rounding are multiples of.
  static double eps() { return epsilon(capabilities().precision); }
};

/// Lists available engines that come with Crossgait, without those that CROSSGAIT_ENGINE_PATH adds: for tests
/// of what is stored about them.
inline std::vector<std::string> own_engines() {
  std::vector<std::string> names = available_engines();
  std::erase_if(names, [](const std::string& name) {
    return std::none_of(bundled_engines().begin(), bundled_engines().end(), [&](const BundledEngine& engine) {
      return std::find(engine.names.begin(), engine.names.end(), name) != engine.names.end();
    });
  });
  return names;
}

/// Writes "bullet:matched" as a test name: "bullet_matched".
inline std::string test_name(std::string_view world) {
  std::string name(world);
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return name;
}

inline std::string engine_of_test(const ::testing::TestParamInfo<std::string>& test) {
  return test_name(test.param);
}

/// Prints a figure for docs/parity-measurements.md (`ctest -V | grep measured`) and keeps it in the XML
/// report.
inline void measured(const std::string& what, double figure) {
  ::testing::Test::RecordProperty(what, std::to_string(figure));
  std::printf("measured %s: %s = %.3g\n", ::testing::UnitTest::GetInstance()->current_test_info()->name(),
              what.c_str(), figure);
}

}  // namespace crossgait

/// Instantiates `suite`, derived from EngineTest, for every world that is built in.
#define CROSSGAIT_FOR_EVERY_BACKEND(suite)                                                            \
  GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(suite);                                               \
  INSTANTIATE_TEST_SUITE_P(EveryEngine, suite, ::testing::ValuesIn(::crossgait::available_engines()), \
                           ::crossgait::engine_of_test)
