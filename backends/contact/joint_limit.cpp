#include "backends/contact/joint_limit.h"

#include <algorithm>

#include "backends/contact/law_factors.h"
#include "physics/robot/multibody.h"

namespace crossgait::contact {

std::vector<LimitedJoint> limited_joints(const WorldSpec& spec) {
  const JointVector inverse_weights = joint_inverse_weights(*spec.robot, spec.fixed_base);
  std::vector<LimitedJoint> joints;
  for (int i = 0; i < spec.robot->joint_count(); ++i) {
    const Joint& joint = spec.robot->joint(i);
    if (joint.limited)
      joints.push_back(
          {i, joint.lower, joint.upper, inverse_weights[i], SoftLaw(joint.limit_softness, spec.physics_dt)});
  }
  return joints;
}

std::optional<LimitRow> limit_row(const LimitedJoint& joint, bool hard, double angle, double speed,
                                  double next_speed, double step) noexcept {
  // Contacts may yet push a joint that far in the step: what is left out has no impulse.
  constexpr double kReach = 0.05;  // rad
  const double to_lower = angle - joint.lower, to_upper = joint.upper - angle;
  const double ahead = step * next_speed;
  const bool is_lower = hard ? to_lower + ahead < to_upper - ahead : to_lower < to_upper;
  const double gap = is_lower ? to_lower : to_upper, away = is_lower ? 1 : -1;
  if (hard) {
    if (gap + away * ahead > kReach) return std::nullopt;
    const double target = gap > 0 ? -gap / step : std::min(-kLimitReduction * gap / step, kFastestReturn);
    return LimitRow{away, 0, target};
  }
  if (gap >= 0) return std::nullopt;
  const double imp = joint.law.impedance(gap);
  return LimitRow{away, SoftLaw::regularization(imp, joint.inverse_weight),
                  joint.law.target_velocity(away * speed, imp, gap)};
}

}  // namespace crossgait::contact
