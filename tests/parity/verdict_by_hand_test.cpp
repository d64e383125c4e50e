// The rule on two small tables, against numbers worked out with pencil and fractions: every part of it on its
// own, so that none can be dropped or exchanged for another unnoticed.
#include <cmath>

#include <gtest/gtest.h>

#include "parity/verdict.h"

namespace crossgait {
namespace {

using Kind = Variation::Kind;

const std::vector<Variation> kVariations{{"as asked", Kind::kNominal},
                                         {"another step", Kind::kTimeStep},
                                         {"loose", Kind::kSolver},
                                         {"tight", Kind::kSolver}};
// Four starts; the second statistic is there to share the confidence with.
const RunTable kA{{{1, 7}, {2, 7}, {4, 7}, {5, 7}},
                  {{2, 7}, {4, 7}, {5, 7}, {5, 7}},
                  {{0, 7}, {1, 7}, {3, 7}, {4, 7}},
                  {{3, 7}, {6, 7}, {7, 7}, {8, 7}}};
const RunTable kB{{{6, 7}, {8, 7}, {8, 7}, {10, 7}},
                  {{8, 7}, {9, 7}, {11, 7}, {12, 7}},
                  {{8, 7}, {9, 7}, {9, 7}, {10, 7}},
                  {{9, 7}, {8, 7}, {8, 7}, {7, 7}}};
const std::vector<Statistic> kTwo{{"way", "m", 0.1, 0.5}, {"constant", "m", 0, 1}};

// Means over starts: a 3 as asked, 4 at another step, 2 loose, 6 tight; b 8, 10, 9, 8.
// Sample variances over starts: a (4 + 1 + 1 + 4) / 3, b (4 + 0 + 0 + 4) / 3.
constexpr double kStartsA = 10.0 / 3, kStartsB = 8.0 / 3;
// Of the means {3, 4} and {8, 10}, as asked and at another step.
constexpr double kStepA = 1.0 / 2, kStepB = 2;
// Of {3, 2, 6} (mean 11/3: (4 + 25 + 49) / 9 / 2) and {8, 9, 8} (mean 25/3: (1 + 4 + 1) / 9 / 2).
constexpr double kSolverA = 13.0 / 3, kSolverB = 1.0 / 3;
// Mean of the sums 49/6 and 5.
constexpr double kSpread2 = 79.0 / 12;
// A tenth of (3 + 8) / 2, which is more than a half.
constexpr double kFloor = 0.55;

// The same without one start: gap, and squared spread with all three variances taken anew. For the first:
// starts a 7/3 (of {2, 4, 5}), b 4/3 (of {8, 8, 10}); step a 1/2 (means 11/3, 14/3), b 2 (26/3, 32/3); solver
// a 139/27 (11/3, 8/3, 7), b 19/27 (26/3, 29/3, 23/3); together 649/54, half of it 649/108. The others
// likewise.
struct Without {
  double gap, spread2;
};
constexpr Without kWithout[4] = {
    {5, 649.0 / 108}, {14.0 / 3, 821.0 / 108}, {16.0 / 3, 67.0 / 9}, {5, 307.0 / 54}};

// Student's t at .975 and at .95 for 3 degrees of freedom (any table): two statistics share 90 % as 95 %
// each.
constexpr double kT975 = 3.182446305284263, kT95 = 2.353363434801824;
// A few operations on numbers of order one; student_quantile is good to 1e-9.
constexpr double kRounding = 1e-12, kQuantile = 1e-8;

VerdictOptions ninety_percent(double limit = 1) {
  VerdictOptions options;
  options.starts = 4;
  options.confidence = 0.9;
  options.limit = limit;
  return options;
}

StatisticVerdict way(const RunTable& a, const RunTable& b, double limit = 1) {
  return judge(kTwo, kVariations, a, b, ninety_percent(limit)).front();
}

double score_of(double gap, double spread2) { return gap / std::sqrt(spread2 + kFloor * kFloor); }

// Standard error of the score, from the pseudo-values n all - (n - 1) without_i.
double score_error() {
  double pseudo[4], mean = 0, squares = 0;
  for (int i = 0; i < 4; ++i) {
    pseudo[i] = 4 * score_of(5, kSpread2) - 3 * score_of(kWithout[i].gap, kWithout[i].spread2);
    mean += pseudo[i] / 4;
  }
  for (const double p : pseudo) squares += (p - mean) * (p - mean);
  return std::sqrt(squares / (4 * 3));
}

TEST(JudgeByHand, MeansAndThreeVariancesOfEachEngine) {
  const StatisticVerdict v = way(kA, kB);
  EXPECT_EQ(v.statistic.name, "way");
  EXPECT_NEAR(v.mean_a, 3, kRounding);
  EXPECT_NEAR(v.mean_b, 8, kRounding);
  EXPECT_NEAR(v.spread_a.starts, std::sqrt(kStartsA), kRounding);
  EXPECT_NEAR(v.spread_b.starts, std::sqrt(kStartsB), kRounding);
  EXPECT_NEAR(v.spread_a.time_step, std::sqrt(kStepA), kRounding);
  EXPECT_NEAR(v.spread_b.time_step, std::sqrt(kStepB), kRounding);
  EXPECT_NEAR(v.spread_a.solver, std::sqrt(kSolverA), kRounding);
  EXPECT_NEAR(v.spread_b.solver, std::sqrt(kSolverB), kRounding);
  EXPECT_NEAR(v.spread_a.total(), std::sqrt(49.0 / 6), kRounding);
  EXPECT_NEAR(v.spread_b.total(), std::sqrt(5), kRounding);
}

TEST(JudgeByHand, TheSpreadIsPooledByItsMeanSquare) {
  // The larger of the two would be sqrt(49/6), their mean 2.55.
  EXPECT_NEAR(way(kA, kB).spread, std::sqrt(kSpread2), kRounding);
  EXPECT_NEAR(way(kB, kA).spread, std::sqrt(kSpread2), kRounding);
}

TEST(JudgeByHand, TheFloorIsTheLargerOfTheTwo) {
  EXPECT_NEAR(way(kA, kB).floor, kFloor, kRounding);
  const auto floor = [](double relative, double absolute) {
    return judge({{"way", "m", relative, absolute}}, kVariations, kA, kB, ninety_percent()).front().floor;
  };
  EXPECT_NEAR(floor(0.1, 0.6), 0.6, kRounding);
  EXPECT_NEAR(floor(0.2, 0.6), 1.1, kRounding);
  EXPECT_EQ(floor(0, 0), 0);
}

TEST(JudgeByHand, TheGapIsBMinusAWithTheSharedConfidence) {
  // d = 5, 6, 4, 5: the jackknife of a mean is its t interval, of standard error sqrt((0 + 1 + 1 + 0) / 3 /
  // 4).
  const Interval gap = way(kA, kB).gap;
  EXPECT_NEAR(gap.estimate, 5, kRounding);
  EXPECT_NEAR(gap.low, 5 - kT975 / std::sqrt(6), kQuantile);
  EXPECT_NEAR(gap.high, 5 + kT975 / std::sqrt(6), kQuantile);
  EXPECT_NEAR(way(kB, kA).gap.estimate, -5, kRounding);
}

TEST(JudgeByHand, OneStatisticNeedNotShareTheConfidence) {
  const std::vector<Statistic> alone{kTwo.front()};
  const Interval gap = judge(alone, kVariations, kA, kB, ninety_percent()).front().gap;
  EXPECT_NEAR(gap.high, 5 + kT95 / std::sqrt(6), kQuantile);
  const std::vector<Statistic> two = kTwo;
  const auto both = judge(two, kVariations, kA, kB, ninety_percent());
  ASSERT_EQ(both.size(), 2U);
  EXPECT_EQ(both[1].statistic.name, "constant");
  EXPECT_EQ(both[1].mean_a, 7);
  EXPECT_EQ(both[1].value, VerdictValue::kAgrees);
}

TEST(JudgeByHand, TheScoreIsTheGapInSpreadAndFloor) {
  const Interval score = way(kA, kB).score;
  EXPECT_NEAR(score.estimate, score_of(5, kSpread2), kRounding);
  EXPECT_NEAR(score.estimate, 1.9054, 5e-5);  // rounded as written
  EXPECT_NEAR(score.low, score.estimate - kT975 * score_error(), kQuantile);
  EXPECT_NEAR(score.high, score.estimate + kT975 * score_error(), kQuantile);
  const Interval turned = way(kB, kA).score;
  EXPECT_NEAR(turned.low, -score.high, kQuantile);
  EXPECT_NEAR(turned.high, -score.low, kQuantile);
}

TEST(JudgeByHand, TheWordHangsOnTheWholeInterval) {
  // The interval is [1.0945, 2.7164]; it would be [1.3057, 2.5051] with the confidence unshared.
  const auto word = [](double limit, bool turned) {
    return (turned ? way(kB, kA, limit) : way(kA, kB, limit)).value;
  };
  for (const bool turned : {false, true}) {
    EXPECT_EQ(word(1.09, turned), VerdictValue::kEngineDependent) << turned;
    EXPECT_EQ(word(1.10, turned), VerdictValue::kUnresolved) << turned;
    EXPECT_EQ(word(1.90, turned), VerdictValue::kUnresolved) << turned;
    EXPECT_EQ(word(2.71, turned), VerdictValue::kUnresolved) << turned;
    EXPECT_EQ(word(2.72, turned), VerdictValue::kAgrees) << turned;
  }
}

TEST(JudgeByHand, ABehaviourIsTheWorstOfItsStatistics) {
  const auto of = [](const std::vector<VerdictValue>& verdict_values) {
    Verdict verdict;
    for (const VerdictValue c : verdict_values) verdict.statistics.emplace_back().value = c;
    return verdict.value();
  };
  constexpr VerdictValue kAgrees = VerdictValue::kAgrees, kDepends = VerdictValue::kEngineDependent,
                         kOpen = VerdictValue::kUnresolved;
  EXPECT_EQ(of({kAgrees, kAgrees}), kAgrees);
  EXPECT_EQ(of({kAgrees, kOpen}), kOpen);
  EXPECT_EQ(of({kOpen, kAgrees, kDepends}), kDepends);
  EXPECT_EQ(of({kDepends, kOpen}), kDepends);
}

}  // namespace
}  // namespace crossgait
