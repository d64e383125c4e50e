// A gait whose parameters and foot targets a policy adjusts while it runs.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "gait/gait_generator.h"

namespace crossgait {

struct AdaptiveGaitOptions {
  /// Which parameters adapt, by name; action and observation vectors keep this order.
  std::vector<std::string> parameters = {"step_height", "step_length", "cycle_time", "body_height"};
  AdaptationRanges ranges;       ///< in the place of the table's
  GaitParameters initial;        ///< outside its range, a parameter can only come nearer to it
  double residual_scale = 0.01;  ///< largest residual per coordinate, m
  StepLimits limits;
};

/// Adds clipped deltas to the parameters and clipped residuals to the foot targets of a GaitGenerator.
/// Parameters come into effect as the generator's continuity allows and never move a target by more than
/// their own change; residuals act at once, for how they change is the policy's business. Names are resolved
/// when configured: while running there are only indices.
class AdaptiveGaitController {
 public:
  /// @param p_BL  origins of the leg frames in the base frame, m
  /// @throws ConfigError for an unknown or repeated name, a bad range, an initial value that is not valid, or
  /// a bad residual_scale
  AdaptiveGaitController(const Gait& gait, const AdaptiveGaitOptions& options, const LegArray<Vector3>& p_BL);

  /// Goes back to the initial parameters, phase 0 and no residuals.
  void reset(GaitGenerator::Start start = GaitGenerator::Start::kWalking) noexcept;

  /// Returns rows of the parameters that adapt, with the ranges and delta scales that hold here.
  std::span<const ParameterRow> adapted() const noexcept { return adapted_; }
  /// Counts deltas of the parameters, then x, y, z residuals of FL, FR, RL, RR.
  std::size_t action_size() const noexcept { return adapted_.size() + 3 * kLegs.size(); }

  /// Adds to the parameters, each as its row's `moved` says. What is not finite counts as zero, and
  /// so does what is missing from a span that is too short. @param deltas  in the units of the rows
  void add_deltas(std::span<const double> deltas) noexcept;
  /// Sets offsets of the targets in their leg frames (z up: a positive z raises the foot), m, every
  /// coordinate clipped to +-residual_scale; not finite: zero.
  void set_residuals(const LegArray<Vector3>& residuals) noexcept;
  /// Applies deltas and residuals of one action in [-1, 1] (clipped): times delta_scale and residual_scale.
  void apply_action(std::span<const double> action) noexcept;

  /// Advances by dt (s) and returns the targets with residuals.
  const LegArray<FootTarget>& update(double dt) noexcept;

  const LegArray<FootTarget>& targets() const noexcept { return targets_; }
  /// Returns parameters as adapted so far; `generator().effective()` is what is in effect.
  const GaitParameters& parameters() const noexcept { return generator_.parameters(); }
  /// Writes the adapted parameters, each normalised from its range to [-1, 1]; beyond, where one is outside
  /// it.
  /// @param out  of
  /// adapted().size()
  void normalised_parameters(std::span<double> out) const noexcept;
  double phase() const noexcept { return generator_.phase(); }
  bool is_swing(Leg leg) const noexcept { return targets_[leg].swing; }
  const LegArray<Vector3>& residuals() const noexcept { return residuals_; }

  /// Returns the generator, to change gait, or walk at a commanded velocity.
  GaitGenerator& generator() noexcept { return generator_; }
  const GaitGenerator& generator() const noexcept { return generator_; }

 private:
  void add_residuals() noexcept;

  std::vector<ParameterRow> adapted_;
  GaitParameters initial_;
  double residual_scale_;
  GaitGenerator generator_;
  LegArray<Vector3> residuals_;
  LegArray<FootTarget> targets_ = {};
};

}  // namespace crossgait
