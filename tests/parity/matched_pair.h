// Two engines of one contact law in step.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "crossgait/tests/support/backend_test.h"

namespace crossgait {

// Matched engines differ by rounding alone, at a solver tolerance of 1e-12. Measured over all scenes
// here: 1.2e-13 m (a minute's trot), 3.1e-12 rad (soft contacts), 4.7e-11 N of 7 (falls). A hundred times
// that, for other compilers and processors, up to the next power of ten.
inline constexpr double kLength = 1e-10, kAngle = 1e-9, kForce = 1e-8;

struct Pair {
  std::string a, b;
};

/// Every two engines of `names` that `choose(laws of a, of b)`.
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

/// Largest differences over a run.
struct Difference {
  double position = 0;  ///< of the base, m
  double joints = 0;    ///< rad
  double attitude = 0;  ///< rad
  double force = 0;     ///< of all contacts together, N
  int counts = 0;       ///< steps with another number of contacts
  int most_contacts = 0;
};

using Targets = std::function<JointTargets(double time)>;

class MatchedPair : public ::testing::TestWithParam<Pair> {
 protected:
  /// Runs both worlds from `start` (home if null) under the same targets.
  static Difference run(WorldSpec spec, const RobotState* start, const Targets& targets, double seconds) {
    spec.solver.tolerance = 1e-12;
    const auto a = make_backend(GetParam().a, spec), b = make_backend(GetParam().b, spec);
    if (start != nullptr) a->reset(*start);
    if (start != nullptr) b->reset(*start);
    Difference result;
    const long steps = std::lround(seconds / spec.physics_dt);
    for (long i = 0; i < steps; ++i) {
      const JointTargets now = targets(static_cast<double>(i) * spec.physics_dt);
      EXPECT_EQ(a->step(now), StepStatus::kOk);
      EXPECT_EQ(b->step(now), StepStatus::kOk);
      if (HasFailure()) break;
      add(*a, *b, result);
    }
    measured("position, m", result.position);
    measured("joints, rad", result.joints);
    measured("attitude, rad", result.attitude);
    measured("contact force, N", result.force);
    return result;
  }

  static void add(const PhysicsBackend& a, const PhysicsBackend& b, Difference& result) {
    const RobotState &x = a.state(), &y = b.state();
    result.position = std::max(result.position, (x.p_WB - y.p_WB).norm());
    if (x.q.size() > 0) result.joints = std::max(result.joints, (x.q - y.q).lpNorm<Eigen::Infinity>());
    result.attitude = std::max(result.attitude, x.q_WB.angularDistance(y.q_WB));
    Vector3 difference = Vector3::Zero();
    for (const Contact& c : a.contacts()) difference += c.force;
    for (const Contact& c : b.contacts()) difference -= c.force;
    result.force = std::max(result.force, difference.norm());
    if (a.contacts().count != b.contacts().count) ++result.counts;
    result.most_contacts = std::max(result.most_contacts, a.contacts().count);
  }

  static RobotState home_of(const WorldSpec& spec) { return make_backend(GetParam().a, spec)->home_state(); }

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

/// Ends of families count along: a release of an engine without what it changed in the laws is one.
inline std::vector<Pair> matched_pairs() {
  std::vector<std::string> names = available_engines();
  for (const EngineFamily& family : engine_families()) {
    for (const std::string& end : {family.from, family.to}) {
      if (std::find(names.begin(), names.end(), end) == names.end()) names.push_back(end);
    }
  }
  return pairs_of([](const Laws& a, const Laws& b) { return a == b; }, names);
}

}  // namespace crossgait
