// Causes planted in one of two setups beside changes that do not matter: the attribution has to name them. A
// few here, and with CROSSGAIT_LONG_TESTS set (scripts/quality/nightly) all of them. The table of
// docs/verdict-evidence.md: its output, `grep planted`.
#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include "backends/registry.h"
#include "gait/scale.h"
#include "motion/gait_source.h"
#include "parity/attribution.h"
#include "parity/behaviour.h"
#include "parity/verdict_report.h"
#include "scenes/robots.h"
#include "scenes/scenes.h"
#include "study/setup.h"

namespace crossgait {
namespace {

using Names = std::vector<std::string>;

/// Large enough to change some statistic of most gaits by more than its margin.
const Names kCauses{"friction=x0.25", "mass=x1.5", "kp=x0.5",     "damping=x8",
                    "delay=0.02",     "slope=8",   "gravity=x0.6"};
/// So small that they change no statistic by more than a part of its margin. Five per cent of damping would
/// be a cause of its own.
const Names kDecoys{"friction=x1.002", "mass=x1.001",   "kp=x1.001",
                    "damping=x1.005",  "inertia=x1.01", "armature=x1.01"};

std::string name_of(const std::string& change) { return change.substr(0, change.find('=')); }

/// Two of the decoys that are no change of what the causes change.
Names beside(const Names& causes, std::size_t number) {
  Names found;
  for (std::size_t i = 0; found.size() < 2; ++i) {
    const std::string& decoy = kDecoys[(number + i) % kDecoys.size()];
    const auto same = [&](const std::string& cause) { return name_of(cause) == name_of(decoy); };
    if (std::none_of(causes.begin(), causes.end(), same)) found.push_back(decoy);
  }
  return found;
}

Attribution attribute_planted(const scenes::RobotPtr& robot, const std::string& gait, const Names& changes) {
  const WorldSpec world = scenes::world_of(robot);
  WalkSetup walk;
  walk.gait = gait;
  walk.timing.seconds = 2;
  walk.timing.settle_seconds = 0.2;
  walk.make_controller = [gait](const WorldSpec& w) {
    return make_gait_controller(choose_gait(gait, {}, {}, gait_scale(*w.robot)), w);
  };
  const Behaviour behaviour =
      walk_behaviour(world, walk, [terrain = world.terrain](std::size_t) { return terrain; });
  const WorldSetup setup = read_setup(fmt::format("{}", fmt::join(changes, ",")), world);
  const Engine engine = find_engine(available_engines().front());
  return attribute(behaviour, setup_family(engine, setup), {.starts = 4, .workers = 2});
}

/// What came of one planting.
struct Found {
  int gaps = 0;         ///< statistics whose gap is beyond its margin and not zero
  int named = 0;        ///< of them: those that name planted causes alone
  int open = 0;         ///< ...and no single cause
  int wrong = 0;        ///< ...and anything else
  std::string largest;  ///< sentence of the gap that is largest in margins
  bool leads = false;   ///< a planted cause leads in that one
  bool is_open = false;
};

Found look(const Attribution& a, const Names& causes) {
  Names planted;
  std::transform(causes.begin(), causes.end(), std::back_inserter(planted), name_of);
  Found found;
  double most = 0;
  for (std::size_t s = 0; s < a.statistics.size(); ++s) {
    const Cause cause = a.cause(s);
    if (cause.kind == Cause::Kind::kNothing) continue;
    const bool is_planted = !cause.leading.empty() &&
                            std::all_of(cause.leading.begin(), cause.leading.end(), [&](const auto& name) {
                              return std::find(planted.begin(), planted.end(), name) != planted.end();
                            });
    const bool open = cause.kind == Cause::Kind::kNoSingle;
    ++found.gaps;
    ++(open ? found.open : is_planted ? found.named : found.wrong);
    const double margins = std::abs(a.gap[s].estimate) / a.margin[s];
    if (margins <= most) continue;
    most = margins;
    found.largest = fmt::format("{}, {}", a.statistics[s].name, cause.sentence);
    found.leads = is_planted && !open;
    found.is_open = open;
  }
  return found;
}

/// Sums of what was found.
struct Tally {
  int cases = 0, led = 0, open = 0, gaps = 0, named = 0, open_gaps = 0, wrong = 0, without_gap = 0;

  void add(const Found& found) {
    if (found.gaps == 0) {
      ++without_gap;
      return;
    }
    ++cases;
    led += found.leads ? 1 : 0;
    open += found.is_open ? 1 : 0;
    gaps += found.gaps;
    named += found.named;
    open_gaps += found.open;
    wrong += found.wrong;
  }
};

Found plant(const scenes::RobotPtr& robot, const std::string& gait, const Names& causes, std::size_t number) {
  Names changes = beside(causes, number);
  changes.insert(changes.begin() + static_cast<std::ptrdiff_t>(number % 3), causes.begin(), causes.end());
  const Attribution attribution = attribute_planted(robot, gait, changes);
  Found found = look(attribution, causes);
  EXPECT_EQ(found.wrong, 0) << robot->name << ", " << gait << ", "
                            << fmt::format("{}", fmt::join(changes, ",")) << "\n"
                            << describe(attribution);
  std::printf("planted %s in %s, %s: %s\n", fmt::format("{}", fmt::join(causes, ",")).c_str(),
              robot->name.c_str(), gait.c_str(),
              found.gaps == 0 ? "no gap beyond its margin" : found.largest.c_str());
  std::fflush(stdout);
  return found;
}

bool long_tests() { return std::getenv("CROSSGAIT_LONG_TESTS") != nullptr; }

TEST(PlantedCauses, LeadTheGapsTheyMake) {
  const Names gaits{"trot", "walk", "pace", "gallop"};
  Tally single, pairs;
  std::size_t number = 0;
  for (const scenes::RobotPtr& robot :
       {scenes::quadruped(), scenes::long_quadruped(), scenes::serial_quadruped()}) {
    for (const std::string& gait : gaits) {
      for (std::size_t c = 0; c < kCauses.size(); ++c, ++number) {
        // Of the short test one in each robot, each with another gait.
        const bool chosen = number % 29 == 0;
        if (!long_tests() && !chosen) continue;
        single.add(plant(robot, gait, {kCauses[c]}, number));
        // Friction with damping, and gravity with stiffness, which pull in opposite directions.
        if (long_tests() && (c == 0 || c == 6))
          pairs.add(plant(robot, gait, {kCauses[c], kCauses[(c + 3) % kCauses.size()]}, number));
      }
    }
  }
  for (const auto& [name, tally] : {std::pair{"one cause", single}, std::pair{"two causes", pairs}}) {
    std::printf(
        "planted %s: %d cases with a gap (%d without), of whose largest gaps %d are led by what was planted "
        "and "
        "%d have no single cause; of all %d gaps %d, %d, and %d are led by something else\n",
        name, tally.cases, tally.without_gap, tally.led, tally.open, tally.gaps, tally.named, tally.open_gaps,
        tally.wrong);
    EXPECT_EQ(tally.wrong, 0);
    EXPECT_EQ(tally.led + tally.open, tally.cases);
  }
  EXPECT_GE(single.led, 0.95 * single.cases);
  EXPECT_GE(single.cases, long_tests() ? 30 : 2);
}

}  // namespace
}  // namespace crossgait
