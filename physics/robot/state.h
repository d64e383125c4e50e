// Values that cross the interface every step. Fixed-size storage; copying one never allocates.
#pragma once

#include <algorithm>
#include <array>

#include "physics/core/math.h"
#include "physics/robot/leg.h"

namespace crossgait {

/// Holds configuration and velocity of a robot. World frame W: z up, x forward; base frame B at the base
/// link's origin.
struct RobotState {
  double time = 0;                 ///< simulated seconds since reset
  Vector3 p_WB = Vector3::Zero();  ///< m
  Quaternion q_WB = Quaternion::Identity();
  Vector3 v_WB = Vector3::Zero();  ///< velocity of the base origin in W, m/s
  Vector3 w_WB = Vector3::Zero();  ///< angular velocity in W, rad/s
  JointVector q;                   ///< joint angles, rad
  JointVector qd;                  ///< joint velocities, rad/s

  bool is_finite() const noexcept {
    return p_WB.allFinite() && q_WB.coeffs().allFinite() && v_WB.allFinite() && w_WB.allFinite() &&
           q.allFinite() && qd.allFinite();
  }
  Pose X_WB() const { return make_pose(q_WB, p_WB); }
};

/// Holds a force and a torque together, in W.
struct Wrench {
  Vector3 force = Vector3::Zero();   ///< N
  Vector3 torque = Vector3::Zero();  ///< N m
};

/// Holds what pulls at one body from outside, the force at a point of it.
struct BodyWrench {
  int body = 0;  ///< index into RobotDescription::bodies
  Wrench wrench;
  Vector3 p_BP = Vector3::Zero();  ///< in the body's frame, m
};

/// Holds position targets of the actuated joints, in the order of `RobotDescription::actuated_joints()`, rad.
struct JointTargets {
  JointVector q;
};

/// Is one contact point between a body of the robot and the terrain, as the engine solved it last step.
struct Contact {
  int body = -1;                      ///< index into RobotDescription::bodies
  int leg = -1;                       ///< index of the leg whose foot it is, or -1
  Vector3 p_WP = Vector3::Zero();     ///< contact point, m
  Vector3 normal = Vector3::UnitZ();  ///< unit, from terrain to robot
  double distance = 0;                ///< m, negative when penetrating
  Vector3 force = Vector3::Zero();    ///< on the robot, in W, N, mean over the step
  double slip_speed = 0;              ///< tangential speed of the body at the point, m/s
};

inline constexpr int kMaxContacts = 64;

/// Keeps the `kMaxContacts` deepest of the points added, in the order of adding; `dropped` counts the others.
template <typename Point>
struct DeepestPoints {
  std::array<Point, kMaxContacts> points;
  int count = 0;
  int dropped = 0;

  void clear() noexcept { count = dropped = 0; }
  /// Adds a point; of equally deep points the earlier ones stay.
  void add(const Point& point) noexcept {
    if (count == kMaxContacts) {
      ++dropped;
      const auto deeper = [](const Point& a, const Point& b) { return a.distance < b.distance; };
      const auto shallowest = std::max_element(points.rbegin(), points.rend(), deeper);  // the latest such
      if (!deeper(point, *shallowest)) return;
      std::move(shallowest.base(), points.end(), shallowest.base() - 1);
      --count;
    }
    points[static_cast<std::size_t>(count++)] = point;
  }
  const Point* begin() const noexcept { return points.data(); }
  const Point* end() const noexcept { return points.data() + count; }
};

/// Contacts of the last physics step. Fixed capacity.
using ContactList = DeepestPoints<Contact>;

/// Holds what one foot feels: all its contact points together.
struct FootContact {
  bool touching = false;            ///< carries a normal force
  Vector3 force = Vector3::Zero();  ///< sum, in W, N
  Vector3 p_WP = Vector3::Zero();   ///< deepest contact point, m
  double slip_speed = 0;            ///< at the deepest point, m/s
  double penetration = 0;           ///< of the deepest point, m, >= 0
};

enum class StepStatus {
  kOk,
  kDiverged,  ///< the state is no longer finite or has run away; it stays at its last good value until reset
  kInvalidTargets,  ///< targets of the wrong size or not finite; nothing was done
};

}  // namespace crossgait
