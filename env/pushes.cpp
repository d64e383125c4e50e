#include "crossgait/env/pushes.h"

#include <cmath>
#include <limits>

namespace crossgait {

Pushes::Pushes(const Randomisation& randomisation, const RandomDraw& first, const Random& random)
    : impulse_(randomisation[Randomised::kPushImpulse]),
      interval_(randomisation[Randomised::kPushInterval]),
      random_(random),
      next_(first[Randomised::kPushInterval]) {
  if (!randomisation.is_on(Randomised::kPushImpulse)) return;
  const long most = std::lround(first[Randomised::kPushCount]);
  left_ = most > 0 ? most : std::numeric_limits<long>::max();
}

std::optional<Vector3> Pushes::due(double time) noexcept {
  if (left_ == 0 || time < next_) return std::nullopt;
  --left_;
  const double impulse = random_.uniform(impulse_.min, impulse_.max), angle = random_.uniform(-M_PI, M_PI);
  next_ += random_.uniform(interval_.min, interval_.max);
  return Vector3(impulse * std::cos(angle), impulse * std::sin(angle), 0);
}

}  // namespace crossgait
