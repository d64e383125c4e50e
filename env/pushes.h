// Sideways pushes of the trunk, now and then.
#pragma once

#include <optional>

#include "crossgait/env/randomisation.h"

namespace crossgait {

/// A value that draws as it goes: copies continue alike.
class Pushes {
 public:
  /// None.
  Pushes() = default;
  /// Those that `randomisation` asks for: impulse, interval, largest number. @param first the draw of this
  /// motion, which holds the time of the first push @param random goes on from where the draws ended
  Pushes(const Randomisation& randomisation, const RandomDraw& first, const Random& random);

  /// The impulse (N s, in W) if one is due at `time` (s); the next is then due an interval later.
  std::optional<Vector3> due(double time) noexcept;

 private:
  Range impulse_, interval_;
  Random random_;
  double next_ = 0;
  long left_ = 0;
};

}  // namespace crossgait
