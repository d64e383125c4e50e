#include "gait/gait.h"

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "gait/phase_clock.h"
#include "physics/core/error.h"

namespace crossgait {
namespace {

/// Which legs swing in the middle of each named phase, as "FL RR".
std::vector<std::pair<std::string, std::string>> sequence(const Gait& gait) {
  std::vector<std::pair<std::string, std::string>> result;
  for (std::size_t i = 0; i < gait.phases.size() && !gait.phases[i].name.empty(); ++i) {
    const bool last = i + 1 == gait.phases.size() || gait.phases[i + 1].name.empty();
    const double middle = (gait.phases[i].start + (last ? 1 : gait.phases[i + 1].start)) / 2;
    std::string swinging;
    for (const Leg leg : kLegs) {
      if (!leg_phase(middle, gait.offset[leg], gait.preferred.duty_factor).swing) continue;
      if (!swinging.empty()) swinging += " ";
      swinging += name(leg);
    }
    result.emplace_back(gait.phases[i].name, swinging);
  }
  return result;
}

using Sequence = std::vector<std::pair<std::string, std::string>>;

TEST(Gaits, SwingTheLegsTheirPhasesName) {
  const std::map<std::string, Sequence> expected = {
      {"trot", {{"pair_a_swing", "FL RR"}, {"pair_b_swing", "FR RL"}}},
      {"walk", {{"rl_swing", "RL"}, {"fl_swing", "FL"}, {"rr_swing", "RR"}, {"fr_swing", "FR"}}},
      {"pace",
       {{"left_swing", "FL RL"}, {"left_stance", ""}, {"right_swing", "FR RR"}, {"right_stance", ""}}},
      {"bound",
       {{"front_swing", "FL FR"}, {"front_stance", ""}, {"rear_swing", "RL RR"}, {"rear_stance", ""}}},
      {"trot:guide", {{"pair_a_swing", "FL RR"}, {"pair_b_swing", "FR RL"}}},
      {"walk:guide", {{"rl_swing", "RL"}, {"fl_swing", "FL"}, {"rr_swing", "RR"}, {"fr_swing", "FR"}}},
      {"gallop:guide",
       {{"front_swing", "FL FR"}, {"front_stance", ""}, {"rear_swing", "RL RR"}, {"rear_stance", ""}}},
      {"pronk", {{"flight", "FL FR RL RR"}, {"stance", ""}}},
      {"gallop",
       {{"front_swing", "FL FR"}, {"front_stance", ""}, {"rear_swing", "RL RR"}, {"rear_stance", ""}}},
  };
  // A further gait is held to the next test, which asks all of them.
  for (const auto& [name, phases] : expected) EXPECT_EQ(sequence(find_gait(name)), phases) << name;
}

TEST(Gaits, ChangeLegsExactlyWhereTheirPhasesChange) {
  constexpr double kNear = 1e-9;
  for (const Gait& gait : gaits()) {
    for (const GaitPhase& part : gait.phases) {
      if (part.name.empty()) break;
      bool changes = false;
      for (const Leg leg : kLegs) {
        const bool before = leg_phase(part.start - kNear, gait.offset[leg], gait.preferred.duty_factor).swing;
        const bool after = leg_phase(part.start + kNear, gait.offset[leg], gait.preferred.duty_factor).swing;
        changes |= before != after;
      }
      EXPECT_TRUE(changes) << gait.name << " " << part.name;
    }
  }
}

TEST(Gaits, AreValidAndThoseOfTheGuideHaveItsCycleTimes) {
  for (const Gait& gait : gaits()) EXPECT_NO_THROW(validate(gait));
  EXPECT_EQ(find_gait("walk:guide").preferred.cycle_time, 1.2);
  EXPECT_EQ(find_gait("trot:guide").preferred.cycle_time, 0.8);
  EXPECT_EQ(find_gait("gallop:guide").preferred.cycle_time, 0.6);
}

TEST(Gaits, AnUnknownNameIsAnErrorThatListsTheKnown) {
  try {
    find_gait("canter");
    FAIL() << "no error";
  } catch (const ConfigError& e) {
    EXPECT_EQ(e.found(), "'canter'");
    EXPECT_NE(e.expected().find("trot, walk"), std::string::npos) << e.what();
  }
}

TEST(GaitPhases, AreFoundByPhase) {
  const Gait& gallop = find_gait("gallop");
  EXPECT_EQ(phase_name(gallop, 0), "front_swing");
  EXPECT_EQ(phase_name(gallop, 0.2499), "front_swing");
  EXPECT_EQ(phase_name(gallop, 0.25), "front_stance");
  EXPECT_EQ(phase_name(gallop, 0.6), "rear_swing");
  EXPECT_EQ(phase_name(gallop, 0.999), "rear_stance");
}

TEST(ValidateGait, NamesTheField) {
  const auto element = [](const Gait& gait) {
    try {
      validate(gait);
    } catch (const ConfigError& e) {
      return e.element();
    }
    return std::string("no error");
  };
  Gait gait = find_gait("trot");
  gait.offset[Leg::FR] = 1;
  EXPECT_EQ(element(gait), "offset of FR");
  gait = find_gait("trot");
  gait.preferred.duty_factor = 1;
  EXPECT_EQ(element(gait), "duty_factor");
  gait.preferred.duty_factor = std::nan("");
  EXPECT_EQ(element(gait), "duty_factor");
  gait = find_gait("trot");
  gait.phases[1].start = 0;
  EXPECT_EQ(element(gait), "phase 'pair_b_swing'");
  gait.phases = {};
  EXPECT_EQ(element(gait), "phases");
  gait = find_gait("trot");
  gait.preferred.cycle_time = 0;
  EXPECT_EQ(element(gait), "cycle_time");
}

TEST(LegPhase, RunsThroughSwingThenStance) {
  const double offset = 0.25, duty = 0.75;
  const LegPhase lift_off = leg_phase(0.25, offset, duty);
  EXPECT_TRUE(lift_off.swing);
  EXPECT_EQ(lift_off.progress, 0);
  EXPECT_EQ(leg_phase(0.375, offset, duty).progress, 0.5);
  const LegPhase touchdown = leg_phase(0.5, offset, duty);
  EXPECT_FALSE(touchdown.swing);
  EXPECT_EQ(touchdown.progress, 0);
  const LegPhase late = leg_phase(0.125, offset, duty);
  EXPECT_EQ(late.phase, 0.875);
  EXPECT_NEAR(late.progress, (0.875 - 0.25) / 0.75, 1e-15);  // one rounding
  // A hair before lift-off is the end of the stance, whatever rounds.
  const LegPhase hair = leg_phase(0.1, std::nextafter(0.1, 1), duty);
  EXPECT_TRUE(hair.swing ? hair.progress < 1e-12 : hair.progress > 1 - 1e-12);
  EXPECT_LT(hair.phase, 1);
}

TEST(PhaseClock, WrapsAndKeepsItsPhaseWhenTheCycleTimeChanges) {
  PhaseClock clock;
  clock.advance(0.2, 0.8);
  EXPECT_EQ(clock.phase(), 0.25);
  clock.advance(0.3, 1.2);                 // another quarter
  EXPECT_NEAR(clock.phase(), 0.5, 1e-15);  // one rounding
  clock.advance(100 * 1.2, 1.2);
  EXPECT_NEAR(clock.phase(), 0.5, 1e-13);  // rounding of 100.5
  clock.set(-1e-20);
  EXPECT_EQ(clock.phase(), 0);
}

}  // namespace
}  // namespace crossgait
