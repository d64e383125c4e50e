#include "diagnosis/policy_score.h"

#include <span>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "backends/registry.h"
#include "policy/bundled_policies.h"

namespace crossgait {
namespace {

ScoredPolicy of(const std::string& policy, const std::string& trained_in = "") {
  return {policy, trained_in, load_env_config(*environment_of_policy("serial_joints")),
          read_relabelled_policy(policy)};
}

TEST(PolicyScore, IsWhatTheWalksOfEachPolicyInEachEngineCome) {
  const std::vector<ScoredPolicy> policies{of("zero", "mujoco"), of("serial_joints")};
  const std::vector<std::string> engines{available_engines().front(), available_engines().back()};
  PolicyScoreOptions options{.starts = 2, .seconds = 1.2, .seed = 3, .workers = 2};
  const std::vector<PolicyCell> cells = score_policies(policies, engines, options);
  ASSERT_EQ(cells.size(), 4U);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const ScoredPolicy& policy = policies[i / 2];
    EXPECT_EQ(cells[i].policy, policy.name);
    EXPECT_EQ(cells[i].trained_in, policy.trained_in);
    EXPECT_EQ(cells[i].engine, engines[i % 2]);
    EXPECT_EQ(cells[i].walks, 8U);
    EXPECT_LE(cells[i].low, cells[i].value);
    EXPECT_GE(cells[i].high, cells[i].value);
  }
  // Against the walks themselves.
  LoadedEnv there = policies[1].environment;
  there.config.engine = engines[1];
  const WalkTest test{walk_commands(there.config), 2, 1.2, 0};
  const WalkResult walks = run_walks(there, policies[1].policy, test, 3);
  EXPECT_DOUBLE_EQ(cells[3].value, walks.mean());
  EXPECT_EQ(cells[3].falls, walks.falls());
  EXPECT_EQ(cells[3].complaint, what_is_wrong(walks, test));
  // Whoever stands misses the speed that three of four commands ask for.
  const double asked = there.config.command->vx;
  EXPECT_NEAR(cells[0].speed_error, 0.75 * asked, 0.05);  // what it sways by
  EXPECT_FALSE(cells[0].done);
  options.workers = 1;
  const std::vector<PolicyCell> again =
      score_policies(std::span(policies).first(1), std::span(engines).first(1), options);
  EXPECT_EQ(to_json(again, options), to_json(std::span(cells).first(1), options));
}

TEST(PolicyScore, IsToldInASentenceForEachPolicy) {
  const auto cell = [](const char* policy, const char* engine, bool done) {
    PolicyCell one;
    one.policy = policy;
    one.engine = engine;
    one.done = done;
    one.complaint = done ? "does what it is asked" : "falls";
    return one;
  };
  const std::vector<PolicyCell> cells{cell("a", "x", true), cell("a", "y", false), cell("b", "x", false)};
  const std::string text = describe(cells);
  EXPECT_NE(text.find("a does what it is asked in 1 of 2 engines: x.\n"), std::string::npos) << text;
  EXPECT_NE(text.find("b does what it is asked in 0 of 1 engine.\n"), std::string::npos) << text;
  EXPECT_TRUE(to_json(cells, {}).at("cells").at(0).at("trained_in").is_null());
}

}  // namespace
}  // namespace crossgait
