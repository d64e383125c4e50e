// Policies that look at nothing: the yardsticks for those that do.
#pragma once

#include "physics/core/random.h"
#include "policy/policy.h"

namespace crossgait {

/// Does nothing: the gait as it is.
class ZeroPolicy final : public Policy {
 public:
  explicit ZeroPolicy(PolicyInterface interface);

 private:
  void do_reset(std::uint64_t seed) noexcept override;
  void do_act(std::span<const double> observation, std::span<double> action) noexcept override;
};

/// Draws every entry of every action uniformly from [-1, 1): the same sequence for a seed on every machine.
class RandomPolicy final : public Policy {
 public:
  explicit RandomPolicy(PolicyInterface interface);

 private:
  void do_reset(std::uint64_t seed) noexcept override;
  void do_act(std::span<const double> observation, std::span<double> action) noexcept override;

  Random random_;
};

}  // namespace crossgait
