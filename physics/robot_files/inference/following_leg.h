// A serial leg of which a knee or an ankle follows, in the plane across its hip. Private to inference.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "physics/robot/state.h"
#include "physics/robot_files/inference/robot_inference.h"

namespace crossgait {

/// Finds how such a leg stands, numerically: with followers there is no closed form.
class FollowingLeg {
 public:
  /// @param abduction  angle at which that joint is held, rad; without one not used
  FollowingLeg(const RobotDescription& robot, Leg leg, double abduction);

  double hip_x() const;
  /// Measures the links; the shin by both of its links, where there is an ankle.
  LegLengths lengths() const;
  /// Returns angles in the order of the leg's servos with the foot `depth` below the hip and `forward` of it;
  /// where the knee follows, as far forward as it comes. @param bend  +1: knee ahead of the line from hip to
  /// foot, -1: behind it  @returns nothing if a limit forbids it, of a servo or of a follower
  std::optional<std::vector<double>> stand(double depth, double forward, int bend);
  /// Returns how far ahead of the hip the foot is at the angles of `stand`, m.
  double forward_at(const std::vector<double>& angles);

 private:
  /// The foot from the hip, and the knee, in the base frame, m.
  struct Placed {
    Vector3 foot, knee;
  };
  Placed place(const Eigen::Vector2d& angles);
  Eigen::Vector2d error(const Placed& placed, double depth, double forward) const;
  int bend_of(const Placed& placed) const;
  bool is_within_limits() const;
  std::optional<Eigen::Vector2d> best_start(double depth, double forward, int bend);

  const RobotDescription& robot_;
  const LegModel& model_;
  int count_;                      ///< of hip and knee those with a servo
  std::array<int, 2> searched_{};  ///< their joints
  RobotState state_;
  std::vector<Pose> poses_;
};

}  // namespace crossgait
