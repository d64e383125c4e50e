#include "motion/pushes.h"

#include <cmath>
#include <limits>

namespace crossgait {

Pushes::Pushes(const Range& impulse, const Range& interval, double first, long most, const Random& random)
    : impulse_(impulse),
      interval_(interval),
      random_(random),
      next_(first),
      left_(most > 0 ? most : std::numeric_limits<long>::max()) {}

std::optional<Vector3> Pushes::due(double time) noexcept {
  if (left_ == 0 || time < next_) return std::nullopt;
  --left_;
  const double impulse = random_.uniform(impulse_.min, impulse_.max), angle = random_.uniform(-M_PI, M_PI);
  next_ += random_.uniform(interval_.min, interval_.max);
  return Vector3(impulse * std::cos(angle), impulse * std::sin(angle), 0);
}

}  // namespace crossgait
