// Runs count by the contents of the files that they are made of.
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "physics/robot_files/data_path.h"
#include "tests/physics/core/scratch_folder.h"
#include "tests/study/runs.h"

namespace crossgait {
namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

class RunFiles : public ScratchFolder {
 protected:
  static std::string hash_of_robot(const std::string& file) {
    RunSpec run = walk_run();
    walk_of(run).robot = file;
    return run_hash(run);
  }
  static std::string hash_of_policy(const std::string& file) {
    RunSpec run = policy_run();
    policy_of(run).policy = file;
    return run_hash(run);
  }
  static std::string hash_of_terrain(const std::string& file) {
    RunSpec walk = walk_run(), policy = policy_run();
    walk_of(walk).terrain = policy_of(policy).environment.terrain = file;
    return run_hash(walk) + run_hash(policy);
  }
  std::string copy_robot(const std::string& folder) const {
    fs::copy(fs::path(find_robot("scara_quadruped")).parent_path(), path(folder),
             fs::copy_options::recursive);
    return path(folder + "/robot.yaml");
  }
  void replace(const std::string& file, const std::string& old, const std::string& with) const {
    std::string text = read(file);
    const std::size_t place = text.find(old);
    ASSERT_NE(place, std::string::npos) << old;
    std::ofstream(file, std::ios::binary) << text.replace(place, old.size(), with);
  }
};

TEST_F(RunFiles, ARobotIsWhatItIsWhereverItsFileLies) {
  const std::string copy = copy_robot("one"), other = copy_robot("two");
  EXPECT_EQ(hash_of_robot(copy), hash_of_robot("scara_quadruped"));
  EXPECT_EQ(hash_of_robot(other), hash_of_robot(copy));
  // A comment changes nothing; a mass does.
  std::ofstream(copy, std::ios::app) << "\n# a note\n";
  EXPECT_EQ(hash_of_robot(copy), hash_of_robot(other));
  const std::string urdf = (fs::path(copy).parent_path() / "robot.urdf").string();
  const std::string text = read(urdf);
  const std::size_t at = text.find("<mass value=\"") + std::string("<mass value=\"").size();
  std::ofstream(urdf, std::ios::binary) << text.substr(0, at) << "1" << text.substr(at);
  EXPECT_NE(hash_of_robot(copy), hash_of_robot(other));
  // So does every number of a vector.
  std::set<std::string> hashes{hash_of_robot(other)};
  const std::string original = read(path("two/robot.urdf"));
  const std::vector<std::pair<std::string, std::string>> changes = {
      {R"(<origin xyz="0 0.012 -0.005"/>)", R"(<origin xyz="0 0.013 -0.005"/>)"},  // a centre of mass
      {R"(iyy="1.53e-05")", R"(iyy="1.54e-05")"},                                  // a moment of inertia
      {R"(<origin xyz="0.065 0.03 0"/>)", R"(<origin xyz="0.065 0.03 0.0000000001"/>)"},  // a shape's place
      {R"(<sphere radius="0.01"/>)", R"(<sphere radius="0.011"/>)"}};
  for (const auto& [old, with] : changes) {
    write("two/robot.urdf", original);
    replace(path("two/robot.urdf"), old, with);
    EXPECT_TRUE(hashes.insert(hash_of_robot(other)).second) << with;
  }
}

TEST_F(RunFiles, ARobotIsAlsoWhereItsFeetStand) {
  // What gaits are told of it, and no engine.
  const std::string copy = copy_robot("one");
  std::set<std::string> hashes{hash_of_robot(copy)};
  std::ofstream(copy, std::ios::app) << "\nstance_offset: 0.001\n";
  EXPECT_TRUE(hashes.insert(hash_of_robot(copy)).second);
}

TEST_F(RunFiles, APolicyIsItsBytesWhereverTheyLie) {
  const std::string text = "{kind: scripted, layout_version: 3, steps: [{time: 0.2}]}";
  const std::string one = write("one.yaml", text), two = write("two.yaml", text);
  EXPECT_EQ(hash_of_policy(one), hash_of_policy(two));
  const std::string before = hash_of_policy(one);
  write("one.yaml", "{kind: scripted, layout_version: 3, steps: [{time: 0.3}]}");
  EXPECT_NE(hash_of_policy(one), before);
}

// A policy that does nothing until then, s.
std::string scripted_until(double seconds) {
  return fmt::format("{{kind: scripted, layout_version: 3, steps: [{{time: {}}}]}}\n", seconds);
}

TEST_F(RunFiles, MembersOfAPolicyCountAsItself) {
  fs::create_directories(path("parts"));
  write("parts/planner.yaml", scripted_until(0.2));
  write("residual.yaml", scripted_until(0.2));
  const std::string file =
      write("h.yaml",
            "kind: hierarchical\nlayout_version: 3\nplanner: {policy: parts/planner.yaml}\n"
            "residual: {policy: 'residual.yaml'}\n");
  std::string before = hash_of_policy(file);
  write("parts/planner.yaml", scripted_until(0.3));
  EXPECT_NE(hash_of_policy(file), before);
  before = hash_of_policy(file);
  write("residual.yaml", scripted_until(0.4));
  EXPECT_NE(hash_of_policy(file), before);
  fs::create_directories(path("moved"));
  before = hash_of_policy(file);
  for (const char* name : {"h.yaml", "residual.yaml", "parts"})
    fs::rename(path(name), path(std::string("moved/") + name));
  EXPECT_EQ(hash_of_policy(path("moved/h.yaml")), before);
}

TEST_F(RunFiles, WhatIsOnlyMentionedIsNoPartOfAPolicy) {
  const std::string a = write("a.yaml", scripted_until(0.2) + "# not like b.yaml\n");
  write("b.yaml", scripted_until(0.3));
  const std::string before = hash_of_policy(a);
  write("b.yaml", scripted_until(0.4));
  EXPECT_EQ(hash_of_policy(a), before);
}

TEST_F(RunFiles, StandWithTheHashThatAnybodyCanCheck) {
  // printf '0,0\n0,0.01\n' | sha256sum
  RunSpec walk = walk_run();
  walk_of(walk).terrain = write("one.csv", "0,0\n0,0.01\n");
  EXPECT_EQ(to_json(walk)["behaviour"]["terrain"]["sha256"],
            "ccd1ffbc9c409fce15ff45615b372cc9221420c58dbea8223e8d09c5e777c26d");
  RunSpec policy = policy_run();
  policy_of(policy).policy = write("p.yaml", "{kind: scripted, layout_version: 3, steps: [{time: 0.2}]}\n");
  EXPECT_EQ(to_json(policy)["behaviour"]["policy"]["sha256"],
            Json::array({"07a4637ca9b4d98b84f7a56985b3eab7eaf6f3a8fdfe43629bc3d15cd1687b80"}));
}

TEST_F(RunFiles, ATerrainIsItsBytesWhereverTheyLieWithOrWithoutSettings) {
  const std::string one = write("one.csv", "0,0\n0,0.01\n"), two = write("two.csv", "0,0\n0,0.01\n");
  for (const char* settings : {"", ":size_x=2,size_y=2"}) {
    EXPECT_EQ(hash_of_terrain(one + settings), hash_of_terrain(two + settings)) << settings;
  }
  EXPECT_NE(hash_of_terrain(one), hash_of_terrain(one + ":size_x=2,size_y=2"));
  EXPECT_NE(hash_of_terrain(one + ":size_x=2"), hash_of_terrain(one + ":size_x=3"));
  for (const char* settings : {"", ":size_x=2,size_y=2"}) {
    write("one.csv", "0,0\n0,0.01\n");
    const std::string before = hash_of_terrain(one + settings);
    write("one.csv", "0,0\n0,0.02\n");
    EXPECT_NE(hash_of_terrain(one + settings), before) << settings;
  }
}

}  // namespace
}  // namespace crossgait
