// The normalised time of a gait.
#pragma once

#include <cmath>

namespace crossgait {

/// Keeps the phase of a cycle in [0, 1). Being normalised, it stays where it is when the cycle time changes.
class PhaseClock {
 public:
  double phase() const noexcept { return phase_; }
  void set(double phase) noexcept {
    phase_ = phase - std::floor(phase);
    if (phase_ >= 1) phase_ = 0;  // a tiny negative phase rounds up to one
  }
  /// @param dt  s, @param cycle_time  s, positive
  void advance(double dt, double cycle_time) noexcept { set(phase_ + dt / cycle_time); }

 private:
  double phase_ = 0;
};

}  // namespace crossgait
