#include "policy/simple_policies.h"

#include <algorithm>

namespace crossgait {

ZeroPolicy::ZeroPolicy(PolicyInterface interface) : Policy("zero", std::move(interface)) {}

void ZeroPolicy::do_reset(std::uint64_t /*seed*/) noexcept {}

void ZeroPolicy::do_act(std::span<const double> /*observation*/, std::span<double> action) noexcept {
  std::fill(action.begin(), action.end(), 0.0);
}

RandomPolicy::RandomPolicy(PolicyInterface interface) : Policy("random", std::move(interface)) {}

void RandomPolicy::do_reset(std::uint64_t seed) noexcept { random_ = Random(seed); }

void RandomPolicy::do_act(std::span<const double> /*observation*/, std::span<double> action) noexcept {
  for (std::size_t i = 0; i < action.size(); ++i) {
    const LayoutEntry& entry = interface().action.entries[i];
    action[i] = random_.uniform(entry.min, entry.max);
  }
}

}  // namespace crossgait
