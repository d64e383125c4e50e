// A fault in one of four engines of four laws, which the verdict of many has to name: real runs of a crawl in
// which nothing hangs on the law of contact. One fault, or with CROSSGAIT_LONG_TESTS set
// (scripts/quality/nightly) twenty, and ten crawls without.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <mutex>
#include <tuple>

#include <gtest/gtest.h>

#include "parity/consensus.h"
#include "tests/parity/planted_faults.h"
#include "tests/support/engine_test.h"

namespace crossgait {
namespace {

const std::vector<std::string> kEngines{"mujoco", "bullet", "dart+pyramid", "dart+stock"};

/// As in PlantedBehaviours.ACarefulCrawlAgrees, and so rough that DART's bound of friction, which is another,
/// does not matter either.
WorldSpec crawling_ground() {
  WorldSpec spec = scenes::world_of(scenes::quadruped());
  spec.contact.friction = 3;
  spec.contact.impratio = 100;
  spec.contact.softness.time_constant = 0.003;  // s
  return spec;
}

struct GrossFault {
  const char* name;
  std::function<void(WorldSpec&)> plant;
};

template <typename Change>
std::function<void(WorldSpec&)> of_joints(Change change) {
  return of_robot([change](RobotDescription& robot) {
    for (Body& body : robot.bodies) change(body.joint);
  });
}

/// What changes how a robot crawls by more than the margins of the statistics.
const std::vector<GrossFault> kFaults{
    {"servos of half the stiffness", of_joints([](Joint& joint) { joint.kp /= 2; })},
    {"a trunk of three times the mass",
     of_robot([](RobotDescription& robot) { robot.bodies[0].inertia.mass *= 3; })},
    {"the gravity of Mars", [](WorldSpec& spec) { spec.gravity.z() = -3.73; }},
    {"ground of ice", [](WorldSpec& spec) { spec.contact.friction = 0.05; }},
    {"joints of ten times the damping", of_joints([](Joint& joint) { joint.damping *= 10; })},
};

/// The crawl, with the runs of sound engines made once.
class Crawl {
 public:
  explicit Crawl(std::uint64_t seed) {
    WalkSetup setup;
    setup.gait = "careful crawl";
    setup.timing = {.seconds = 3, .settle_seconds = 0.2};
    setup.make_controller = careful_crawl;
    const WorldSpec spec = crawling_ground();
    behaviour_ = walk_behaviour(
        spec, setup, [terrain = spec.terrain](std::size_t) { return terrain; }, {}, seed);
  }

  /// @param faulty  of the engines; none if it is beyond them
  Consensus stand(std::size_t faulty, const GrossFault& fault) {
    std::vector<Engine> engines;
    std::vector<JudgedEngine> judged;
    for (const std::string& name : kEngines) {
      engines.push_back(find_engine(name));
      const Laws& laws = engines.back().info.laws;
      judged.push_back({name, std::string(laws.contact_law()), laws.contact_family});
    }
    Behaviour behaviour = behaviour_;
    if (faulty < engines.size()) {
      const auto make = engines[faulty].make;
      engines[faulty].make = [make, &fault](const WorldSpec& sound) {
        WorldSpec spec = sound;
        fault.plant(spec);
        return make(spec);
      };
    }
    behaviour.run = [&](const Engine& engine, const Variation& variation, std::size_t start, double horizon) {
      if (faulty < kEngines.size() && engine.name() == kEngines[faulty])
        return behaviour_.run(engine, variation, start, horizon);
      return sound_run(engine, variation, start, horizon);
    };
    return crossgait::find_consensus(judged,
                                     reach_verdicts(behaviour, engines, {.starts = 6, .workers = 2}).pairs);
  }

 private:
  BehaviourRun sound_run(const Engine& engine, const Variation& variation, std::size_t start,
                         double horizon) {
    const auto key = std::make_tuple(engine.name(), std::string(variation.name), start, horizon);
    {
      const std::lock_guard lock(mutex_);
      if (const auto made = made_.find(key); made != made_.end()) return made->second;
    }
    BehaviourRun run = behaviour_.run(engine, variation, start, horizon);
    const std::lock_guard lock(mutex_);
    return made_[key] = std::move(run);
  }

  Behaviour behaviour_;
  std::mutex mutex_;
  std::map<std::tuple<std::string, std::string, std::size_t, double>, BehaviourRun> made_;
};

bool long_tests() { return std::getenv("CROSSGAIT_LONG_TESTS") != nullptr; }

/// How many of kEngines are of the same contact family as one of them.
std::size_t engines_of_family(std::size_t engine) {
  const auto family = [](const std::string& name) { return find_engine(name).info.laws.contact_family; };
  return static_cast<std::size_t>(
      std::count_if(kEngines.begin(), kEngines.end(),
                    [&](const std::string& other) { return family(other) == family(kEngines[engine]); }));
}

/// Those of kEngines that there are not.
std::vector<std::string> missing_engines() {
  const std::vector<std::string> available = available_engines();
  std::vector<std::string> missing = kEngines;
  std::erase_if(missing, [&available](const std::string& name) {
    const std::string engine = name.substr(0, name.find('+'));
    return std::find(available.begin(), available.end(), engine) != available.end();
  });
  return missing;
}

TEST(PlantedOutliers, AreNamedOfRealEngines) {
  if (!missing_engines().empty()) GTEST_SKIP() << "needs " << missing_engines().front();
  Crawl crawl(0);
  const auto expect_none = [](Crawl& sound) {
    const Consensus standing = sound.stand(kEngines.size(), kFaults.front());
    EXPECT_EQ(standing.clusters.size(), 1U) << standing.reason;
    EXPECT_TRUE(standing.outlier.empty()) << standing.reason;
  };
  expect_none(crawl);
  int faults = 0, named = 0;
  for (const GrossFault& fault : kFaults) {
    for (std::size_t engine = 0; engine < kEngines.size(); ++engine) {
      if (!long_tests() && faults == 1) break;
      const Consensus found = crawl.stand(engine, fault);
      std::printf("planted outlier %s, %s: %s\n", kEngines[engine].c_str(), fault.name, found.reason.c_str());
      ++faults;
      // Where all others are of one family nobody can say which of two opinions is odd; a vote of laws can.
      const bool alone = engines_of_family(engine) == 1;
      named += (alone ? found.outlier_by_law : found.outlier) == std::vector<std::size_t>{engine};
    }
  }
  EXPECT_EQ(named, faults);
  for (std::uint64_t seed = 1; long_tests() && seed < 10; ++seed) {
    Crawl other(seed);
    expect_none(other);
  }
}

}  // namespace
}  // namespace crossgait
