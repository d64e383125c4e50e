// Two engines of one contact law in step.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "conformance/in_step.h"
#include "tests/support/engine_test.h"

namespace crossgait {

using conformance::Difference;
using conformance::Targets;
inline constexpr double kLength = conformance::kSameLength, kAngle = conformance::kSameAngle,
                        kForce = conformance::kSameForce;

struct Pair {
  std::string a, b;
};

/// Lists every two engines of `names` that `choose(laws of a, of b)`.
template <typename Choose>
std::vector<Pair> pairs_of(Choose choose, const std::vector<std::string>& names = available_engines()) {
  const auto laws = [](const std::string& name) { return find_engine(name).info.laws; };
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < names.size(); ++i) {
    for (std::size_t k = i + 1; k < names.size(); ++k) {
      if (choose(laws(names[i]), laws(names[k]))) pairs.push_back({names[i], names[k]});
    }
  }
  return pairs;
}

inline std::string pair_name(const ::testing::TestParamInfo<Pair>& test) {
  return test_name(test.param.a) + "_and_" + test_name(test.param.b);
}

class MatchedPair : public ::testing::TestWithParam<Pair> {
 protected:
  /// Runs both worlds from `start` (home if null) under the same targets.
  static Difference run(const WorldSpec& spec, const RobotState* start, const Targets& targets,
                        double seconds) {
    const Difference result = conformance::run_in_step(find_engine(GetParam().a), find_engine(GetParam().b),
                                                       spec, start, targets, seconds);
    measured("position, m", result.position);
    measured("joints, rad", result.joints);
    measured("attitude, rad", result.attitude);
    measured("contact force, N", result.force);
    return result;
  }

  static RobotState home_of(const WorldSpec& spec) { return make_world(GetParam().a, spec)->home_state(); }

  static Difference trot(const WorldSpec& spec, double seconds) {
    const scenes::Trot gait(*spec.robot);
    return run(
        spec, nullptr, [&](double t) { return gait.targets(t); }, scenes::Trot::kStand + seconds);
  }

  static void expect_same(const Difference& d, int contacts) {
    EXPECT_LT(d.position, kLength);
    EXPECT_LT(d.joints, kAngle);
    EXPECT_LT(d.attitude, kAngle);
    EXPECT_LT(d.force, kForce);
    EXPECT_EQ(d.counts, 0);
    EXPECT_GE(d.most_contacts, contacts);
  }
  static void expect_walk(const Difference& d) { expect_same(d, 4); }
};
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(MatchedPair);

/// Lists the available engines, and with them the ends of families: a release of an engine without what it
/// changed in laws is one.
inline std::vector<std::string> engines_and_ends() {
  std::vector<std::string> names = available_engines();
  for (const EngineFamily& family : engine_families()) {
    for (const std::string& end : {family.from, family.to}) {
      if (std::find(names.begin(), names.end(), end) == names.end()) names.push_back(end);
    }
  }
  return names;
}

inline bool is_float32(const std::string& name) {
  return find_engine(name).info.capabilities.precision == Precision::kFloat32;
}

/// Lists pairs of the same laws; those of which one rounds to float32, or those of which none does.
inline std::vector<Pair> matched_pairs(bool float32 = false) {
  std::vector<Pair> pairs = pairs_of([](const Laws& a, const Laws& b) { return a == b; }, engines_and_ends());
  std::erase_if(pairs, [&](const Pair& p) { return (is_float32(p.a) || is_float32(p.b)) != float32; });
  return pairs;
}

}  // namespace crossgait
