// Provenances are compared key by key.
#include "study/provenance.h"

#include <gtest/gtest.h>

#include "physics/core/error.h"

namespace crossgait {
namespace {

Provenance walk_of_bullet() {
  Provenance p;
  p.command = "walk";
  p.arguments = {"--seed=3"};
  p.files = {{"ground.csv", "0011"}};
  EngineInfo engine;
  engine.name = "bullet";
  engine.library = "Bullet";
  engine.version = "3.24";
  p.engines = {engine};
  p.subject = {{"seed", 3}};
  return p;
}

nlohmann::json stored(const Provenance& p) { return nlohmann::json::parse(to_json(p).dump()); }

TEST(Provenances, AreTheSameAsThemselves) {
  check_same(stored(walk_of_bullet()), walk_of_bullet(), "r.json");
  const nlohmann::json result{{"provenance", stored(walk_of_bullet())}};
  EXPECT_EQ(command_of(result, "r.json"), (std::vector<std::string>{"walk", "--seed=3"}));
}

TEST(Provenances, NameWhatDiffers) {
  const nlohmann::json before = stored(walk_of_bullet());
  const auto expect_named = [&before](const Provenance& now, const std::string& place) {
    EXPECT_NE(stored(now)["hash"], before["hash"]) << place;
    try {
      check_same(before, now, "r.json");
      FAIL() << place;
    } catch (const ConfigError& error) {
      EXPECT_EQ(error.source(), "r.json");
      EXPECT_EQ(error.element(), place);
    }
  };
  Provenance p = walk_of_bullet();
  p.engines[0].version = "3.25";
  expect_named(p, "provenance.engines.0.version");
  p = walk_of_bullet();
  p.files["ground.csv"] = "0012";
  expect_named(p, "provenance.files.ground.csv");
  p = walk_of_bullet();
  p.files["other.csv"] = "0012";
  expect_named(p, "provenance.files.other.csv");
  p = walk_of_bullet();
  p.arguments.clear();
  expect_named(p, "provenance.arguments");
  p = walk_of_bullet();
  p.crossgait = "9";
  expect_named(p, "provenance.crossgait");
  p = walk_of_bullet();
  p.subject["seed"] = 4;
  expect_named(p, "provenance.seed");
}

TEST(Provenances, SayWhatWasRecordedAndWhatIsFirst) {
  const auto difference = [](const nlohmann::json& before, const Provenance& now) -> std::string {
    try {
      check_same(before, now, "r.json");
    } catch (const ConfigError& error) {
      return error.element() + ": " + error.expected() + ", " + error.found();
    }
    return "none";
  };
  const nlohmann::json before = stored(walk_of_bullet());
  Provenance now = walk_of_bullet();
  now.subject["engine_seed"] = 4;  // comes before "seed" and after nothing
  EXPECT_EQ(difference(before, now), "provenance.engine_seed: nothing, 4");
  now.arguments = {"--seed=3", "--fast"};  // another number of them: as a whole
  EXPECT_EQ(difference(before, now), R"(provenance.arguments: ["--seed=3"], ["--seed=3","--fast"])");
  now.arguments = {"--seed=4"};
  EXPECT_EQ(difference(before, now), R"(provenance.arguments.0: "--seed=3", "--seed=4")");
  now.command = "compare";
  EXPECT_EQ(difference(before, now), R"(provenance.command: "walk", "compare")");
  now.files.clear();
  EXPECT_EQ(difference(before, now), R"(provenance.files.ground.csv: "0011", null)");
  now.engines[0].name = "bullet:matched";
  EXPECT_EQ(difference(before, now), R"(provenance.engines.0.name: "bullet", "bullet:matched")");
  nlohmann::json changed = before;
  changed["crossgait"] = "0";
  EXPECT_TRUE(difference(changed, now).starts_with(R"(provenance.crossgait: "0", )"));
  changed = before;
  changed.erase("hash");  // which is that of all the rest: without it nothing says that it is whole
  EXPECT_TRUE(difference(changed, walk_of_bullet()).starts_with("provenance.hash: "));
}

TEST(Provenances, AreMissedWhereThereIsNone) {
  EXPECT_THROW((void)command_of({{"distance_m", 1}}, "r.json"), ConfigError);
  EXPECT_THROW((void)command_of(3, "r.json"), ConfigError);
}

}  // namespace
}  // namespace crossgait
