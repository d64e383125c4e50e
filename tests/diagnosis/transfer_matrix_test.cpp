#include "diagnosis/transfer_matrix.h"

#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace crossgait {
namespace {

PolicyCell cell(const std::string& policy, const std::string& home, const std::string& engine,
                std::vector<double> by_start) {
  PolicyCell one;
  one.policy = policy;
  one.trained_in = home;
  one.engine = engine;
  one.value = mean_of(by_start);
  one.by_start = std::move(by_start);
  return one;
}

const MatrixEntry& entry(const TransferMatrix& matrix, const std::string& home, const std::string& engine) {
  for (const MatrixEntry& one : matrix.entries) {
    if (one.trained_in == home && one.engine == engine) return one;
  }
  throw std::runtime_error("no entry");
}

/// Half of Student's 95 % interval of the mean of two numbers: t of one degree of freedom, 12.7062.
double half_of_two(double a, double b) {
  return 12.706204736 * std::abs(a - b) / std::sqrt(2) / std::sqrt(2);
}

TEST(TransferMatrix, IntervalsOfOnePolicyAreOverItsStarts) {
  const std::vector<PolicyCell> cells{cell("p", "a", "a", {0.2, 0.4}), cell("p", "a", "b", {0.5, 0.9})};
  const TransferMatrix matrix = transfer_matrix(cells);
  ASSERT_EQ(matrix.entries.size(), 2U);
  const MatrixEntry& home = entry(matrix, "a", "a");
  EXPECT_EQ(home.policies, 1U);
  EXPECT_DOUBLE_EQ(home.score.estimate, 0.3);
  EXPECT_NEAR(home.score.half_width(), half_of_two(0.2, 0.4), 1e-6);
  EXPECT_FALSE(home.loss) << "nothing is lost at home";
  const MatrixEntry& away = entry(matrix, "a", "b");
  ASSERT_TRUE(away.loss);
  EXPECT_DOUBLE_EQ(away.loss->estimate, 0.4);  // start by start: 0.3 and 0.5
  EXPECT_NEAR(away.loss->half_width(), half_of_two(0.3, 0.5), 1e-6);
  EXPECT_EQ(matrix.summary,
            "The policy trained in a scores 0.30 (-0.97 to 1.57) at home and loses 0.40 (-0.87 to 1.67) "
            "elsewhere.");
}

TEST(TransferMatrix, IntervalsOfSeveralPoliciesAreOverThem) {
  const std::vector<PolicyCell> cells{cell("p", "a", "a", {0.1, 0.3}), cell("p", "a", "b", {0.4, 0.4}),
                                      cell("q", "a", "a", {0.2, 0.2}), cell("q", "a", "b", {0.8, 0.6})};
  const TransferMatrix matrix = transfer_matrix(cells);
  const MatrixEntry& away = entry(matrix, "a", "b");
  EXPECT_EQ(away.policies, 2U);
  EXPECT_DOUBLE_EQ(away.score.estimate, 0.55);
  EXPECT_NEAR(away.score.half_width(), half_of_two(0.4, 0.7), 1e-6);
  EXPECT_NEAR(away.loss->estimate, 0.35, 1e-15);
  EXPECT_NEAR(away.loss->half_width(), half_of_two(0.2, 0.5), 1e-6);
  EXPECT_NE(matrix.summary.find("2 policies trained in a score 0.20 (0.20 to 0.20) at home and lose 0.35 "),
            std::string::npos)
      << matrix.summary;
}

TEST(TransferMatrix, SaysWhoseLoseLeastWhereIntervalsDoNotOverlap) {
  const auto of = [](const std::string& name, const std::string& home, double away, double spread) {
    std::vector<PolicyCell> cells;
    for (const std::string engine : {"a", "b"}) {
      const double score = engine == home ? 0.2 : 0.2 + away;
      cells.push_back(cell(name, home, engine, {score, score + (engine == home ? 0 : spread)}));
    }
    return cells;
  };
  const auto matrix_of = [](std::vector<PolicyCell> x, const std::vector<PolicyCell>& y) {
    x.insert(x.end(), y.begin(), y.end());
    return transfer_matrix(x);
  };
  const std::string sure = matrix_of(of("p", "a", 0.5, 1e-3), of("q", "b", 0.1, 1e-3)).summary;
  EXPECT_NE(sure.find("What is trained in b loses least."), std::string::npos) << sure;
  const std::string unsure = matrix_of(of("p", "a", 0.5, 0.2), of("q", "b", 0.1, 0.2)).summary;
  EXPECT_NE(unsure.find("no home's policies lose less than another's"), std::string::npos) << unsure;
}

TEST(TransferMatrix, SaysNothingOfALossWithoutAHome) {
  const TransferMatrix nobody = transfer_matrix(std::vector{cell("p", "", "a", {0.2, 0.4})});
  EXPECT_FALSE(nobody.entries.front().loss);
  EXPECT_EQ(nobody.summary,
            "The policy trained in an engine nobody names: nothing is said of what is lost elsewhere.");
  const TransferMatrix absent = transfer_matrix(std::vector{cell("p", "x", "a", {0.2, 0.4})});
  EXPECT_NE(absent.summary.find("not among the engines"), std::string::npos);
  const TransferMatrix alone = transfer_matrix(std::vector{cell("p", "a", "a", {0.2, 0.4})});
  EXPECT_EQ(alone.summary, "The policy trained in a scores 0.30 (-0.97 to 1.57) at home.");
  const nlohmann::ordered_json json =
      to_json(nobody, std::vector{cell("p", "", "a", {0.2, 0.4})}, PolicyScoreOptions());
  EXPECT_TRUE(json.at("homes").at(0).at("trained_in").is_null());
  EXPECT_TRUE(json.at("homes").at(0).at("loss").is_null());
}

}  // namespace
}  // namespace crossgait
