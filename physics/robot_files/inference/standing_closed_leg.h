// A leg of which loops move a joint, in the plane across its hip. Private to inference.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "physics/robot/closed_chain.h"
#include "physics/robot_files/inference/robot_inference.h"

namespace crossgait {

/// Finds how such a leg stands, numerically: its loops are followed from where the file has the bodies, so
/// that it stands in the working mode in which it is drawn.
class StandingClosedLeg {
 public:
  /// @param abduction  angle at which that joint is held, rad; without one not used
  StandingClosedLeg(const RobotDescription& robot, Leg leg, double abduction);

  double hip_x() const;
  /// Measures the links from joint to joint as the file has the bodies.
  LegLengths lengths() const;
  /// Returns the angles of all joints, in the order of LegModel::joints(), with the foot `depth` below the
  /// hip and, where two servos move it, `forward` of it. @param bend  +1: knee ahead of the line from hip to
  /// foot, -1: behind it  @returns nothing if a limit forbids it
  std::optional<std::vector<double>> stand(double depth, double forward, int bend);
  /// Returns how far ahead of the hip the foot is at the angles of `stand`, m.
  double forward_at(const std::vector<double>& angles) const;

 private:
  using Angles = ClosedChain::Angles;
  static constexpr int kGrid = 24;  // cells along each of the two servos

  Vector3 foot_from_hip(const Angles& q) const;
  Eigen::Vector2d error(const Angles& q, double depth, double forward) const;
  int bend_of(const Angles& q) const;
  double cell_angle(int searched, int cell) const;
  bool move_to(int u, int v, Angles& q) const;
  void explore();
  std::optional<Angles> best_start(double depth, double forward, int bend) const;
  std::optional<Angles> settle(Angles q, double depth, double forward) const;

  const LegModel& model_;
  ClosedChain chain_;
  Angles zero_;                  // as the file has the bodies, the abduction where it is held
  std::vector<int> searched_{};  // places among Angles of one or two servos
  int hip_ = 0, knee_ = 0;
  bool explored_ = false;
  std::vector<std::optional<Angles>> cells_;  // what can be reached from there: u + kGrid v
};

}  // namespace crossgait
