#include "parity/divergence.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace crossgait {

bool is_same(const PairDifference& pair) noexcept {
  const DivergenceTolerances bounds = DivergenceTolerances::exact();
  return pair.max_position_difference_m <= bounds.position && pair.max_joint_difference_rad <= bounds.joint &&
         pair.max_attitude_difference_rad <= bounds.attitude;
}

double attitude_difference(const Quaternion& a, const Quaternion& b) noexcept {
  const Quaternion relative = a.conjugate() * b;
  return 2 * std::atan2(relative.vec().norm(), std::abs(relative.w()));
}

double OneStepDifference::largest() const noexcept { return std::max({position_m, joint_rad, attitude_rad}); }

namespace {

double load_difference(const TraceSample& a, const TraceSample& b) {
  double largest = 0;
  for (const Leg leg : kLegs) largest = std::max(largest, std::abs(a.load[leg] - b.load[leg]));
  return largest;
}

double torque_difference(const TraceSample& a, const TraceSample& b) {
  if (a.torques.size() == 0 || a.torques.size() != b.torques.size()) return 0;
  return (a.torques - b.torques).lpNorm<Eigen::Infinity>();
}

}  // namespace

double compare_samples(const TraceSample& a, const TraceSample& b, PairDifference& result) {
  const DivergenceTolerances& tolerances = result.tolerances;
  const RobotState& sa = a.state;
  const RobotState& sb = b.state;
  const double position = (sa.p_WB - sb.p_WB).norm();
  const double joint = sa.q.size() > 0 ? (sa.q - sb.q).lpNorm<Eigen::Infinity>() : 0.0;
  const double attitude = attitude_difference(sa.q_WB, sb.q_WB);
  result.max_position_difference_m = std::max(result.max_position_difference_m, position);
  result.max_joint_difference_rad = std::max(result.max_joint_difference_rad, joint);
  result.max_attitude_difference_rad = std::max(result.max_attitude_difference_rad, attitude);
  result.parting.add(sa, sb);
  const double largest = std::max({position, joint, attitude});
  if (result.first_divergence) return largest;

  struct Check {
    const char* quantity;
    double difference, tolerance;
  };
  const std::array<Check, 5> checks{{{"joint", joint, tolerances.joint},
                                     {"attitude", attitude, tolerances.attitude},
                                     {"position", position, tolerances.position},
                                     {"load", load_difference(a, b), tolerances.load},
                                     {"torque", torque_difference(a, b), tolerances.torque}}};
  // Where several leave in the same step, the one that overshoots its tolerance most is named.
  const auto worst = std::max_element(checks.begin(), checks.end(), [](const Check& x, const Check& y) {
    return x.difference / x.tolerance < y.difference / y.tolerance;
  });
  if (worst->difference > worst->tolerance) {
    result.first_divergence = FirstDivergence{worst->quantity, sa.time, worst->tolerance};
  }
  return largest;
}

void compare_traces(const Trace& a, const Trace& b, PairDifference& result) {
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    static_cast<void>(compare_samples(a[i], b[i], result));
}

PairDifference compare_traces(const Trace& a, const Trace& b, const DivergenceTolerances& tolerances) {
  PairDifference result;
  result.tolerances = tolerances;
  compare_traces(a, b, result);
  return result;
}

}  // namespace crossgait
