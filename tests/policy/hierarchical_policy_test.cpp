#include "policy/hierarchical_policy.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>

#include "gait/parameters.h"
#include "policy/policy_bundle.h"
#include "policy/simple_policies.h"
#include "tests/physics/core/config_error.h"
#include "tests/physics/core/scratch_folder.h"
#include "tests/policy/policy_interfaces.h"

namespace crossgait {
namespace {

using policy_tests::layout_of;
using policy_tests::random_network;
using policy_tests::small_interface;

/// Its k-th action since reset is k percent of the first observation in every entry.
class CountingPolicy final : public Policy {
 public:
  explicit CountingPolicy(PolicyInterface interface) : Policy("counting", std::move(interface)) {}

 private:
  void do_reset(std::uint64_t /*seed*/) noexcept override { acts_ = 0; }
  void do_act(std::span<const double> observation, std::span<double> action) noexcept override {
    ++acts_;
    std::fill(action.begin(), action.end(), acts_ * 0.01 * observation[0]);
  }

  int acts_ = 0;
};

template <typename Member>
std::unique_ptr<Policy> member(const std::vector<std::string>& observation, std::string_view part,
                               double dt) {
  return std::make_unique<Member>(member_interface(small_interface(), observation, part, dt, "test"));
}

HierarchicalPolicy counting(double planner_dt, bool hold_deltas) {
  return {"test",
          small_interface(),
          member<CountingPolicy>({"terrain."}, "delta.", planner_dt),
          member<CountingPolicy>({"p_WB.x"}, "residual.", 2e-3),
          {.hold_deltas = hold_deltas}};
}

std::vector<double> plan_and_act(Policy& policy, const std::vector<double>& observation = {1, 9, -1, 9}) {
  std::vector<double> action(4, 9);
  policy.act(observation, action);
  return action;
}

TEST(HierarchicalPolicy, PlansInStepZeroAndThenAtItsPace) {
  HierarchicalPolicy policy = counting(0.1, false);
  EXPECT_EQ(policy.planner_period(), 50);
  for (int episode = 0; episode < 2; ++episode) {
    policy.reset(0);
    for (int i = 0; i < 120; ++i) {
      const int plans = i / 50 + 1;
      const double delta = i % 50 == 0 ? -plans * 0.01 : 0;   // of terrain.front, which is -1
      const double residual = std::min(1.0, (i + 1) * 0.01);  // of p_WB.x, which is 1
      EXPECT_EQ(plan_and_act(policy), (std::vector<double>{delta, delta, residual, residual})) << i;
    }
  }
}

TEST(HierarchicalPolicy, HoldsDeltasIfAsked) {
  HierarchicalPolicy policy = counting(6e-3, true);
  for (int i = 0; i < 9; ++i) {
    const int plans = i / 3 + 1;
    EXPECT_EQ(plan_and_act(policy)[0], -plans * 0.01) << i;
  }
}

TEST(HierarchicalPolicy, HeldDeltasOfATenthOfASecondCrossTheWholeRange) {
  // Why they are not held unless asked for: 50 additions of a third of delta_scale. The guide's parameters.
  for (const char* name :
       {"step_height", "step_length", "cycle_time", "body_height", "stance_width", "foot_clearance"}) {
    const ParameterRow& row = find_parameter(name);
    EXPECT_GT(50 * row.delta_scale / 3, row.max - row.min) << name;
    EXPECT_LT(row.delta_scale, (row.max - row.min) / 4) << name;  // and a single plan does not
  }
}

TEST(HierarchicalPolicy, MembersDrawDifferentNumbersThatRepeat) {
  HierarchicalPolicy policy("test", small_interface(), member<RandomPolicy>({}, "delta.", 0.1),
                            member<RandomPolicy>({}, "residual.", 2e-3));
  policy.reset(5);
  const std::vector<double> first = plan_and_act(policy);
  EXPECT_NE(first[0], first[2]);
  EXPECT_NE(plan_and_act(policy), first);
  policy.reset(5);
  EXPECT_EQ(plan_and_act(policy), first);
}

TEST(HierarchicalPolicy, AWholeObservationThatIsNoNumberGivesZeros) {
  HierarchicalPolicy policy = counting(0.1, false);
  EXPECT_EQ(plan_and_act(policy, {std::nan(""), 0, std::nan(""), 0}), std::vector<double>(4, 0));
}

TEST(HierarchicalPolicy, RefusesMembersThatDoNotShareTheAction) {
  const auto error_of = [](std::unique_ptr<Policy> planner, std::unique_ptr<Policy> residual) {
    return std::string(config_error([&] {
                         HierarchicalPolicy("test", small_interface(), std::move(planner),
                                            std::move(residual));
                       }).what());
  };
  EXPECT_EQ(error_of(member<ZeroPolicy>({}, "residual.", 0.1), member<ZeroPolicy>({}, "residual.", 2e-3)),
            "test: action delta.step_height: expected delta.* from the planner, residual.* from the residual "
            "policy, "
            "found 0 of the planner, 0 of the residual policy");
  EXPECT_EQ(error_of(member<ZeroPolicy>({}, "delta.", 0.1), std::make_unique<ZeroPolicy>(small_interface())),
            "test: action delta.step_height: expected delta.* from the planner, residual.* from the residual "
            "policy, "
            "found 1 of the planner, 1 of the residual policy");
  EXPECT_EQ(error_of(member<ZeroPolicy>({}, "delta.", 0.1), member<ZeroPolicy>({}, "residual.", 4e-3)),
            "test: residual: expected a policy of 0.002 s, found 0.004 s");
  for (const double dt : {0.0, -0.1, 1e-3, 5e-3, std::nan(""), HUGE_VAL}) {
    const std::string message =
        error_of(member<ZeroPolicy>({}, "delta.", dt), member<ZeroPolicy>({}, "residual.", 2e-3));
    EXPECT_EQ(message.rfind("test: planner.dt: expected a multiple of the policy step, 0.002 s, found", 0),
              0U)
        << message;
  }
  auto foreign =
      std::make_unique<ZeroPolicy>(PolicyInterface{layout_of({"o"}), layout_of({"delta.step_height"}), 0.1});
  EXPECT_EQ(
      error_of(std::move(foreign), member<ZeroPolicy>({}, "residual.", 2e-3)),
      "test: observation o: expected one of p_WB.x, param.step_height, terrain.front, terrain.back, found an "
      "unknown entry");
}

class HierarchicalPolicyFile : public ScratchFolder {
 protected:
  std::unique_ptr<Policy> make(const std::string& yaml,
                               const PolicyInterface& interface = small_interface()) {
    return make_policy(write("h.yaml", "kind: hierarchical\nlayout_version: 3\n" + yaml), interface);
  }
  std::string error_of(const std::string& yaml, const PolicyInterface& interface = small_interface()) {
    const std::string message = config_error([&] { (void)make(yaml, interface); }).what();
    return message.substr(std::min(message.size(), message.rfind("h.yaml: ")));
  }
};

TEST_F(HierarchicalPolicyFile, ReadsMembersBesideIt) {
  const PolicyInterface planner =
      member_interface(small_interface(), {"terrain.", "p_WB.x"}, "delta.", 0.004, "test");
  EXPECT_EQ(planner.observation.names(),
            (std::vector<std::string>{"terrain.front", "terrain.back", "p_WB.x"}));
  const MlpNetwork network = random_network(planner, {8});
  write_policy_bundle(path("planner.safetensors"), network, planner);
  write("residual.yaml",
        "kind: scripted\nlayout_version: 3\nsteps: [{time: 0.004, action: {residual.FL.z: -0.5}}]\n");
  const auto policy = make(
      "planner: {policy: planner.safetensors, observation: [terrain., p_WB.x], dt: 0.004}\n"
      "residual: {policy: residual.yaml}\n");
  EXPECT_EQ(policy->name(), "h.yaml");
  const Eigen::VectorXd expected = network.evaluate(Eigen::Vector3d(0.3, 0.4, 0.1));
  for (int i = 0; i < 6; ++i) {
    const std::vector<double> action = plan_and_act(*policy, {0.1, 0.2, 0.3, 0.4});
    EXPECT_NEAR(action[0], i % 2 == 0 ? expected[0] : 0, 1e-6);  // single precision
    EXPECT_NEAR(action[1], i % 2 == 0 ? expected[1] : 0, 1e-6);
    EXPECT_EQ(action[2], 0);
    EXPECT_EQ(action[3], i < 2 ? 0 : -0.5);
  }
}

TEST_F(HierarchicalPolicyFile, IsReadOnceWithItsMembers) {
  const std::string member =
      write("residual.yaml",
            "kind: scripted\nlayout_version: 3\nsteps: [{time: 0, action: {residual.FL.z: -0.5}}]\n");
  const std::string whole = write("h.yaml",
                                  "kind: hierarchical\nlayout_version: 3\n"
                                  "planner: {policy: zero}\nresidual: {policy: residual.yaml}\n");
  const PolicyFactory read = load_policy(whole);
  std::filesystem::remove(member);
  std::filesystem::remove(whole);
  for (int instance = 0; instance < 2; ++instance)
    EXPECT_EQ(plan_and_act(*read(small_interface())), (std::vector<double>{0, 0, 0, -0.5}));
}

TEST_F(HierarchicalPolicyFile, PlansAtTenHertzUnlessToldOtherwise) {
  const auto policy = make("planner: {policy: random}\nresidual: {policy: zero}\n");
  EXPECT_EQ(dynamic_cast<const HierarchicalPolicy&>(*policy).planner_period(), 50);
  const auto held = make("planner: {policy: random}\nresidual: {policy: zero}\nhold_deltas: true\n");
  const std::vector<double> first = plan_and_act(*held);
  EXPECT_EQ(plan_and_act(*held), first);
}

TEST_F(HierarchicalPolicyFile, RefusesWhatDoesNotFit) {
  const std::string zero = "residual: {policy: zero}\n";
  EXPECT_EQ(error_of("planner: {policy: zero, rate: 10}\n" + zero),
            "h.yaml: line 3, planner.rate: expected one of the keys policy, observation, dt, found unknown "
            "key 'rate'");
  EXPECT_EQ(error_of(zero), "h.yaml: top level: expected key 'planner', found none");
  EXPECT_EQ(error_of("planner: {policy: zero, observation: [terrain.left]}\n" + zero),
            "h.yaml: line 3, planner: observation terrain.left: expected one of p_WB.x, param.step_height, "
            "terrain.front, terrain.back, or a beginning that ends in '.', found an unknown entry");
  EXPECT_EQ(error_of("planner: {policy: zero, observation: [terrain.front, terrain.]}\n" + zero),
            "h.yaml: line 3, planner: observation: expected each entry once, found terrain.front twice");
  EXPECT_EQ(error_of("planner: {policy: zero, observation: []}\n" + zero),
            "h.yaml: line 3, planner.observation: expected at least one name, found none");
  EXPECT_EQ(error_of("planner: {policy: zero, dt: 0.003}\n" + zero),
            "h.yaml: planner.dt: expected a multiple of the policy step, 0.002 s, found 0.003 s");
  PolicyInterface no_deltas = small_interface();
  no_deltas.action = layout_of({"residual.FL.x"});
  EXPECT_EQ(error_of("planner: {policy: zero}\n" + zero, no_deltas),
            "h.yaml: line 3, planner: action: expected entries delta.*, found none");
}

TEST_F(HierarchicalPolicyFile, RefusesMembersOfAnotherLayoutVersion) {
  const std::string scripted = "kind: scripted\nsteps: [{time: 0, action: {residual.FL.z: -0.5}}]\n";
  const std::string member = write("residual.yaml", scripted);
  const std::string yaml = "planner: {policy: zero}\nresidual: {policy: residual.yaml}\n";
  EXPECT_EQ(
      std::string(config_error([&] { (void)make(yaml); }).what()),
      path("h.yaml") + ": line 4, residual.policy: " + member +
          ": layout_version: expected 3 (ranges of gaits that step), found none, which means 1: written "
          "for leg frames with z down");
}

TEST_F(HierarchicalPolicyFile, CannotBeItsOwnMember) {
  EXPECT_EQ(error_of("planner: {policy: h.yaml}\nresidual: {policy: zero}\n"),
            "h.yaml: line 3, planner.policy: expected a policy of one part of the action, found a hierarchy "
            "of two");
}

}  // namespace
}  // namespace crossgait
