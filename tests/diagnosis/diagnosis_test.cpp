#include "diagnosis/diagnosis.h"

#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "physics/core/error.h"
#include "policy/bundled_policies.h"
#include "tests/physics/core/config_error.h"

namespace crossgait {
namespace {

// A policy that is trained and walks, with one thing or two of its environment wrong.
LoadedEnv patient(const std::string& fault = "{}") {
  const EnvConfig config = load_env_config(*environment_of_policy("serial_joints"));
  return override_env_config(config, fault, "patient.yaml");
}

Diagnosis diagnosis_of(const std::string& fault, DiagnosisOptions options = {}) {
  options.workers = 2;
  options.minutes = 0;  // what is found does not depend on the machine
  return diagnose(patient(fault), "serial_joints", options);
}

const StandingTest& test_of(const Diagnosis& diagnosis, const std::string& name) {
  for (const StandingTest& test : diagnosis.tests)
    if (test.name == name) return test;
  throw std::out_of_range(name);
}

TEST(Diagnose, NamesNothingOfAPolicyThatDoesWhatItIsAsked) {
  const Diagnosis found = diagnosis_of("{}");
  EXPECT_TRUE(found.healthy);
  EXPECT_FALSE(found.cause);
  EXPECT_FALSE(found.abstained);
  EXPECT_TRUE(found.ranking.empty());
  for (const StandingTest& test : found.tests) EXPECT_TRUE(test.passed) << test.name << ": " << test.found;
  EXPECT_EQ(to_json(found).at("cause"), nullptr);
}

TEST(Diagnose, NamesAWrongScaleOfActions) {
  const Diagnosis found = diagnosis_of("joints: {scale: 1}");
  ASSERT_TRUE(found.cause);
  EXPECT_EQ(*found.cause, CauseKind::kContract);
  ASSERT_FALSE(found.ranking.empty());
  const RankedChange& first = found.ranking.front();
  EXPECT_EQ(first.field, "joints.scale");
  EXPECT_TRUE(first.cures);
  EXPECT_GT(first.low, 0);
  EXPECT_GT(first.effect, found.spread);
  // What is written walks as the healthy one does: the scale that it was trained with is 0.5.
  for (const auto& [joint, scale] : found.environment.joints.scale.by_name) EXPECT_NEAR(scale, 0.5, 0.1);
}

TEST(Diagnose, NamesAVelocityInTheWrongFrame) {
  const Diagnosis found = diagnosis_of(
      "observation: [base_linear_velocity, base_angular_velocity_local, gravity, joint_offsets, "
      "joint_velocities, last_action, command]");
  EXPECT_FALSE(test_of(found, "yaw invariance").passed);
  ASSERT_TRUE(found.cause);
  EXPECT_EQ(*found.cause, CauseKind::kContract);
  EXPECT_EQ(found.ranking.front().field, "observation.base_linear_velocity");
}

TEST(Diagnose, NamesTwoFaultsAtOnce) {
  const Diagnosis found = diagnosis_of("joints: {scale: .25}\nservos: {kp: 30}");
  ASSERT_TRUE(found.cause);
  EXPECT_EQ(found.ranking.front().field, "joints.scale + servos.kp");
}

// With either fault alone it falls as soon as with both.
TEST(Diagnose, NamesTwoFaultsOfWhichNeitherShowsAlone) {
  const Diagnosis found = diagnosis_of(
      "observation: [{block: base_linear_velocity_local, scale: [-1, -1, -1]}, base_angular_velocity_local, "
      "gravity, joint_velocities, joint_offsets, last_action, command]");
  ASSERT_TRUE(found.cause);
  EXPECT_EQ(found.ranking.front().field, "observation.base_linear_velocity_local.sign + observation");
}

TEST(Search, APairOfWhichOneCuresAloneStandsBehindIt) {
  std::vector<Candidate> ranked(4);
  ranked[0].fields = {"servos.kp", "joints.observed"};
  ranked[1].fields = {"joints.observed"};
  ranked[2].fields = {"joints.scale", "friction"};
  ranked[3].fields = {"servos.kp"};  // no rival: it does not cure
  EXPECT_EQ(put_needless_pairs_last(ranked, 3), 2U);
  EXPECT_EQ(ranked[0].fields, (std::vector<std::string>{"joints.observed"}));
  EXPECT_EQ(ranked[1].fields, (std::vector<std::string>{"joints.scale", "friction"}));
  EXPECT_EQ(ranked[2].fields, (std::vector<std::string>{"servos.kp", "joints.observed"}));
}

TEST(Diagnose, AbstainsOnAPolicyThatCannotWalkUntilItsHomeEngineIsKnown) {
  DiagnosisOptions options;
  options.workers = 2;
  options.minutes = 1e-9;
  const Diagnosis hasty = diagnose(patient(), "zero", options);
  EXPECT_TRUE(hasty.cut_short);
  EXPECT_TRUE(hasty.abstained);
  EXPECT_FALSE(hasty.ranking.empty()) << "single changes are tried all the same";
  EXPECT_NE(hasty.experiment.find("--minutes"), std::string::npos);
  options.minutes = 0;
  const Diagnosis unknown = diagnose(patient(), "zero", options);
  EXPECT_FALSE(unknown.cut_short);
  EXPECT_FALSE(unknown.cause);
  EXPECT_TRUE(unknown.abstained);
  EXPECT_NE(unknown.experiment.find("--home-engine"), std::string::npos);
  options.home_engine = patient().config.engine;
  const Diagnosis known = diagnose(patient(), "zero", options);
  ASSERT_TRUE(known.cause);
  EXPECT_EQ(*known.cause, CauseKind::kPolicy);
  EXPECT_FALSE(known.abstained);
}

TEST(Diagnose, OnlyExaminesIfAsked) {
  DiagnosisOptions options;
  options.search = false;
  const Diagnosis found = diagnosis_of("joints: {scale: 1}", options);
  EXPECT_FALSE(found.healthy);
  EXPECT_TRUE(found.ranking.empty());
  EXPECT_EQ(found.configurations, 1U);
}

TEST(Diagnose, RefusesWhatItCannotLookAt) {
  EnvConfig gait;
  EXPECT_THROW(diagnose(gait, "zero", {}), ConfigError);
  EXPECT_THROW(diagnosis_of("{}", {.workers = 1, .seed = 0, .unstated = {}, .home_engine = "nowhere"}),
               ConfigError);
  EXPECT_THROW(diagnosis_of("observation: [gravity]"), ConfigError);  // a network of 48 numbers
}

TEST(Diagnose, RefusesMinutesThatAreNone) {
  DiagnosisOptions options;
  for (const double minutes : {-1.0, std::nan(""), 1e9}) {
    options.minutes = minutes;
    EXPECT_EQ(config_error([&] { (void)diagnose(patient(), "serial_joints", options); }).element(),
              "minutes");
  }
}

TEST(Diagnose, StopsWhenItIsInterrupted) {
  DiagnosisOptions options;
  EXPECT_THROW(
      diagnose(patient("joints: {scale: 1}"), "serial_joints", options, [](double) { throw Interrupted(); }),
      Interrupted);
}

TEST(StandingTests, SeeAPoseThatDoesNotHold) {
  DiagnosisOptions options;
  options.search = false;
  const Diagnosis found = diagnosis_of("servos: {kp: 2, kd: .1}", options);
  EXPECT_FALSE(test_of(found, "hold").passed);
}

TEST(StandingTests, SeeScalesBeyondTheNormaliser) {
  DiagnosisOptions options;
  options.search = false;
  const Diagnosis found = diagnosis_of(
      "observation: [base_linear_velocity_local, base_angular_velocity_local, gravity, joint_offsets, "
      "{block: "
      "joint_velocities, scale: 20}, last_action, command]",
      options);
  EXPECT_FALSE(test_of(found, "range of observations").passed);
  EXPECT_FALSE(test_of(found, "stated layout").passed);
}

TEST(StandingTests, SeeServosThatSwing) {
  DiagnosisOptions options;
  options.search = false;
  const Diagnosis found = diagnosis_of("servos: {kd: 60}\nphysics_dt: .002", options);
  EXPECT_FALSE(test_of(found, "servo stability").passed);
}

}  // namespace
}  // namespace crossgait
