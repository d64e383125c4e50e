#include "motion/foot_states.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "physics/core/error.h"

namespace crossgait {
namespace {

// Rodrigues' formula: R times the rotation by `angle` about the unit vector `axis`.
Matrix3 turned(const Matrix3& R, const Vector3& axis, double angle) noexcept {
  const double s = std::sin(angle), c = std::cos(angle);
  Matrix3 result;
  const Vector3 along = (1 - c) * axis;
  const Vector3 sn = s * axis;
  result << along.x() * axis.x() + c, along.x() * axis.y() - sn.z(), along.x() * axis.z() + sn.y(),
      along.y() * axis.x() + sn.z(), along.y() * axis.y() + c, along.y() * axis.z() - sn.x(),
      along.z() * axis.x() - sn.y(), along.z() * axis.y() + sn.x(), along.z() * axis.z() + c;
  return R * result;
}

}  // namespace

FootKinematics::FootKinematics(const RobotDescription& robot) {
  if (!robot.legs) throw ConfigError(robot.source, "legs", "four legs", "a robot without legs");
  for (const Leg leg : kLegs) {
    const LegModel& model = (*robot.legs)[leg];
    Chain& chain = chains_[leg];
    chain.p_BF = model.p_BF;
    for (int i = model.foot_body; i > 0; i = robot.bodies[static_cast<std::size_t>(i)].parent) {
      const Body& body = robot.bodies[static_cast<std::size_t>(i)];
      if (chain.count == kMaxChain) {
        throw ConfigError(robot.source, fmt::format("foot {}", name(leg)),
                          fmt::format("at most {} joints between it and the base", kMaxChain), "more");
      }
      const Matrix3 R = body.X_PB.linear();
      chain.links[chain.count++] = {R, R == Matrix3::Identity(), body.X_PB.translation(), body.joint.axis,
                                    i - 1};
    }
    std::reverse(chain.links.begin(), chain.links.begin() + static_cast<std::ptrdiff_t>(chain.count));
  }
}

void FootKinematics::update(const RobotState& state, FootStates& feet) const noexcept {
  const Matrix3 R_WB = state.q_WB.toRotationMatrix();
  for (const Leg leg : kLegs) {
    const Chain& chain = chains_[leg];
    Matrix3 R = R_WB;
    Vector3 p = state.p_WB, v = state.v_WB, w = state.w_WB;
    for (std::size_t i = 0; i < chain.count; ++i) {
      const Link& link = chain.links[i];
      const Vector3 arm = R * link.p;
      p += arm;
      v += w.cross(arm);
      R = turned(link.aligned ? R : Matrix3(R * link.R), link.axis, state.q[link.joint]);
      w += state.qd[link.joint] * (R * link.axis);
    }
    const Vector3 arm = R * chain.p_BF;
    feet.p_WF[leg] = p + arm;
    feet.v_WF[leg] = v + w.cross(arm);
  }
}

}  // namespace crossgait
