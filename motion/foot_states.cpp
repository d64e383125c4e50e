#include "motion/foot_states.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "physics/core/error.h"

namespace crossgait {
namespace {

// R times the rotation by an angle (cosine c, sine s) about a unit vector: Rodrigues' formula.
Matrix3 turned(const Matrix3& R, const Vector3& axis, double c, double s) noexcept {
  Matrix3 result;
  const Vector3 along = (1 - c) * axis;
  const Vector3 sn = s * axis;
  result << along.x() * axis.x() + c, along.x() * axis.y() - sn.z(), along.x() * axis.z() + sn.y(),
      along.y() * axis.x() + sn.z(), along.y() * axis.y() + c, along.y() * axis.z() - sn.x(),
      along.z() * axis.x() - sn.y(), along.z() * axis.y() + sn.x(), along.z() * axis.z() + c;
  return R * result;
}

// The same about coordinate axis k, which mixes the columns of the other two.
template <int k>
void turn(Matrix3& R, double c, double s) noexcept {
  constexpr int i = (k + 1) % 3, j = (k + 2) % 3;
  const Vector3 before = R.col(i);
  R.col(i) = c * before + s * R.col(j);
  R.col(j) = c * R.col(j) - s * before;
}

// Which coordinate axis this is, and in which direction: 0 if it is none.
std::pair<int, double> coordinate_axis(const Vector3& axis) noexcept {
  for (int k = 0; k < 3; ++k) {
    if (std::abs(axis[k]) == 1 && axis.cwiseAbs().sum() == 1) return {k, axis[k]};
  }
  return {0, 0};
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
      const auto [coordinate, sign] = coordinate_axis(body.joint.axis);
      chain.links[chain.count++] = {
          R, R == Matrix3::Identity(), body.X_PB.translation(), body.joint.axis, coordinate, sign, i - 1};
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
      if (!link.aligned) R = R * link.R;
      const double q = state.q[link.joint], c = std::cos(q), s = std::sin(q);
      if (link.sign == 0) {
        R = turned(R, link.axis, c, s);
        w += state.qd[link.joint] * (R * link.axis);
      } else {
        const double sign_s = link.sign * s;
        if (link.coordinate == 0)
          turn<0>(R, c, sign_s);
        else if (link.coordinate == 1)
          turn<1>(R, c, sign_s);
        else
          turn<2>(R, c, sign_s);
        w += link.sign * state.qd[link.joint] * R.col(link.coordinate);
      }
    }
    const Vector3 arm = R * chain.p_BF;
    feet.p_WF[leg] = p + arm;
    feet.v_WF[leg] = v + w.cross(arm);
  }
}

}  // namespace crossgait
