// Random numbers that are the same on every machine.
#pragma once

#include <cstdint>
#include <random>

namespace crossgait {

/// Mixes any number into a well-spread seed by SplitMix64 (Steele, Lea and Flood, 2014).
constexpr std::uint64_t mix_seed(std::uint64_t x) noexcept {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

/// Derives a seed for the `index`-th thing that hangs on `seed` (an environment of a batch, an episode).
constexpr std::uint64_t derived_seed(std::uint64_t seed, std::uint64_t index) noexcept {
  return mix_seed(mix_seed(seed) ^ index);
}

/// Holds a range, uniform between its ends.
struct Range {
  double min = 0, max = 0;

  bool operator==(const Range&) const = default;
};

/// Draws by the Mersenne Twister, whose output the C++ standard fixes, with a uniform distribution of our
/// own, which the standard does not.
class Random {
 public:
  explicit Random(std::uint64_t seed = 0) : engine_(mix_seed(seed)) {}

  /// Draws uniformly from [0, 1), by the 53 upper bits.
  double uniform() noexcept { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  double uniform(double low, double high) noexcept { return low + (high - low) * uniform(); }

  bool operator==(const Random&) const = default;

 private:
  std::mt19937_64 engine_;
};

}  // namespace crossgait
