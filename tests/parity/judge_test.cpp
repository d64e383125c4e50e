// The rule on rows of numbers made by hand: every word of it on its own.
#include "parity/judge.h"

#include <cmath>

#include <gtest/gtest.h>

#include "physics/core/random.h"

namespace crossgait {
namespace {

constexpr double kMargin = 0.1, kResolution = kMargin / 20;

/// Twelve starts that lie `apart` from one another; the second engine is `gap` further, give or take `noise`.
struct Truth {
  double gap = 0, noise = 0.01, apart = 0.2;
  std::optional<double> half = {};  ///< the gap at half the step
  std::size_t starts = 12;
  std::uint64_t seed = 1;
  Margin margin = {0, kMargin, false, "by hand"};
};

StatisticRuns runs_of(const Truth& truth) {
  StatisticRuns runs;
  runs.statistic = {"way_m", "way", "m", truth.margin};
  runs.seconds = 1;
  Random random(truth.seed), at_half(truth.seed + 1000);
  for (std::size_t k = 0; k < truth.starts; ++k) {
    const double start = 1 + random.uniform(-truth.apart, truth.apart),
                 own = truth.noise * random.uniform(-1, 1);
    runs.as_asked.a.push_back(start);
    runs.as_asked.b.push_back(start + truth.gap + own);
    if (!truth.half) continue;
    runs.at_step = runs.as_asked;
    runs.step_seconds = runs.seconds;
    runs.at_half.a.push_back(start);
    runs.at_half.b.push_back(start + *truth.half + own + 0.1 * truth.noise * at_half.uniform(-1, 1));
  }
  return runs;
}

StatisticRuns shares(std::size_t starts, std::size_t only_b) {
  StatisticRuns runs;
  runs.statistic = {"failures", "failures", "fraction", {0, 0.1, false, ""}};
  runs.is_share = true;
  for (std::size_t k = 0; k < starts; ++k) {
    runs.as_asked.a.push_back(0);
    runs.as_asked.b.push_back(k < only_b ? 1 : 0);
  }
  return runs;
}

StatisticVerdict judged(const Truth& truth) { return judge({runs_of(truth)}, {}).front(); }

TEST(Judge, AgreesWithinTheMarginAndDiffersBeyond) {
  EXPECT_EQ(judged({.gap = 0.05}).word, Word::kAgrees);
  EXPECT_EQ(judged({.gap = -0.05}).word, Word::kAgrees);
  EXPECT_EQ(judged({.gap = 0.2}).word, Word::kDiffers);
  EXPECT_EQ(judged({.gap = -0.2}).word, Word::kDiffers);
  const StatisticVerdict near = judged({.gap = 0.1});
  EXPECT_EQ(near.word, Word::kUnresolved);
  EXPECT_NE(near.reason.find("crosses the margin"), std::string::npos) << near.reason;
}

// A word takes more than an interval beyond the margin where a row's starts are too few for its test.
TEST(Judge, DoesNotSayThatAnIntervalCrossesAMarginThatLiesBeforeIt) {
  StatisticRuns runs = runs_of({.gap = 0});
  runs.as_asked.a.assign(6, 0.0);
  runs.as_asked.b = {5, 5.1, 5.2, 5.3, 5.4, 40};  // a heavy tail: the median, of which six starts are too few
  const std::vector<StatisticVerdict> verdicts = judge({runs}, {.starts = 6, .confidence = 0.999});
  const StatisticVerdict& v = verdicts.front();
  ASSERT_EQ(v.word, Word::kUnresolved);
  if (v.gap.low > v.margin) {
    EXPECT_EQ(v.reason.find("crosses"), std::string::npos) << v.reason;
    EXPECT_NE(v.reason.find("fewer than"), std::string::npos) << v.reason;
  } else {
    ADD_FAILURE() << v.gap.low << " to " << v.gap.high << ", margin " << v.margin;
  }
}

// Starts are the user's own choice: how far they lie apart changes nothing.
TEST(Judge, TheSpreadOfStartsHasNoPartInIt) {
  const StatisticVerdict narrow = judged({.gap = 0.2, .apart = 0.01}),
                         wide = judged({.gap = 0.2, .apart = 0.9});
  EXPECT_EQ(narrow.word, Word::kDiffers);
  EXPECT_EQ(wide.word, Word::kDiffers);
  EXPECT_NEAR(wide.gap.low, narrow.gap.low, 1e-12);
}

// What cannot be excluded never agrees, however little is known.
TEST(Judge, WideIntervalsAreUnresolvedAndSayHowManyStartsWouldTell) {
  const StatisticVerdict v = judged({.gap = 0.02, .noise = 0.4});
  EXPECT_EQ(v.word, Word::kUnresolved);
  ASSERT_TRUE(v.starts_needed.has_value());
  EXPECT_GT(*v.starts_needed, 12U);
  EXPECT_EQ(judged({.gap = 0.02, .noise = 0.4, .starts = 2 * *v.starts_needed}).word, Word::kAgrees);
}

TEST(Judge, FewerThanSixStartsHaveNoWord) {
  const StatisticVerdict v = judged({.gap = 0, .noise = 0, .starts = 5});
  EXPECT_EQ(v.word, Word::kUnresolved);
  EXPECT_EQ(v.starts_needed, 6U);
  EXPECT_NE(v.reason.find("fewer than 6"), std::string::npos) << v.reason;
  EXPECT_EQ(judged({.gap = 5, .noise = 0, .starts = 5}).word, Word::kUnresolved);
  EXPECT_EQ(judge({StatisticRuns()}, {}).front().word, Word::kUnresolved) << "nobody has a value";
}

TEST(Judge, AMarginMayBeAShareOrGrowWithTime) {
  EXPECT_EQ(judged({.gap = 0.2, .margin = {0.3, 0, false, ""}}).word, Word::kAgrees);
  EXPECT_EQ(judged({.gap = 0.2, .margin = {0.01, 0.3, true, ""}}).word, Word::kAgrees);
  StatisticRuns longer = runs_of({.gap = 0.2, .margin = {0, 0.1, true, ""}});
  EXPECT_EQ(judge({longer}, {}).front().word, Word::kDiffers);
  longer.seconds = 3;
  EXPECT_EQ(judge({longer}, {}).front().word, Word::kAgrees);
}

// Holm (1979), by hand: of three with P values below 0.05 / 3, 0.05 / 2 and above 0.05 the first two differ.
TEST(Judge, TestsTogetherAsHolmDoes) {
  std::vector<StatisticRuns> rows;
  for (const double gap : {0.5, 0.1096, 0.05}) rows.push_back(runs_of({.gap = gap, .noise = 0.015}));
  const std::vector<StatisticVerdict> all = judge(rows, {});
  const PairedDifferences second(rows[1].as_asked.differences(), Estimand::kMean, kResolution);
  ASSERT_LE(second.p_beyond(kMargin), 0.05 / 2) << "take another gap to tell by";
  ASSERT_GT(second.p_beyond(kMargin), 0.05 / 3) << "take another gap to tell by";
  EXPECT_EQ(all[0].word, Word::kDiffers);
  EXPECT_EQ(all[1].word, Word::kDiffers);
  EXPECT_EQ(all[2].word, Word::kAgrees);
  // Intervals that hold together whatever is rejected (Bonferroni).
  for (std::size_t i = 0; i < 3; ++i) {
    const Interval expected = PairedDifferences(rows[i].as_asked.differences(), Estimand::kMean, kResolution)
                                  .interval(1 - 0.05 / 3);
    EXPECT_NEAR(all[i].gap.low, expected.low, 1e-12);
    EXPECT_NEAR(all[i].gap.high, expected.high, 1e-12);
  }
  // Without the first it has to stand against 0.05 / 2 as the smallest, and still does; with three more that
  // agree it does not.
  for (int i = 0; i < 3; ++i) rows.push_back(rows[2]);
  EXPECT_EQ(judge(rows, {})[1].word, Word::kUnresolved);
}

TEST(Judge, LooksShareTheError) {
  const Truth truth{.gap = 0.112, .noise = 0.02};
  const PairedDifferences d(runs_of(truth).as_asked.differences(), Estimand::kMean, kResolution);
  ASSERT_LE(d.p_beyond(kMargin), 0.05);
  ASSERT_GT(d.p_beyond(kMargin), 0.05 / 4) << "take another gap to tell by";
  EXPECT_EQ(judge({runs_of(truth)}, {}).front().word, Word::kDiffers);
  EXPECT_EQ(judge({runs_of(truth)}, {.looks = 4}).front().word, Word::kUnresolved);
}

// A twentieth of the margin is too small to matter: what lies nearer to it than that is not told apart from
// it.
TEST(Judge, KeepsATwentiethOfTheMarginOff) {
  EXPECT_EQ(judged({.gap = 0.094, .noise = 1e-3}).word, Word::kAgrees);
  EXPECT_EQ(judged({.gap = 0.0962, .noise = 2e-2, .starts = 200}).word, Word::kUnresolved);
  EXPECT_EQ(judged({.gap = 0.1038, .noise = 2e-2, .starts = 200}).word, Word::kUnresolved);
  EXPECT_EQ(judged({.gap = 0.115, .noise = 1e-3}).word, Word::kDiffers);
  const StatisticVerdict same = judged({.gap = 1e-12, .noise = 1e-13});
  EXPECT_LT(same.gap.half_width(), 1e-12) << "engines of one law are known better than that";
}

// Whoever fails now and then makes differences of two kinds: the median of all of them is judged, by an exact
// test, and with so few starts that it has none nothing differs.
TEST(Judge, WhereRunsEndEarlyTheMedianIsJudged) {
  StatisticRuns runs = runs_of({.gap = 0.3});
  runs.ends_early.assign(runs.as_asked.a.size(), false);
  EXPECT_EQ(judge({runs}, {}).front().estimand, Estimand::kMean);
  runs.ends_early[3] = true;
  const StatisticVerdict v = judge({runs}, {}).front();
  EXPECT_EQ(v.estimand, Estimand::kMedian);
  EXPECT_EQ(v.word, Word::kDiffers);
  EXPECT_NE(v.reason.find("end early"), std::string::npos) << v.reason;

  StatisticRuns few = runs_of({.gap = 0.3, .starts = 6});
  few.ends_early.assign(6, true);
  EXPECT_EQ(judge({few}, {}).front().word, Word::kDiffers) << "2 / 2^6 is below 5 %";
  const std::vector<StatisticVerdict> two = judge({few, few}, {});
  EXPECT_EQ(two.front().word, Word::kUnresolved) << "and not below 2.5 %";
  EXPECT_EQ(two.front().starts_needed, 7U);
}

TEST(Judge, AStepThatTakesTheGapAwayIsNamed) {
  EXPECT_EQ(judged({.gap = 0.3, .half = 0.28}).word, Word::kDiffers);
  const StatisticVerdict halved = judged({.gap = 0.5, .half = 0.2});
  EXPECT_EQ(halved.word, Word::kStepDependent);
  EXPECT_NEAR(halved.step->change.estimate, -0.3, 0.01);
  EXPECT_EQ(judged({.gap = 0.3, .half = -0.3}).word, Word::kStepDependent);
  // Of first order, and nothing is left where the step goes to zero.
  EXPECT_EQ(judged({.gap = 0.32, .half = 0.17}).word, Word::kStepDependent);
  const StatisticVerdict gone = judged({.gap = 0.3, .half = 0.02});
  EXPECT_EQ(gone.word, Word::kStepDependent);
  EXPECT_NE(gone.reason.find("within the margin at half"), std::string::npos) << gone.reason;
  EXPECT_EQ(judged({.gap = 0.02, .half = 0.3}).word, Word::kStepDependent);
  EXPECT_EQ(judged({.gap = 0.02, .half = 0.1}).word, Word::kUnresolved);
  // Nobody fails as asked, and some do in one engine at half the step.
  StatisticRuns failing = shares(12, 0);
  failing.at_step = failing.as_asked;
  failing.at_half = shares(12, 5).as_asked;
  EXPECT_EQ(judge({failing}, {}).front().word, Word::kUnresolved);
  EXPECT_EQ(judged({.gap = 0.05, .half = 0.01}).word, Word::kAgrees) << "within the margin at both";
}

// One run of six that strays as asked and at half the step does not is chance: two halves of one engine's
// runs do that.
TEST(Judge, ASingleRunThatIsNotThereAtHalfTheStepIsNoDependence) {
  StatisticRuns runs = shares(6, 1);
  runs.at_step = runs.as_asked;
  runs.at_half = shares(6, 0).as_asked;
  EXPECT_EQ(judge({runs}, {}).front().word, Word::kUnresolved);
  runs = runs_of({.gap = 0.02, .half = 0.02});
  runs.as_asked.b[3] += 1.5;  // the mean is beyond the margin
  runs.at_step = runs.as_asked;
  EXPECT_EQ(judge({runs}, {}).front().word, Word::kUnresolved);
  // All that stray do so because of the step.
  runs = shares(12, 6);
  runs.at_step = runs.as_asked;
  runs.at_half = shares(12, 0).as_asked;
  EXPECT_EQ(judge({runs}, {}).front().word, Word::kStepDependent);
}

// Never into *agrees*.
TEST(Judge, AStepMakesNothingAgree) {
  Random random(4);
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    Truth truth{.gap = random.uniform(-0.4, 0.4), .noise = random.uniform(0.01, 0.3), .seed = seed};
    const Word without = judged(truth).word;
    truth.half = random.uniform(-0.4, 0.4);
    const Word with = judged(truth).word;
    if (with == Word::kAgrees) {
      EXPECT_EQ(without, Word::kAgrees) << seed;
    }
  }
}

TEST(Judge, ThreeStepsLeadToALimitWhereTheyFallInWithAnOrder) {
  // First order: 0.05 + 0.4 h at h = 1, 1/2, 1/4.
  StatisticRuns runs = runs_of({.gap = 0.45, .noise = 0.001, .half = 0.25});
  runs.at_quarter = runs.at_step;
  for (std::size_t k = 0; k < runs.at_quarter.a.size(); ++k)
    runs.at_quarter.b[k] = runs.at_step.b[k] - 0.45 + 0.15;
  const StatisticVerdict v = judge({runs}, {}).front();
  ASSERT_TRUE(v.step->extrapolated.has_value());
  EXPECT_NEAR(*v.step->order, 1, 0.02);  // of gaps that are known to 1e-3
  EXPECT_NEAR(*v.step->extrapolated, 0.05, 0.005);
  for (double& b : runs.at_quarter.b) b += 0.4;  // away again: no limit
  EXPECT_FALSE(judge({runs}, {}).front().step->extrapolated.has_value());
}

TEST(Judge, SharesAreJudgedExactly) {
  EXPECT_EQ(judge({shares(24, 15)}, {}).front().word, Word::kDiffers);
  EXPECT_EQ(judge({shares(24, 1)}, {}).front().word, Word::kUnresolved);
  EXPECT_EQ(judge({shares(200, 2)}, {}).front().word, Word::kAgrees);
  // Nobody failed: the limit is stated, and nothing is unresolved.
  const StatisticVerdict none = judge({shares(12, 0)}, {}).front();
  EXPECT_EQ(none.word, Word::kAgrees);
  EXPECT_NE(none.reason.find("above 22 %"), std::string::npos) << none.reason;
  StatisticRuns all = shares(12, 12);
  all.as_asked.a = all.as_asked.b;
  EXPECT_NE(judge({all}, {}).front().reason.find("the same in every start"), std::string::npos);
}

TEST(Judge, HeavyTailsAreJudgedByTheirMedian) {
  StatisticRuns runs = runs_of({.gap = 0.05});
  runs.as_asked.b[3] += 8;
  const StatisticVerdict v = judge({runs}, {}).front();
  EXPECT_EQ(v.estimand, Estimand::kMedian);
  EXPECT_NEAR(v.gap.estimate, 0.05, 0.01);
  EXPECT_NE(v.reason.find("heavy tails"), std::string::npos) << v.reason;
  // Within the margin but for one start, which is eight metres beyond: that is no agreement.
  EXPECT_EQ(v.word, Word::kUnresolved);
  EXPECT_FALSE(v.starts_needed.has_value());
  for (double& b : runs.as_asked.b) b += 0.3;
  EXPECT_EQ(judge({runs}, {}).front().word, Word::kDiffers);
}

// A share of the size is of what is judged: one start that is a hundred times as large widens no margin.
TEST(Judge, TheMarginOfAMedianIsAShareOfTheMedian) {
  StatisticRuns runs = runs_of({.gap = 0.2, .apart = 0.01, .margin = {0.02, 0.02, false, ""}});
  runs.as_asked.b[3] = 100;
  const StatisticVerdict v = judge({runs}, {}).front();
  EXPECT_EQ(v.estimand, Estimand::kMedian);
  EXPECT_NEAR(v.margin, 0.022, 0.001);
  EXPECT_EQ(v.word, Word::kDiffers);
}

// Runs that end sooner at half the step are compared against the margin for that time.
TEST(Judge, TheStepIsJudgedByTheMarginForTheTimeThatItLasts) {
  StatisticRuns runs = runs_of({.gap = 0.3, .half = 0.3, .margin = {0, 0.1, true, ""}});
  for (PairedValues* values : {&runs.at_step, &runs.at_half}) {
    for (std::size_t k = 0; k < values->a.size(); ++k)
      values->b[k] = values->a[k] + 0.1 * (values->b[k] - values->a[k]);
  }
  runs.step_seconds = 0.1 * runs.seconds;
  EXPECT_EQ(judge({runs}, {}).front().word, Word::kDiffers) << "a tenth of the gap in a tenth of the time";
}

TEST(Judge, RunsThatFailAtOnceHaveNoWordForTheRest) {
  StatisticRuns runs = runs_of({.gap = 0});
  runs.is_cut_short = true;
  const StatisticVerdict v = judge({runs}, {}).front();
  EXPECT_EQ(v.word, Word::kUnresolved);
  EXPECT_NE(v.reason.find("says nothing"), std::string::npos) << v.reason;
}

// With the truth exactly at the margin of both statistics *agrees* is wrong, and *differs* of either: at most
// 5 % each, as promised, from 6 starts on.
TEST(Judge, IsRarelyWrong) {
  constexpr int kRepetitions = 2000;
  for (const std::size_t starts : {6U, 12U}) {
    int agrees = 0, differs = 0;
    for (int r = 0; r < kRepetitions; ++r) {
      const auto seed = static_cast<std::uint64_t>(2 * r);
      const std::vector<StatisticVerdict> all =
          judge({runs_of({.gap = 0.1, .noise = 0.05, .starts = starts, .seed = seed}),
                 runs_of({.gap = -0.1, .noise = 0.05, .starts = starts, .seed = seed + 1})},
                {});
      agrees += all[0].word == Word::kAgrees;
      differs += all[0].word == Word::kDiffers || all[1].word == Word::kDiffers;
    }
    // Four standard errors: 2 %.
    EXPECT_LE(agrees, 0.07 * kRepetitions) << starts;
    EXPECT_LE(differs, 0.07 * kRepetitions) << starts;
  }
}

}  // namespace
}  // namespace crossgait
