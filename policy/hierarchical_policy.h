// A slow policy that plans the gait over a fast one that corrects the feet.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "policy/policy.h"

namespace crossgait {

class YamlValue;

struct HierarchicalOptions {
  /// What the action's deltas are in the policy steps between two plans: zero, or the last plan's (true).
  /// A delta is *added* to its parameter in every step. Zero makes a plan act once, as it did in the coarse
  /// steps that a planner is trained with, and lets it move a parameter by its delta_scale per plan. Held,
  /// one plan at 10 Hz under a policy at 500 Hz is added 50 times: any delta beyond a third drives most
  /// parameters of the table from one end of their range to the other.
  bool hold_deltas = false;
};

/// Joins two policies: the planner writes the action's deltas at its own pace, first in step 0; the residual
/// policy writes the residuals in every step. Each sees its own part of the observation.
class HierarchicalPolicy final : public Policy {
 public:
  /// @param planner   its interface's policy_dt, a multiple of interface.policy_dt, is the time between plans
  /// @param residual  at interface.policy_dt
  /// @throws ConfigError if a member asks for what is not in `interface`, if their actions do not share out
  /// `interface.action`, or for a pace that does not fit
  HierarchicalPolicy(std::string name, const PolicyInterface& interface, std::unique_ptr<Policy> planner,
                     std::unique_ptr<Policy> residual, const HierarchicalOptions& options = {});

  /// Returns the policy steps from one plan to the next.
  std::int64_t planner_period() const noexcept { return period_; }

 private:
  /// Holds a policy and where its numbers are among those of the whole.
  struct Member {
    Member(const std::string& source, const PolicyInterface& whole, std::unique_ptr<Policy> member);
    void act(std::span<const double> whole_observation) noexcept;
    void write(std::span<double> whole_action) const noexcept;

    std::unique_ptr<Policy> policy;
    std::vector<std::size_t> observation_at, action_at;
    std::vector<double> observation, action;
  };

  void do_reset(std::uint64_t seed) noexcept override;
  void do_act(std::span<const double> observation, std::span<double> action) noexcept override;

  Member planner_, residual_;
  HierarchicalOptions options_;
  std::int64_t period_ = 1, acts_ = 0;
};

/// Describes what a member of a hierarchical policy runs on.
/// @param observation  names of entries, or beginnings of names that end in "." and stand for all such
/// entries
///                     in order; empty: the whole observation
/// @param part         "delta." or "residual."
/// @throws ConfigError naming `source` for what is unknown or repeated, or an action without such a part
PolicyInterface member_interface(const PolicyInterface& whole, const std::vector<std::string>& observation,
                                 std::string_view part, double policy_dt, const std::string& source);

/// Takes a description of kind `hierarchical` and reads its members (docs/policies.md). @throws ConfigError
PolicyFactory load_hierarchical_policy(const YamlValue& root);

}  // namespace crossgait
