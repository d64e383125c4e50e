// Coupled joints, of which PhysX 5.3 has none, by steps that are tried until they end where the couplings
// hold.
#pragma once

#include <vector>

#include "physics/engine/world_spec.h"
#include "physics/robot/state.h"

namespace crossgait::physx {

/// Finds the torques of couplings. PhysX's fixed tendons give each of their joints its own impulse and so
/// take from one what they do not give to the other, and its constraints see two links where a follower and
/// its leader have three. So a step is repeated from its start with other torques: the gaps that couplings
/// have at its end, over what a change of torques did to them (Broyden, A Class of Methods for Solving
/// Nonlinear Simultaneous Equations, 1965), are closed after a few tries, with contacts, limits and drives as
/// they are. Each step begins with the torques of the one before and what it learned, which are part of the
/// state.
class CoupledJoints {
 public:
  /// @param spec  must outlive it
  explicit CoupledJoints(const WorldSpec& spec);

  bool empty() const noexcept { return couplings_.empty(); }
  /// Forgets what the steps before found.
  void forget() noexcept;
  /// Begins a step at these joint angles, rad.
  void begin(const JointVector& angles) noexcept;
  /// Adds the torques to try, N m.
  void add_torques(JointVector& torques) const noexcept;
  /// Takes the joint angles (rad) that a try ended with. @returns false if it is worth another one
  bool settle(const JointVector& angles) noexcept;

  /// Saves behind other numbers what the next step begins with.
  void save(std::vector<double>& numbers) const;
  /// Counts the numbers of that.
  Eigen::Index state_size() const noexcept { return torques_.size() + inverse_.size(); }
  void restore(const double* numbers);

 private:
  static constexpr int kMost = kMaxJoints;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMost, 1>;
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMost, kMost>;

  /// Takes what a change of torques (N m) did to gaps (rad).
  void learn(const Vector& change, const Vector& effect) noexcept;

  const std::vector<JointCoupling>& couplings_;
  Matrix inverse_of_free_;      ///< N m/rad: torques by what they do to angles, at home and without contact
  Matrix inverse_;              ///< the same as the last steps had it
  Vector slopes_, torques_;     ///< -, N m
  Vector best_, gaps_of_best_;  ///< N m, rad: of the tries of this step
  int tries_ = 0;
};

}  // namespace crossgait::physx
