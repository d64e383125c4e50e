// Sideways pushes of the trunk, now and then.
#pragma once

#include <optional>

#include "physics/core/math.h"
#include "physics/core/random.h"

namespace crossgait {

/// Draws as it goes, as a value: copies continue alike.
class Pushes {
 public:
  /// Makes no pushes.
  Pushes() = default;
  /// Pushes until the motion ends or `most` of them are done.
  /// @param impulse   N s, drawn anew for every push; its direction is uniform in the plane of W
  /// @param interval  s from one push to the next, drawn anew
  /// @param first     time of the first push, s
  /// @param most      0: as many as there is time for
  /// @param random    what is drawn from
  Pushes(const Range& impulse, const Range& interval, double first, long most, const Random& random);

  /// Returns the impulse (N s, in W) if one is due at `time` (s); the next is then due an interval later.
  std::optional<Vector3> due(double time) noexcept;

 private:
  Range impulse_, interval_;
  Random random_;
  double next_ = 0;
  long left_ = 0;
};

}  // namespace crossgait
