#include "parity/parting.h"

#include "parity/divergence.h"

namespace crossgait {

void PartingWatch::add(const RobotState& a, const RobotState& b) noexcept {
  const Vector3 p_ab = b.p_WB - a.p_WB;
  const Quaternion q_ab = a.q_WB.conjugate() * b.q_WB;
  if (!begin_s_) {
    begin_s_ = a.time;
    p_ab_ = p_ab;
    q_ab_ = q_ab;
    found_.standing_m = p_ab.norm();
    found_.standing_rad = attitude_difference(a.q_WB, b.q_WB);
    return;
  }
  if (leg_length_ <= 0 || found_.time_s) return;
  if ((p_ab - p_ab_).norm() > kPartedLegs * leg_length_ || attitude_difference(q_ab_, q_ab) > kPartedLegs)
    found_.time_s = a.time - *begin_s_;
}

}  // namespace crossgait
