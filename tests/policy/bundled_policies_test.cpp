#include "policy/bundled_policies.h"

#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>

#include "policy/policy.h"
#include "policy/policy_bundle.h"
#include "tests/physics/core/config_error.h"
#include "tests/physics/core/scratch_folder.h"
#include "tests/policy/policy_interfaces.h"

namespace crossgait {
namespace {

namespace fs = std::filesystem;
using policy_tests::random_network;
using policy_tests::small_interface;

/// A folder of models with a network, a description, and two folders that hold no policy.
class BundledPolicies : public ScratchFolder {
 protected:
  void SetUp() override {
    ScratchFolder::SetUp();
    for (const char* name : {"walker", "plan", "empty", "other"})
      fs::create_directories(path(std::string("policies/") + name));
    const PolicyInterface interface = small_interface();
    write_policy_bundle(path("policies/walker/walker.safetensors"),
                        make_policy_bundle(random_network(interface, {8}), interface, "walker"));
    write("policies/plan/plan.yaml", "kind: scripted\nlayout_version: 3\nsteps: [{time: 0, action: {}}]\n");
    write("policies/other/policy.safetensors", "not by its folder's name");
    setenv("CROSSGAIT_DATA", folder_.c_str(), 1);
  }
  void TearDown() override {
    unsetenv("CROSSGAIT_DATA");
    ScratchFolder::TearDown();
  }
};

TEST_F(BundledPolicies, AreFoldersWithAFileOfTheirName) {
  EXPECT_EQ(policy_names(), (std::vector<std::string>{"plan", "walker"}));
  EXPECT_EQ(find_policy_file("walker"), path("policies/walker/walker.safetensors"));
  EXPECT_EQ(find_policy_file("plan"), path("policies/plan/plan.yaml"));
  EXPECT_EQ(environment_of_policy("plan"), path("policies/plan/environment.yaml"));
  EXPECT_EQ(environment_file("", "plan"), path("policies/plan/environment.yaml"));
  EXPECT_EQ(environment_file("mine.yaml", "plan"), "mine.yaml");
  EXPECT_EQ(environment_file("plan", "zero"), path("policies/plan/environment.yaml"));
  EXPECT_EQ(environment_file("", "zero"), "");
  for (const char* text : {"zero", "other", "empty", "walker.safetensors", "", "../policies/walker"}) {
    EXPECT_EQ(find_policy_file(text), text);
    EXPECT_EQ(environment_of_policy(text), std::nullopt) << text;
  }
}

TEST_F(BundledPolicies, OfATrainingAreItsBest) {
  fs::create_directories(path("run"));
  write("run/best.safetensors", "");
  EXPECT_EQ(find_policy_file(path("run")), path("run/best.safetensors"));
  EXPECT_EQ(environment_of_policy(path("run")), path("run/environment.yaml"));
  EXPECT_TRUE(engines_of_training(path("run")).empty());
  write("run/config.yaml", "seed: 1\nengines: {mujoco: 0.5, dart: 0, bullet: 0.5}\n");
  EXPECT_EQ(engines_of_training(path("run")), (std::vector<std::string>{"mujoco", "bullet"}));
  write("policies/walker/config.yaml", "of: another program\n");
  EXPECT_TRUE(engines_of_training("walker").empty());
  EXPECT_TRUE(engines_of_training("zero").empty());
  write("run/run.safetensors", "");  // of its own name, as an import writes it
  EXPECT_EQ(find_policy_file(path("run")), path("run/run.safetensors"));
  write("run/config.yaml", "seed: 1\n");
  const ConfigError error = config_error([&] { static_cast<void>(engines_of_training(path("run"))); });
  EXPECT_NE(std::string(error.what()).find("engines"), std::string::npos);
  const ConfigError none = config_error([&] { static_cast<void>(find_policy_file(path("policies/other"))); });
  EXPECT_NE(none.expected().find("best.safetensors"), std::string::npos);
}

TEST_F(BundledPolicies, AreMadeByName) {
  const auto by_name = make_policy("walker", small_interface());
  const auto by_file = make_policy(path("policies/walker/walker.safetensors"), small_interface());
  const std::vector<double> observation{1, -2, 0.5, 3};
  std::vector<double> ours(4), theirs(4, 9);
  by_name->act(observation, ours);
  by_file->act(observation, theirs);
  EXPECT_EQ(ours, theirs);
  const ConfigError error = config_error([] { static_cast<void>(make_policy("runner", small_interface())); });
  EXPECT_EQ(error.element(), "runner");
  EXPECT_EQ(error.expected(), "zero, random, plan, walker, FILE.safetensors or FILE.yaml");
}

}  // namespace
}  // namespace crossgait
