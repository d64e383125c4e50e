// Walks in step are the walks alone, and comparing them as they go is comparing their traces.
#include "parity/comparison.h"

#include <bit>

#include <gtest/gtest.h>

#include "backends/registry.h"
#include "motion/gait_source.h"
#include "parity/one_step.h"
#include "physics/robot_files/data_path.h"
#include "tests/support/motion_bits.h"

namespace crossgait {
namespace {

WorldSpec rough() {
  WorldSpec spec;
  spec.robot = std::make_shared<const RobotDescription>(load_robot(find_robot("scara_quadruped")));
  spec.terrain = make_terrain("rough", 3);
  return spec;
}

WalkSetup trot(double seconds) {
  WalkSetup setup;
  setup.gait = "trot";
  setup.make_controller = [](const WorldSpec& world) {
    return make_gait_controller(choose_gait("trot", {}), world);
  };
  setup.timing.seconds = seconds;
  return setup;
}

std::vector<std::unique_ptr<PhysicsBackend>> worlds(const WorldSpec& spec) {
  std::vector<std::unique_ptr<PhysicsBackend>> all;
  for (const std::string& engine : available_engines()) all.push_back(find_engine(engine).make(spec));
  return all;
}

void expect_same_bits(double a, double b) {
  EXPECT_EQ(std::bit_cast<std::uint64_t>(a), std::bit_cast<std::uint64_t>(b)) << a << " and " << b;
}

TEST(WalksInStep, AreTheWalksAloneAndComparedLikeTheirTraces) {
  const WalkSetup setup = trot(0.6);
  std::vector<Trace> alone, together;
  std::vector<WalkRun> runs;
  for (const auto& world : worlds(rough())) {
    TraceRecorder recorder;
    runs.push_back(record_walk(*world, setup, {}, &recorder));
    alone.push_back(recorder.take());
  }
  std::vector<TraceRecorder> recorders(alone.size());
  TraceSinks sinks;
  for (TraceRecorder& recorder : recorders) sinks.push_back(&recorder);
  const Comparison comparison = compare_engines(worlds(rough()), setup, {}, {}, sinks);
  for (TraceRecorder& recorder : recorders) together.push_back(recorder.take());
  ASSERT_EQ(comparison.runs.size(), alone.size());
  for (std::size_t i = 0; i < alone.size(); ++i) {
    EXPECT_EQ(differences(comparison.runs[i].summary, runs[i].summary), "");
    ASSERT_EQ(alone[i].size(), 300U);
    ASSERT_EQ(together[i].size(), alone[i].size());
    for (std::size_t k = 0; k < alone[i].size(); ++k)
      EXPECT_TRUE(identical(alone[i][k], together[i][k])) << k;
  }
  std::size_t pair = 0;
  for (std::size_t i = 0; i < alone.size(); ++i) {
    for (std::size_t k = i + 1; k < alone.size(); ++k, ++pair) {
      const PairDifference& p = comparison.pairs.at(pair);
      const PairDifference whole = compare_traces(alone[i], alone[k], p.tolerances);
      expect_same_bits(p.max_position_difference_m, whole.max_position_difference_m);
      expect_same_bits(p.max_joint_difference_rad, whole.max_joint_difference_rad);
      expect_same_bits(p.max_attitude_difference_rad, whole.max_attitude_difference_rad);
      ASSERT_EQ(p.first_divergence.has_value(), whole.first_divergence.has_value());
      if (whole.first_divergence)
        expect_same_bits(p.first_divergence->time_s, whole.first_divergence->time_s);
      EXPECT_EQ(p.same_laws, runs[i].engine.laws == runs[k].engine.laws);
    }
  }
}

// A control step from the same state is the same in engines of one law, and another one under another law,
// whatever chaos makes of the walks.
TEST(OneStep, TellsALawFromChaos) {
  const std::vector<std::string> names = available_engines();
  std::vector<std::size_t> matched;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (find_engine(names[i]).info.laws == find_engine(names.front()).info.laws) matched.push_back(i);
  }
  if (matched.size() < 2) GTEST_SKIP() << "no two engines of one law";
  const auto compared = [&](const WorldSpec& of_first, const WorldSpec& of_others) {
    std::vector<std::unique_ptr<PhysicsBackend>> all;
    for (const std::size_t i : matched) {
      const bool first = i == matched.front();
      all.push_back(find_engine(names[i]).make(first ? of_first : of_others));
    }
    return compare_engines(all, trot(1.5), {}, {}, {}, [&](std::size_t place) {
      return find_engine(names[matched[place]]).make(of_others);
    });
  };
  const Comparison same = compared(rough(), rough());
  ASSERT_TRUE(same.pairs.front().one_step);
  EXPECT_EQ(same.pairs.front().one_step->steps, 749);  // but for the first of 750
  for (const PairDifference& pair : same.pairs)
    EXPECT_LT(pair.one_step->largest(), one_step_tolerance(pair.precision) / 10);
  EXPECT_TRUE(missed_parity(same).empty());
  WorldSpec other = rough();
  other.contact.friction *= 1.01;
  const Comparison wrong = compared(rough(), other);
  EXPECT_GT(wrong.pairs.front().one_step->largest(), 10 * kOneStepTolerance);
  ASSERT_FALSE(missed_parity(wrong).empty());
  EXPECT_NE(missed_parity(wrong).front().find("after one control step"), std::string::npos);
  // Contacts so stiff that rounding is as large as the motion within a tenth of a second; that of float32 is
  // so in every single step.
  std::erase_if(matched, [&](std::size_t i) {
    return find_engine(names[i]).info.capabilities.precision != Precision::kFloat64;
  });
  if (matched.size() < 2) return;
  WorldSpec stiff = rough();
  stiff.terrain = Terrain();
  stiff.contact.impratio = 1000;
  stiff.contact.softness.time_constant = 2e-3;
  stiff.contact.softness.damping_ratio = 0.3;
  const Comparison chaotic = compared(stiff, stiff);
  EXPECT_TRUE(missed_parity(chaotic).empty()) << missed_parity(chaotic).front();
  const auto& first = chaotic.pairs.front().first_divergence;
  ASSERT_TRUE(first);
  ASSERT_TRUE(first->carried);
  EXPECT_GT(*first->carried, 0);
  EXPECT_LT(*first->carried, first->tolerance / 2);
}

// Two walks of one law that chaos parts are the same; what parts at once, or without a look at single steps,
// is not.
TEST(MissedParity, IsNoMatterOfChaos) {
  Comparison comparison;
  for (const char* engine : {"a", "b"}) {
    comparison.runs.emplace_back();
    comparison.runs.back().engine.name = engine;
  }
  PairDifference& pair = comparison.pairs.emplace_back();
  pair.a = "a", pair.b = "b", pair.same_laws = true;
  pair.one_step = OneStepDifference{1e-12, 1e-12, 1e-12, 3, 1000};
  EXPECT_TRUE(missed_parity(comparison).empty());
  pair.first_divergence = FirstDivergence{"joint", 12.5, 1e-6};
  comparison.runs.back().summary.physics_steps = 1;  // it fell
  EXPECT_TRUE(missed_parity(comparison).empty());
  pair.first_divergence->time_s = 0.9;
  EXPECT_EQ(missed_parity(comparison), std::vector<std::string>{"a and b (beyond 1e-06 at 0.900 s)"});
  pair.first_divergence->carried = 4e-7;  // of 1e-6: chaos alone can have made the rest
  EXPECT_TRUE(missed_parity(comparison).empty());
  pair.first_divergence->carried = 6e-7;
  EXPECT_EQ(missed_parity(comparison).size(), 1U);
  pair.first_divergence->time_s = 12.5;
  pair.one_step.reset();
  EXPECT_EQ(missed_parity(comparison).size(), 1U);
  pair.first_divergence.reset();
  EXPECT_EQ(missed_parity(comparison), std::vector<std::string>{"a and b (walks of different lengths)"});
  pair.one_step = OneStepDifference{2e-8, 0, 0, 3, 1000};
  EXPECT_NE(missed_parity(comparison).front().find("2e-08 apart after one control step"), std::string::npos);
  pair.same_laws = false;
  EXPECT_TRUE(missed_parity(comparison).empty());
}

TEST(InterruptedWalks, AreWhatWasWalked) {
  const WalkSetup setup = trot(10);
  const Progress stop = [](double share) {
    if (share >= 0.02) throw Interrupted();  // 100 of 5000 control steps
  };
  const auto all = worlds(rough());
  const WalkRun run = record_walk(*all.front(), setup, stop);
  EXPECT_TRUE(run.interrupted);
  EXPECT_NEAR(run.summary.simulated_seconds, 0.2, 1e-9);
  const Comparison comparison = compare_engines(worlds(rough()), setup, {}, stop);
  EXPECT_TRUE(comparison.interrupted);
  for (const WalkRun& one : comparison.runs) EXPECT_NEAR(one.summary.simulated_seconds, 0.2, 1e-9);
}

}  // namespace
}  // namespace crossgait
