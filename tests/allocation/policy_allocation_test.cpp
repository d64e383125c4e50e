// No allocation per action and per reset, whatever the policy.
#include <limits>

#include <gtest/gtest.h>

#include "policy/policy.h"
#include "tests/physics/core/scratch_folder.h"
#include "tests/policy/policy_interfaces.h"
#include "tests/support/allocation_counter.h"

namespace crossgait {
namespace {

using policy_tests::random_network;
using policy_tests::small_interface;

class PolicyAllocation : public ScratchFolder {
 protected:
  static std::size_t allocations_of(const std::string& text) {
    const PolicyInterface interface = small_interface();
    const auto policy = make_policy(text, interface);
    std::vector<double> observation(interface.observation.size(), 0.3), action(interface.action.size());
    const AllocationScope scope;
    for (std::uint64_t episode = 0; episode < 3; ++episode) {
      policy->reset(episode);
      for (int i = 0; i < 200; ++i) policy->act(observation, action);
      observation[1] = std::numeric_limits<double>::quiet_NaN();
    }
    return scope.count();
  }
};

TEST_F(PolicyAllocation, None) {
  EXPECT_EQ(allocations_of("zero"), 0U);
  EXPECT_EQ(allocations_of("random"), 0U);
  EXPECT_EQ(allocations_of(write(
                "scripted.yaml",
                "{kind: scripted, layout_version: 3, steps: [{time: 0, parameters: {step_height: 0.05}},"
                " {time: 0.1, action: {residual.FL.x: 1}}]}")),
            0U);
  EXPECT_EQ(allocations_of(write(
                "hierarchical.yaml",
                "{kind: hierarchical, layout_version: 3, planner: {policy: random, observation: [terrain.]},"
                " residual: {policy: random}}")),
            0U);
}

TEST_F(PolicyAllocation, NoneInNetworksOfAnySize) {
  // Eigen copies what is not contiguous before it multiplies, on the heap from 128 kB: 40,000 numbers would
  // show.
  for (const std::vector<int>& hidden : {std::vector<int>{}, {8}, {512, 256, 128}, {40000}}) {
    for (const MlpActivation activation : {MlpActivation::kTanh, MlpActivation::kElu, MlpActivation::kRelu}) {
      MlpNetwork network = random_network(small_interface(), hidden);
      network.activation = activation;
      network.output = MlpOutput::kTanh;
      write_policy_bundle(path("p.safetensors"), network, small_interface());
      EXPECT_EQ(allocations_of(path("p.safetensors")), 0U);
    }
  }
}

}  // namespace
}  // namespace crossgait
