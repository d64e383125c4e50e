// Engines by name.
#include <algorithm>
#include <set>
#include <sstream>
#include <string>

#include "physics/core/error.h"
#include "tests/physics/core/config_error.h"
#include "tests/support/engine_test.h"

namespace crossgait {
namespace {

// Everything that runs for "every world that is available" would say nothing of one whose plug-in is
// broken.
TEST(Registry, WhatWasBuiltIsAvailable) {
  std::istringstream built(CROSSGAIT_BUILT_ENGINES);
  std::string engine;
  int count = 0;
  while (std::getline(built, engine, ',')) {
    const auto& all = known_engines();
    const auto entry =
        std::find_if(all.begin(), all.end(), [&](const EngineListing& e) { return e.name == engine; });
    ASSERT_NE(entry, all.end()) << engine;
    EXPECT_TRUE(entry->available) << engine << ": " << entry->reason;
    ++count;
  }
  EXPECT_GT(count, 0) << "no engine was built: " << CROSSGAIT_BUILT_ENGINES;
}

TEST(Registry, NamesAreUniqueAndTellWhyTheyAreMissing) {
  std::set<std::string> names;
  for (const EngineListing& entry : known_engines()) {
    EXPECT_TRUE(names.insert(entry.name).second) << entry.name;
    EXPECT_EQ(entry.info.name, entry.name);
    EXPECT_EQ(entry.summary.empty(), !entry.available) << entry.name;
    EXPECT_EQ(entry.file.empty(), !entry.available) << entry.name;
    EXPECT_EQ(entry.reason.empty(), entry.available) << entry.name;
  }
  for (const char* name : {"mujoco", "bullet", "bullet:matched"}) EXPECT_TRUE(names.contains(name)) << name;
}

TEST(Registry, ListsMujocoThenTheOthersThenFurtherReleases) {
  // The first is what commands use by default; it and the first of other laws are what `verdict` compares.
  const std::vector<std::string> names = own_engines();
  ASSERT_FALSE(names.empty());
  std::vector<std::string> in_order;
  for (const char* name :
       {"mujoco", "bullet:matched", "bullet", "dart:matched", "dart", "physx:matched", "physx"}) {
    if (std::find(names.begin(), names.end(), name) != names.end()) in_order.emplace_back(name);
  }
  for (const std::string& name : names) {
    if (name.find('@') != std::string::npos) in_order.push_back(name);
  }
  EXPECT_EQ(names, in_order);
}

TEST(Registry, WhatIsAvailableCanBeMadeAndNothingElse) {
  const WorldSpec spec = scenes::world_of(scenes::sled());
  for (const EngineListing& entry : known_engines()) {
    if (entry.available) {
      EXPECT_EQ(make_world(entry.name, spec)->info().name, entry.name);
      continue;
    }
    try {
      make_world(entry.name, spec);
      ADD_FAILURE() << entry.name << " was made";
    } catch (const ConfigError& error) {
      EXPECT_EQ(error.found(), entry.reason);
    }
  }
}

TEST(Registry, AnUnknownNameListsTheKnownOnes) {
  for (const char* name : {"nonsense", "", "MuJoCo", "bullet:"}) {
    try {
      make_world(name, scenes::world_of(scenes::sled()));
      ADD_FAILURE() << name;
    } catch (const ConfigError& error) {
      for (const std::string& known : available_engines()) {
        EXPECT_NE(error.expected().find(known), std::string::npos) << error.what();
      }
      EXPECT_NE(error.found().find(name), std::string::npos);
    }
  }
}

TEST(Registry, FamiliesLeadFromOneEndToTheOther) {
  const WorldSpec spec = scenes::world_of(scenes::sled());
  // Every law that an engine has and MuJoCo 2.2.2 has not is the end of a family.
  const Laws first{.contact = "mujoco",
                   .loops = "mujoco",
                   .joint_friction = "mujoco",
                   .joint_limits = "mujoco",
                   .couplings = "mujoco",
                   .implicit_servos = "implicit",
                   .contact_family = "compliant"};
  for (const std::string& name : own_engines()) {
    const bool is_end = std::any_of(engine_families().begin(), engine_families().end(),
                                    [&name](const EngineFamily& f) { return f.to == name; });
    EXPECT_EQ(is_end, find_engine(name).info.laws != first) << name;
  }
  for (const EngineFamily& family : engine_families()) {
    EXPECT_FALSE(family.factors.empty());
    std::string name = family.from;
    for (const ModelFactor& factor : family.factors) {
      EXPECT_FALSE(factor.summary.empty());
      name += "+" + factor.name;
      EXPECT_NO_THROW(make_world(name, spec)) << name;
    }
    EXPECT_EQ(make_world(name, spec)->info().name, family.to);
    EXPECT_THROW(make_world(family.to + "+" + family.factors[0].name, spec), ConfigError);
  }
}

TEST(Registry, AnEngineHasNoFactorsButItsFamilys) {
  for (const std::string& name : available_engines()) {
    for (const char* factor : {"-nothing", "+nothing"}) {
      const ConfigError error = config_error([&] { static_cast<void>(find_engine(name + factor)); });
      EXPECT_NE(error.found().find("nothing"), std::string::npos) << name << factor << ": " << error.what();
    }
  }
}

class Info : public EngineTest {};
CROSSGAIT_FOR_EVERY_BACKEND(Info);

TEST_P(Info, IsFilledIn) {
  const auto world = make(scenes::sled());
  EXPECT_EQ(world->info().name, GetParam());
  EXPECT_FALSE(world->info().library.empty());
  EXPECT_FALSE(world->info().mode.empty());
  EXPECT_NE(world->info().version.find('.'), std::string::npos) << world->info().version;
}

}  // namespace
}  // namespace crossgait
