// One step of an engine from another's state: what its law does, before chaos has had a say.
#pragma once

#include <memory>

#include "parity/divergence.h"
#include "physics/engine/physics_backend.h"

namespace crossgait {

/// Engines of one law differ by less in a control step: their solvers stop at a relative 1e-8, a force that
/// is wrong by so much moves a light link by 1e-11 m in 2 ms, and a law that is another one by 1e-8 and more
/// (docs/parity-measurements.md).
inline constexpr double kOneStepTolerance = 1e-9;  // m, rad

/// Returns what engines of one law may differ by in a control step where the coarser of the two has this
/// precision, m or rad: numbers of a radian and of a tenth of a metre round by one epsilon, which contact
/// answers with a few (measured 5e-8 under MuJoCo's law, 3e-7 under a hard one, in float32).
constexpr double one_step_tolerance(Precision precision) noexcept {
  return kOneStepTolerance + 10 * epsilon(precision);
}

/// Steps a world of an engine that is put where another's walk is before every control step.
class OneStepCheck {
 public:
  /// @param world  of the engine that is checked; the check's own
  OneStepCheck(std::unique_ptr<PhysicsBackend> world, int substeps);

  /// Checks after each control step of the walk that is followed, `reference`. @param sample  of it, now
  void add(const PhysicsBackend& reference, const TraceSample& sample);

  const OneStepDifference& difference() const noexcept { return difference_; }
  /// Returns FirstDivergence::carried, up to now.
  double carried() const noexcept { return carried_; }

 private:
  void remember(const PhysicsBackend& reference);

  std::unique_ptr<PhysicsBackend> world_;
  int substeps_;
  bool has_memory_ = false;  ///< whether servos remember targets
  bool begun_ = false;
  RobotState before_;           ///< of the reference
  std::vector<double> drives_;  ///< the same
  OneStepDifference difference_;
  double per_step_ = 0, carried_ = 0;  ///< the sum of what steps differ by, and the sum of these
};

}  // namespace crossgait
