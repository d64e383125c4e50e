// What is loaded needs its files no more.
#include <filesystem>

#include "physics/core/error.h"
#include "physics/robot_files/data_path.h"
#include "physics/terrain/terrain.h"
#include "policy/policy_bundle.h"
#include "study/engine_comparison.h"
#include "study/rollout.h"
#include "study/walk.h"
#include "tests/physics/core/scratch_folder.h"
#include "tests/policy/policy_interfaces.h"
#include "tests/support/engine_test.h"

namespace crossgait {
namespace {

namespace fs = std::filesystem;

using policy_tests::random_network;

class LoadedOnce : public ScratchFolder {
 protected:
  void SetUp() override {
    ScratchFolder::SetUp();
    fs::copy(fs::path(find_robot("scara_quadruped")).parent_path(), path("files"),
             fs::copy_options::recursive);
    write_csv(*make_terrain("rough:size_x=2,size_y=2", 3).field(), path("files/ground.csv"));
  }
  WalkConfig walk() const {
    WalkConfig config;
    config.robot = path("files/robot.yaml");
    config.terrain = path("files/ground.csv");
    config.timing = {.seconds = 0.1, .settle_seconds = 0.05};
    return config;
  }
  void remove_files() const { fs::remove_all(path("files")); }
};

TEST_F(LoadedOnce, AWalkGoesOnWithoutItsFiles) {
  const std::string engine = available_engines().front();
  const LoadedWalk loaded = walk();
  const Behaviour behaviour = make_behaviour({loaded, {}, 0});
  const auto distance = [&] {
    return record_walk(*find_engine(engine).make(loaded.world), loaded.config.setup()).summary.distance_m;
  };
  const double walked = distance();
  const auto run = behaviour.run(find_engine(engine), variations()[1], 2, kToTheEnd).values;
  remove_files();
  EXPECT_THROW(static_cast<void>(LoadedWalk(walk())), ConfigError);
  EXPECT_EQ(distance(), walked);
  EXPECT_EQ(behaviour.run(find_engine(engine), variations()[1], 2, kToTheEnd).values, run);
}

TEST_F(LoadedOnce, SoDoThePolicyAndItsEpisodes) {
  const std::string engine = available_engines().front();
  EnvConfig config = walk().environment();
  config.engine = engine;
  // Drawn in every episode: of a file there is one ground.
  config.randomisation[Randomised::kTerrainSeed] = {0, 9};
  const LoadedEnv environment = config;
  const LoadedBehaviour loaded(environment, "zero", {}, 0);
  const Behaviour behaviour = make_behaviour(loaded);
  const auto run = behaviour.run(find_engine(engine), variations()[2], 1, kToTheEnd).values;
  const auto rolled = [&] {
    return to_json(roll_out(environment, {"zero"}, {.episodes = 2, .workers = 1})).dump();
  };
  const EnvFactory make = env_factory(environment);
  make();  // the ground is read when it is first made
  remove_files();
  EXPECT_THROW(static_cast<void>(LoadedEnv(config)), ConfigError);
  EXPECT_EQ(behaviour.run(find_engine(engine), variations()[2], 1, kToTheEnd).values, run);
  EXPECT_NE(rolled(), "");
  EXPECT_NO_THROW(make());
  EXPECT_EQ(LoadedBehaviour(environment, "zero", {}, 0).world().robot, environment.robot);
}

TEST_F(LoadedOnce, SoDoesATrainedPolicy) {
  const std::string engine = available_engines().front();
  EnvConfig config = walk().environment();
  config.engine = engine;
  const PolicyInterface interface = EnvModel::make(config)->interface;
  const std::string policy = path("files/p.safetensors");
  write_policy_bundle(policy, random_network(interface, {8}), interface);
  const LoadedBehaviour loaded(config, policy, {}, 0);
  const Behaviour behaviour = make_behaviour(loaded);
  const auto reward = [&](const NamedPolicy& who) {
    return roll_out(config, std::span(&who, 1), {.episodes = 2, .workers = 2})
        .policies[0]
        .all.total_reward.mean;
  };
  const auto run = [&] { return behaviour.run(find_engine(engine), variations()[1], 1, kToTheEnd).values; };
  const NamedPolicy read = find_policy(policy);
  const double earned = reward(read);
  const auto before = run();
  const std::string described = loaded.described.dump();
  // Another network under the same name is another policy, but not that of who has read the first.
  MlpNetwork other = random_network(interface, {8});
  other.layers.back().bias.array() += 0.5;
  write_policy_bundle(policy, other, interface);
  EXPECT_EQ(reward(read), earned);
  EXPECT_EQ(run(), before);
  EXPECT_NE(reward(find_policy(policy)), earned);
  EXPECT_NE(LoadedBehaviour(config, policy, {}, 0).described.dump(), described);
}

TEST_F(LoadedOnce, OtherSettingsReadOnlyWhatTheyNameAnew) {
  const LoadedEnv environment = walk().environment();
  EnvConfig changed = environment.config;
  changed.contact.add(friction_of(0.1));
  EXPECT_EQ(environment.with(changed).robot, environment.robot);
  EXPECT_EQ(environment.with(changed).config.contact.find("friction")->front(), 0.1);
  changed.robot = "scara_quadruped";
  changed.terrain = "flat";
  const LoadedEnv other = environment.with(changed);
  EXPECT_NE(other.robot, environment.robot);
  EXPECT_EQ(other.ground.text(), "flat");
}

}  // namespace
}  // namespace crossgait
