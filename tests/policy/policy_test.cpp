#include "policy/policy.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "policy/simple_policies.h"
#include "tests/physics/core/config_error.h"
#include "tests/physics/core/scratch_folder.h"
#include "tests/policy/policy_interfaces.h"
#include "tests/support/constants.h"

namespace crossgait {
namespace {

using policy_tests::small_interface;

using test::kInfinity;
using test::kNaN;

/// Acts as told.
class ConstantPolicy final : public Policy {
 public:
  ConstantPolicy(const PolicyInterface& interface, std::vector<double> action)
      : Policy("constant", interface), action_(std::move(action)) {}

 private:
  void do_reset(std::uint64_t /*seed*/) noexcept override {}
  void do_act(std::span<const double> /*observation*/, std::span<double> action) noexcept override {
    std::copy(action_.begin(), action_.end(), action.begin());
  }

  std::vector<double> action_;
};

std::vector<double> act_on_four(Policy& policy, std::vector<double> observation = std::vector<double>(4)) {
  std::vector<double> action(policy.interface().action.size(), 9);
  policy.act(observation, action);
  return action;
}

TEST(Policy, ClipsActionsAndZeroesWhatIsNotFinite) {
  ConstantPolicy huge(small_interface(), {7, -1e300, 0.5, -1});
  EXPECT_EQ(act_on_four(huge), (std::vector<double>{1, -1, 0.5, -1}));
  ConstantPolicy broken(small_interface(), {kNaN, kInfinity, -kInfinity, 0.25});
  EXPECT_EQ(act_on_four(broken), (std::vector<double>{0, 0, 0, 0.25}));
}

TEST(Policy, CountsWhatItClipsSinceTheReset) {
  ConstantPolicy policy(small_interface(), {7, -1, 0.5, kNaN});
  act_on_four(policy);
  act_on_four(policy);
  const auto counts = [&policy] {
    return std::vector<std::int64_t>(policy.clipped().begin(), policy.clipped().end());
  };
  EXPECT_EQ(counts(), (std::vector<std::int64_t>{2, 0, 0, 0}))
      << "a bound is no clip, nor is what is no number";
  policy.reset(0);
  EXPECT_EQ(counts(), (std::vector<std::int64_t>(4, 0)));
}

TEST(Policy, WrongSizesGiveZeros) {
  ConstantPolicy policy(small_interface(), {1, 1, 1, 1});
  const std::vector<double> short_observation(3), observation(4);
  std::vector<double> action(4, 9), long_action(5, 9);
#ifdef NDEBUG
  policy.act(short_observation, action);
  EXPECT_EQ(action, std::vector<double>(4, 0));
  policy.act(observation, long_action);
  EXPECT_EQ(long_action, std::vector<double>(5, 0));
  policy.act(observation, {});
#else
  EXPECT_DEATH(policy.act(short_observation, action), "spans of the interface's sizes");
  EXPECT_DEATH(policy.act(observation, long_action), "spans of the interface's sizes");
#endif
}

TEST(ZeroPolicy, DoesNothing) {
  const auto policy = make_policy("zero", small_interface());
  EXPECT_EQ(policy->name(), "zero");
  policy->reset(1);
  EXPECT_EQ(act_on_four(*policy), std::vector<double>(4, 0));
  EXPECT_EQ(act_on_four(*policy, {kNaN, kInfinity, 0, 0}), std::vector<double>(4, 0));
}

TEST(RandomPolicy, DrawsTheSameNumbersOnEveryMachine) {
  const auto policy = make_policy("random", small_interface());
  policy->reset(7);
  const std::vector<double> action = act_on_four(*policy);
  // From the published algorithms of SplitMix64 and MT19937-64, computed apart from any C++ library.
  EXPECT_EQ(action[0], 0.684309609628307);
  EXPECT_EQ(action[1], 0.3581761893003168);
  EXPECT_EQ(action[2], -0.6655215427607735);
}

TEST(RandomPolicy, RepeatsAfterResetWithTheSameSeedOnly) {
  const auto policy = make_policy("random", small_interface()),
             other = make_policy("random", small_interface());
  policy->reset(3);
  const std::vector<double> first = act_on_four(*policy), second = act_on_four(*policy);
  EXPECT_NE(first, second);
  policy->reset(4);
  EXPECT_NE(act_on_four(*policy), first);
  policy->reset(3);
  other->reset(3);
  EXPECT_EQ(act_on_four(*policy), first);
  EXPECT_EQ(act_on_four(*policy), second);
  EXPECT_EQ(act_on_four(*other), first);
}

TEST(RandomPolicy, IsUniform) {
  RandomPolicy policy(small_interface());
  policy.reset(1);
  constexpr int kActs = 25000;
  double sum = 0, squares = 0;
  for (int i = 0; i < kActs; ++i) {
    for (const double value : act_on_four(policy)) {
      EXPECT_LE(std::abs(value), 1);
      sum += value;
      squares += value * value;
    }
  }
  const double n = 4.0 * kActs;
  EXPECT_NEAR(sum / n, 0, 4 * std::sqrt(1 / 3.0 / n));             // four standard errors
  EXPECT_NEAR(squares / n, 1 / 3.0, 4 * std::sqrt(4 / 45.0 / n));  // likewise
}

class MakePolicy : public ScratchFolder {};

TEST_F(MakePolicy, RefusesWhatIsNoPolicy) {
  const auto error_of = [](const std::string& text) {
    return std::string(config_error([&] { (void)make_policy(text, small_interface()); }).what());
  };
  // Between them the names of the policies that come with Crossgait: bundled_policies_test.cpp.
  for (const std::string& text : {std::string("best"), std::string()}) {
    const std::string error = error_of(text);
    EXPECT_TRUE(error.starts_with("policy: " + text + ": expected zero, random, ")) << error;
    EXPECT_TRUE(error.ends_with("FILE.safetensors or FILE.yaml, found none of these")) << error;
  }
  EXPECT_EQ(error_of("/nowhere/p.yaml"), "/nowhere/p.yaml: file: expected a readable file, found none");
  EXPECT_EQ(error_of("/nowhere/p.safetensors"),
            "/nowhere/p.safetensors: file: expected a readable file, found none");
  const std::string file = write("p.yaml", "kind: clever\n");
  EXPECT_EQ(error_of(file), file + ": line 1, kind: expected scripted, hierarchical or onnx, found 'clever'");
}

TEST_F(MakePolicy, RefusesDescriptionsOfAnotherLayoutVersion) {
  const auto error_of = [this](const std::string& yaml) {
    const std::string file = write("p.yaml", yaml);
    return std::string(config_error([&] { (void)make_policy(file, small_interface()); }).what())
        .substr(file.size() + 2);
  };
  const std::string expected = "layout_version: expected 3 (ranges of gaits that step), found ";
  const std::string members = "planner: {policy: zero}\nresidual: {policy: zero}\n";
  for (const std::string& yaml :
       {std::string("kind: scripted\nsteps: [{time: 0}]\n"), "kind: hierarchical\n" + members}) {
    EXPECT_EQ(error_of(yaml), expected + "none, which means 1: written for leg frames with z down");
    EXPECT_EQ(error_of(yaml + "layout_version: 1\n"),
              "line " + std::to_string(std::count(yaml.begin(), yaml.end(), '\n') + 1) + ", " + expected +
                  "1: written for leg frames with z down");
    EXPECT_NO_THROW((void)make_policy(write("p.yaml", yaml + "layout_version: 3\n"), small_interface()));
  }
  EXPECT_EQ(error_of("layout_version: 4\nkind: scripted\n"),
            "line 1, " + expected + "'4', which is not known here");
  EXPECT_EQ(error_of("{kind: scripted, layout_version: two}\n"),
            "line 1, " + expected + "'two', which is not known here");
}

TEST(LayoutHash, IsThatOfTheDocument) {
  // By layout_hash of docs/policies.md: the exporter in Python must agree.
  EXPECT_EQ(layout_hash(small_interface().observation, small_interface().action), "b63fc912bbeb55f8");
}

}  // namespace
}  // namespace crossgait
