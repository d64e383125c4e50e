// What environments of one configuration share, and that sharing changes nothing.
#include "env/env_model.h"

#include "env/evaluation.h"
#include "env/vector_env.h"
#include "tests/support/engine_test.h"
#include "tests/support/environments.h"
#include "tests/support/motion_bits.h"

namespace crossgait {
namespace {

EnvConfig config() {
  EnvConfig c;
  c.terrain = "rough:size_x=4,size_y=4";
  c.observation.emplace_back("terrain");
  c.episode_seconds = 1;
  c.randomisation[Randomised::kStartYaw] = {-1, 1};
  c.randomisation[Randomised::kStartPhase] = {0, 1};
  c.randomisation[Randomised::kPushImpulse] = {0.005, 0.02};
  c.randomisation[Randomised::kPushInterval] = {0.1, 0.4};
  return c;
}

class SharedModel : public EngineTest {};
CROSSGAIT_FOR_EVERY_BACKEND(SharedModel);

TEST_P(SharedModel, IsReadOnce) {
  const auto model = EnvModel::make(config());
  const Engine engine = find_engine(GetParam());
  const QuadrupedEnv a(model, engine), b(model, engine);
  for (const QuadrupedEnv* env : {&a, &b}) {
    EXPECT_EQ(&env->model(), model.get());
    EXPECT_EQ(&env->config(), &model->config);
    EXPECT_EQ(&env->interface(), &model->interface);
    EXPECT_EQ(env->world().spec().robot, model->world.robot);
    EXPECT_EQ(env->world().spec().terrain.field(), model->world.terrain.field());
  }
  ASSERT_NE(model->world.terrain.field(), nullptr);
  const VectorEnv batch(config(), engine, {.environments = 3, .workers = 2});
  for (std::size_t i = 1; i < 3; ++i) EXPECT_EQ(&batch.environment(i).model(), &batch.environment(0).model());
}

TEST_P(SharedModel, MovesNothingBeforeTheFirstReset) {
  const QuadrupedEnv env(EnvModel::make(config()), find_engine(GetParam()));
  const auto fresh = make(env.model().world);
  EXPECT_TRUE(scenes::identical(env.world().state(), fresh->state()));
  EXPECT_EQ(env.world().contacts().count, 0);
}

TEST_P(SharedModel, GivesTheBitsOfModelsOfTheirOwn) {
  for (const bool own_worlds : {false, true}) {
    EnvConfig c = config();
    if (own_worlds) {
      c.randomisation[Randomised::kTerrainSeed] = {0, 100};
      c.randomisation[Randomised::kMass] = {0.9, 1.1};
    }
    const auto model = EnvModel::make(c);
    const Engine engine = find_engine(GetParam());
    QuadrupedEnv first(model, engine), second(model, engine), own(c, engine);
    EXPECT_NE(&own.model(), model.get());
    std::vector<std::vector<double>> runs;
    std::vector<MotionSummary> motions;
    for (QuadrupedEnv* env : {&own, &first, &second}) {
      std::vector<double> seen(env->observation_size());
      env->reset(7, seen);
      Random random(8);
      runs.push_back(scenes::record(*env, random, 400));
      runs.back().insert(runs.back().end(), seen.begin(), seen.end());
      motions.push_back(env->summary());
      // Whatever one of them draws stays its own.
      EXPECT_EQ(model->world.contact.friction, ContactSpec().friction);
    }
    EXPECT_EQ(runs[1], runs[0]);
    EXPECT_EQ(runs[2], runs[0]);
    EXPECT_EQ(differences(motions[1], motions[0]), "");
    EXPECT_EQ(differences(motions[2], motions[0]), "");
  }
}

TEST_P(SharedModel, AnEpisodeSavedInOneGoesOnInAnother) {
  const auto model = EnvModel::make(config());
  const Engine engine = find_engine(GetParam());
  QuadrupedEnv a(model, engine), b(model, engine);
  std::vector<double> seen(a.observation_size());
  a.reset(1, seen);
  Random random(2);
  scenes::record(a, random, 200);
  const auto saved = a.save();
  const Random at_save = random;
  const auto expected = scenes::record(a, random, 200);
  random = at_save;
  b.restore(*saved);
  EXPECT_EQ(scenes::record(b, random, 200), expected);
  EXPECT_EQ(differences(b.summary(), a.summary()), "");
}

TEST_P(SharedModel, AnEpisodeOnGroundOfItsOwnGoesOnInAnyOther) {
  EnvConfig c = config();
  c.terrain = "rough:size_x=4,size_y=4";
  c.randomisation[Randomised::kTerrainSeed] = {0, 1000};
  const auto model = EnvModel::make(c);
  const Engine engine = find_engine(GetParam());
  QuadrupedEnv a(model, engine), b(model, engine);
  std::vector<double> seen(a.observation_size());
  a.reset(1, seen);
  b.reset(2, seen);
  const auto of_a = a.save(), of_b = b.save();
  // Each in the other's place: of two grounds one lies at the higher address.
  Random random(3);
  const auto run_a = scenes::record(a, random, 50), run_b = scenes::record(b, random, 50);
  a.restore(*of_b);
  b.restore(*of_a);
  random = Random(3);
  EXPECT_EQ(scenes::record(b, random, 50), run_a);
  EXPECT_EQ(scenes::record(a, random, 50), run_b);
}

TEST(EnvModel, HasTheSizesOfItsTimes) {
  EnvConfig c;
  c.policy_dt = 0.02;
  c.episode_seconds = 3;
  const auto model = EnvModel::make(c);
  EXPECT_EQ(model->policy_steps, 10);
  EXPECT_EQ(model->max_steps, 150);
  EXPECT_EQ(model->layout, layout_hash(model->interface.observation, model->interface.action));
}

}  // namespace
}  // namespace crossgait
