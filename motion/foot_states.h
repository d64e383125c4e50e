// Where the feet are and how fast they move, in W, at the cost of their own chains alone.
#pragma once

#include <array>

#include "physics/robot/robot.h"
#include "physics/robot/state.h"

namespace crossgait {

struct FootStates {
  LegArray<Vector3> p_WF{}, v_WF{};  ///< foot centres, m, m/s

  FootStates() {
    p_WF.fill(Vector3::Zero());
    v_WF.fill(Vector3::Zero());
  }
};

/// Computes forward kinematics from the base to each foot along the bodies between. Reads the robot once; the
/// robot need not outlive it.
class FootKinematics {
 public:
  /// @throws ConfigError if the robot has no legs or a foot hangs on more than `kMaxChain` joints
  explicit FootKinematics(const RobotDescription& robot);

  void update(const RobotState& state, FootStates& feet) const noexcept;

 private:
  static constexpr std::size_t kMaxChain = 8;
  struct Link {
    Matrix3 R;        // of the joint's frame in its parent at zero angle
    bool aligned;     // R is the identity, as in most robots
    Vector3 p, axis;  // joint's origin in its parent, m; unit axis in its own frame
    int coordinate;   // that the axis is, as in most robots, and its direction; else sign is 0
    double sign;
    Eigen::Index joint;
  };
  struct Chain {
    std::array<Link, kMaxChain> links;  // base outwards
    std::size_t count = 0;
    Vector3 p_BF = Vector3::Zero();  // foot centre in the last body, m
  };
  LegArray<Chain> chains_;
};

}  // namespace crossgait
