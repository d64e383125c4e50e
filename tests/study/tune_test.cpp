// Where the search begins, and what is told of its end.
#include "study/tune.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "backends/registry.h"
#include "env/evaluation.h"
#include "physics/core/error.h"
#include "physics/core/random.h"
#include "tests/physics/core/config_error.h"
#include "tests/support/table_rows.h"

namespace crossgait {
namespace {

EnvConfig steps_of(double length) {
  EnvConfig config;
  config.engine = available_engines().front();
  config.episode_seconds = 0.1;
  config.settle_seconds = 0.05;
  config.adapt = {"step_length"};
  config.parameters["step_length"] = length;
  return config;
}

// Draws of the first generation, worked out again: a standard normal distribution by Box and Muller, of half
// the range's half, about the start, within the range.
std::vector<double> first_draws(const EnvConfig& start, std::uint64_t seed, std::size_t count) {
  const ParameterRow row = start.adaptation.row("step_length");
  const double middle = (row.min + row.max) / 2, half = (row.max - row.min) / 2;
  Random random(seed);
  std::vector<double> lengths;
  for (std::size_t k = 0; k < count; ++k) {
    const double u = random.uniform(), v = random.uniform();
    const double normal = std::sqrt(-2 * std::log(1 - u)) * std::cos(2 * M_PI * v);
    lengths.push_back(std::clamp(start.parameters.find("step_length").value() + 0.5 * normal * half,
                                 middle - half, middle + half));
  }
  return lengths;
}

TEST(Tuning, BeginsWithNormalDrawsAboutTheStart) {
  const EnvConfig start = steps_of(0.065);  // the middle of the range
  const TuneOptions options{
      .iterations = 1, .population = 4, .terrains = 1, .unseen = 0, .workers = 1, .seed = 2};
  const Tuning tuning = tune_gait(start, {start.engine}, options);
  std::vector<double> lengths = first_draws(start, options.seed, options.population);
  lengths.erase(lengths.begin());  // the start walks in place of the first
  double nearest = 1;
  for (const double length : lengths)
    nearest = std::min(nearest, std::abs(tuning.tuned.parameters.find("step_length").value() - length));
  EXPECT_LT(nearest, 1e-12);  // rounding of a map to [-1, 1] and back
  EXPECT_NE(tuning.tuned.parameters.find("step_length").value(),
            start.parameters.find("step_length").value());
  ASSERT_EQ(tuning.checks.size(), 2U);  // on no unseen seeds
  EXPECT_EQ(tuning.checks[1].per_engine[0].mean_speed(), tuning.score);
}

TEST(Tuning, ReachingBeyondTheLegsCostsATenthOfItsShare) {
  EnvConfig start = steps_of(0.1);
  start.parameters["body_height"] = 0.1;
  const TuneOptions options{
      .iterations = 1, .population = 4, .terrains = 1, .unseen = 0, .workers = 1, .seed = 2};
  const Tuning tuning = tune_gait(start, {start.engine}, options);
  const Evaluation& walked = tuning.checks[1].per_engine[0];
  ASSERT_GT(walked.motion.of(&MotionSummary::ik_clamped), 0);
  EXPECT_NEAR(tuning.score,
              walked.mean_speed() - 0.1 * static_cast<double>(walked.motion.of(&MotionSummary::ik_clamped)) /
                                        static_cast<double>(walked.steps),
              1e-15);  // rounding
}

// Distance of the start on rough ground of one seed, m.
double walked_on(EnvConfig config, std::uint64_t seed) {
  config.terrain_seed = seed;
  return evaluate_policy(env_factory(config), find_policy("zero").make, 1, 0).front().motion.distance_m;
}

TEST(Tuning, WalksOnSeedsFromItsOwnAndChecksOnThoseBehind) {
  EnvConfig start = steps_of(0.065);
  start.terrain = "rough";
  start.episode_seconds = 0.4;
  const TuneOptions options{
      .iterations = 1, .population = 4, .terrains = 2, .unseen = 1, .workers = 1, .seed = 3};
  const Tuning tuning = tune_gait(start, {start.engine}, options);
  const double third = walked_on(start, 3), fourth = walked_on(start, 4), fifth = walked_on(start, 5);
  EXPECT_NE(third, fourth);
  EXPECT_NE(fourth, fifth);
  ASSERT_EQ(tuning.checks.size(), 4U);  // default and tuned
  EXPECT_NEAR(tuning.checks[0].per_engine[0].motion.of(&MotionSummary::distance_m).mean, (third + fourth) / 2,
              1e-15);  // rounding
  EXPECT_EQ(tuning.checks[2].per_engine[0].motion.of(&MotionSummary::distance_m).mean, fifth);
}

TEST(Tuning, NeedsSomethingToTune) {
  EnvConfig nothing = steps_of(0.05);
  nothing.adapt.clear();
  const TuneOptions options{.iterations = 1, .population = 4, .terrains = 1, .workers = 1};
  try {
    static_cast<void>(tune_gait(nothing, {nothing.engine}, options));
    FAIL() << "tuned nothing";
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.element(), "adapt");
  }
}

Evaluation tuned_walk(double speed, Outcome outcome = Outcome::kWalked) {
  Evaluation e;
  e.episodes = 1;
  e.motion.of(&MotionSummary::mean_speed_mps).mean = speed;
  e.outcomes[static_cast<std::size_t>(outcome)] = 1;
  return e;
}

Tuning some_tuning() {
  Tuning t;
  t.start = steps_of(0.05);
  t.start.engine = "mujoco";
  t.start.terrain = "waves";
  t.start.adapt = {"cycle_time", "step_length"};
  t.start.parameters["cycle_time"] = 1;
  t.tuned = t.start;
  t.tuned.parameters["step_length"] = 0.0625;
  t.tuned.parameters["cycle_time"] = 0.875;
  t.engines = {"mujoco", "bullet"};
  t.history = {0.125, 0.25};
  t.checks = {{"seeds tuned on", "default", {tuned_walk(0.1), tuned_walk(0.2)}},
              {"seeds tuned on", "tuned", {tuned_walk(0.25), tuned_walk(0.3, Outcome::kFell)}},
              {"unseen seeds", "default", {tuned_walk(0.16), tuned_walk(0.2, Outcome::kCollapsed)}},
              {"unseen seeds", "tuned", {tuned_walk(0.2), tuned_walk(0.1)}}};
  return t;
}

TEST(Tuning, OnACourseTheEngineCountsWhereTheScoreIsLowest) {
  const Course course{
      "two",
      0.4,
      {{.name = "even", .speed = 0.3}, {.name = "high", .terrain = "stairs:rise=.02", .speed = 0.2}}};
  EnvConfig start = steps_of(0.05);
  start.adapt = {"cycle_time"};
  const std::vector<std::string> engines = available_engines();
  const TuneOptions options{.iterations = 2,
                            .population = 4,
                            .terrains = 2,
                            .unseen = 1,
                            .workers = 2,
                            .seed = 3,
                            .course = course};
  const Tuning tuning = tune_gait(start, engines, options);
  const auto scores = [&](const EnvConfig& config, std::uint64_t seed, std::size_t runs) {
    const CourseResult result = run_course(course, config, find_policy("zero"), engines,
                                           {.episodes = runs, .workers = 1, .seed = seed});
    std::vector<double> each;
    for (const std::string& engine : engines) each.push_back(result.score(engine).mean);
    return each;
  };
  const std::vector<double> tuned = scores(tuning.tuned, 3, 2), before = scores(tuning.start, 3, 2);
  EXPECT_EQ(tuning.score, *std::min_element(tuned.begin(), tuned.end()));
  EXPECT_GT(tuning.score, *std::min_element(before.begin(), before.end()));
  EXPECT_EQ(tuning.history.back(), tuning.score);
  ASSERT_EQ(tuning.checks.size(), 4U);
  const std::vector<double> unseen = scores(tuning.tuned, 5, 1);
  for (std::size_t k = 0; k < engines.size(); ++k) {
    EXPECT_EQ(tuning.checks[1].course[k].score(engines[k]).mean, tuned[k]);
    EXPECT_EQ(tuning.checks[3].course[k].score(engines[k]).mean, unseen[k]);
  }
  const std::vector<Cells> rows = table_rows(describe(tuning));
  EXPECT_EQ(rows[3][0], "score on course two");
  EXPECT_EQ(rows[4][2], fmt::format("{:.4f}", before[0]));
  const nlohmann::ordered_json json = to_json(tuning);
  EXPECT_EQ(json["course"], "two");
  EXPECT_FALSE(json["checks"][0].contains("all"));
  EXPECT_EQ(json["checks"][0]["course"]["cells"].size(), 2U);
}

TEST(Tuning, ForCostTheCheapestCountsThatIsFastEnough) {
  EnvConfig start = steps_of(0.05);
  start.adapt = {"cycle_time", "body_height"};
  start.command = VelocityCommand{0.2, 0, 0};
  start.episode_seconds = 1.5;
  const TuneOptions options{.iterations = 2,
                            .population = 6,
                            .terrains = 1,
                            .unseen = 0,
                            .workers = 2,
                            .seed = 3,
                            .aim = TuneFor::kCost};
  const Tuning tuning = tune_gait(start, {start.engine}, options);
  ASSERT_EQ(tuning.checks.size(), 2U);
  const Evaluation &before = tuning.checks[0].per_engine[0], &after = tuning.checks[1].per_engine[0];
  ASSERT_TRUE(before.motion.of(&MotionSummary::cost_of_transport) &&
              after.motion.of(&MotionSummary::cost_of_transport));
  const double lacking = std::max(0.0, 0.95 - after.mean_speed() / 0.2);
  EXPECT_DOUBLE_EQ(tuning.score, -after.motion.of(&MotionSummary::cost_of_transport)->mean - 100 * lacking);
  EXPECT_LE(after.motion.of(&MotionSummary::cost_of_transport)->mean + 100 * lacking,
            before.motion.of(&MotionSummary::cost_of_transport)->mean +
                100 * std::max(0.0, 0.95 - before.mean_speed() / 0.2));
  EXPECT_EQ(to_json(tuning)["for"], "cost");
  const std::vector<Cells> rows = table_rows(describe(tuning));
  EXPECT_EQ(rows[4][0], "cost of transport on flat at 0.2 m/s");
  EXPECT_EQ(rows[5][2].substr(0, 7),
            fmt::format("{:.4f}", before.motion.of(&MotionSummary::cost_of_transport)->mean).substr(0, 7));
  start.command.reset();
  const ConfigError error =
      config_error([&] { static_cast<void>(tune_gait(start, {start.engine}, options)); });
  EXPECT_EQ(error.element(), "command");
}

TEST(TuneReport, HasEveryParameterAndEverySpeedWithItsFactor) {
  EXPECT_EQ(table_rows(describe(some_tuning())),
            (std::vector<Cells>{{"parameter", "default", "tuned", "unit"},
                                {"cycle_time", "1.0000", "0.8750", "s"},
                                {"step_length", "0.0500", "0.0625", "m"},
                                {"Tuned in mujoco"},
                                {"mean speed on waves, m/s", "parameters", "mujoco", "bullet"},
                                {"seeds tuned on", "default", "0.1000", "0.2000"},
                                {"seeds tuned on", "tuned", "0.2500 (2.50 x)", "0.3000 (1.50 x), 1 fell"},
                                {"unseen seeds", "default", "0.1600", "0.2000, 1 collapsed"},
                                {"unseen seeds", "tuned", "0.2000 (1.25 x)", "0.1000 (0.50 x)"}}));
}

TEST(TuneReport, AsJsonHasTheTunedParametersAndEveryCheck) {
  Tuning t = some_tuning();
  const nlohmann::ordered_json json = to_json(t);
  EXPECT_EQ(json["schema"]["name"], "tune");
  EXPECT_EQ(json["engine"], "mujoco");
  EXPECT_EQ(json["terrain"], "waves");
  EXPECT_EQ(json["history"], (nlohmann::ordered_json{0.125, 0.25}));
  EXPECT_EQ(json["parameters"], (nlohmann::ordered_json{{"cycle_time", 0.875}, {"step_length", 0.0625}}));
  EXPECT_FALSE(json.contains("interrupted"));
  ASSERT_EQ(json["checks"].size(), 8U);
  EXPECT_EQ(json["checks"][3], (nlohmann::ordered_json{{"ground", "seeds tuned on"},
                                                       {"parameters", "tuned"},
                                                       {"engine", "bullet"},
                                                       {"all", to_json(t.checks[1].per_engine[1])}}));
  t.interrupted = true;
  EXPECT_EQ(to_json(t)["interrupted"], true);
}

}  // namespace
}  // namespace crossgait
