// When two runs of one controller go different ways, told apart from how differently they stand.
#pragma once

#include <optional>

#include "physics/robot/state.h"

namespace crossgait {

/// Distance, in leg lengths or radians (which at a leg's length is the same), that the bases of two runs must
/// move to one another to have parted. A foot lands elsewhere then; the compliance of a contact, a few
/// hundredths of that, does not count.
inline constexpr double kPartedLegs = 0.05;

/// Says how two runs went different ways.
struct Parting {
  double standing_m = 0;         ///< between the bases when the motion began
  double standing_rad = 0;       ///< between their orientations then
  std::optional<double> time_s;  ///< when they parted, s since the motion began; empty if they did not
  bool operator==(const Parting&) const = default;
};

/// Takes the states of two runs step by step.
class PartingWatch {
 public:
  /// @param leg_length  of the robot (`leg_length`), m; 0: nothing parts
  explicit PartingWatch(double leg_length) noexcept : leg_length_(leg_length) {}
  /// Takes one more state of both runs, at the same time. The first of them are how the two stand.
  void add(const RobotState& a, const RobotState& b) noexcept;
  const Parting& found() const noexcept { return found_; }

 private:
  double leg_length_;
  std::optional<double> begin_s_;
  Vector3 p_ab_ = Vector3::Zero();            ///< from a's base to b's as they stand, in W
  Quaternion q_ab_ = Quaternion::Identity();  ///< b's orientation in a's as they stand
  Parting found_;
};

}  // namespace crossgait
