// A leg of which loops move joints that have no servo: a knee by a crank and a rod, an ankle by a parallel
// bar.
#pragma once

#include <vector>

#include "physics/robot/loop_closing.h"

namespace crossgait {

/// Places all joints of one leg by the angles of its servos, numerically and from where they are: it keeps to
/// the side of a singularity on which it is. A value; no allocation after it has been made.
class ClosedChain {
 public:
  static constexpr int kMaxJoints = static_cast<int>(kMaxLegJoints), kMaxRows = 18;
  /// Angles of the leg's servos, then of its passive joints: in the order of LegModel::joints(), rad.
  using Angles = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxJoints, 1>;
  using ServoAngles = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3, 1>;
  using FootJacobian = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 3>;

  ClosedChain() = default;
  /// Takes the leg's joints, and of the robot's loops and couplings those that join them, or them and the
  /// base.
  /// @throws ConfigError naming file and leg if these are too many, or end in another leg
  ClosedChain(const RobotDescription& robot, Leg leg);

  int servo_count() const noexcept { return servos_; }
  int passive_count() const noexcept { return static_cast<int>(lower_.size()) - servos_; }
  /// Returns lower and upper limits of all joints, as Angles, rad.
  const Angles& lower() const noexcept { return lower_; }
  const Angles& upper() const noexcept { return upper_; }

  /// Tells whether no joint is beyond a limit by more than `tolerance`, rad.
  bool is_within_limits(const Angles& q, double tolerance = 0) const noexcept {
    return ((q - lower_).array() >= -tolerance).all() && ((upper_ - q).array() >= -tolerance).all();
  }

  /// Moves passive joints to where the loops are closed, next to where they are in `q`.
  /// @returns false if they cannot be closed there, to `kLoopTolerance`
  bool close(Angles& q) const noexcept;
  /// Moves servos from where `q`, which is closed, has them to `servos`, in small steps of which each is
  /// closed.
  /// @returns false if one of these could not be: `q` is then the last one that was
  bool move(const ServoAngles& servos, Angles& q) const noexcept;

  /// Returns the foot's centre in the base frame, m.
  Vector3 foot(const Angles& q) const noexcept;
  /// Returns the origins of joints in the base frame, m. @param joint  its place among Angles
  Vector3 origin(const Angles& q, int joint) const noexcept;
  Vector3 axis(const Angles& q, int joint) const noexcept;
  /// Computes d foot / d servos with the loops kept closed, m/rad.
  FootJacobian jacobian(const Angles& q) const noexcept;
  /// Returns how far the passive joints are from where they could not be driven, in (0, pi/2], rad: of two of
  /// them the angle between the ways on which they move the point that joins them, which is a four-bar's
  /// transmission angle; of more the angle of two such ways that are as near to dependent. Zero: they are
  /// there.
  double transmission(const Angles& q) const noexcept;
  /// Counts the passive joints that could move with all servos held.
  int loose_joints(const Angles& q) const noexcept;
  /// Returns an upper bound of the distance of the foot from the first joint, m.
  double reach() const noexcept;

 private:
  struct Link {
    int angle = 0;    // place among Angles
    int parent = -1;  // place among links; -1: the base
    Matrix3 R = Matrix3::Identity();
    Vector3 p = Vector3::Zero(), axis = Vector3::UnitZ();
  };
  struct Loop {
    int a = -1, b = -1;  // places among links; -1: the base
    Vector3 p_a, p_b;    // m
  };
  struct Coupling {
    int follower, leader;  // places among Angles
    JointCoupling law;
  };
  struct Placed;
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxRows, 1>;
  using RowJacobian = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxRows, kMaxJoints>;

  Placed place(const Angles& q) const noexcept;
  Rows gaps(const Placed& placed, const Angles& q) const noexcept;
  RowJacobian gap_jacobian(const Placed& placed, const Angles& q) const noexcept;
  Vector3 point(const Placed& placed, int link, const Vector3& p) const noexcept;
  /// Adds `sign` times d(point of a link)/d(angles) to three rows.
  template <typename ThreeRows>
  void add_point(const Placed& placed, int link, const Vector3& p, double sign,
                 ThreeRows rows) const noexcept;

  std::vector<Link> links_;  // parents before their children
  std::vector<int> link_of_angle_;
  std::vector<Loop> loops_;
  std::vector<Coupling> couplings_;
  Angles lower_, upper_;
  int servos_ = 0, foot_link_ = -1, rows_ = 0;
  Vector3 p_foot_ = Vector3::Zero();
};

}  // namespace crossgait
