#include "diagnosis/candidate_fields.h"

#include <set>

#include "diagnosis/search.h"
#include <gtest/gtest.h>

#include "physics/core/error.h"
#include "policy/bundled_policies.h"

namespace crossgait {
namespace {

LoadedEnv environment(const std::string& also = "{}") {
  const EnvConfig config = load_env_config(*environment_of_policy("serial_joints"));
  return override_env_config(config, also, "test");
}

std::vector<Candidate> changes(const LoadedEnv& loaded) {
  const RelabelledPolicy policy = read_relabelled_policy("zero");
  return Search(loaded, policy, {}, 1, 0).changes(nullptr);
}

// An observation with a history, so that its fields are there.
constexpr const char* kWithHistory =
    "observation: [{block: gravity, history: 3}, {block: command, history: 3}, {block: joint_offsets, "
    "history: "
    "3, clip: 5, noise: .1}, {block: last_action, history: 3}]\nservos: {kp: 40, backlash: .01}\njoints: "
    "{offset: 0, lower: -2, upper: 2, delay: .02}";

TEST(CandidateFields, AllChangeTheEnvironment) {
  for (const LoadedEnv& loaded : {environment(), environment(kWithHistory)}) {
    const RelabelledPolicy policy = read_relabelled_policy("zero");
    const Search search(loaded, policy, {}, 1, 0);
    const std::string base = to_yaml(search.base());
    std::set<std::string> same;
    for (const Candidate& candidate : search.changes(nullptr))
      if (to_yaml(candidate.config) == base) same.insert(candidate.field + " " + candidate.to);
    EXPECT_EQ(same, std::set<std::string>{});
  }
}

TEST(CandidateFields, AllRowsHaveChangesOfSomeEnvironment) {
  for (const FieldRow& row : field_rows()) {
    std::size_t count = 0;
    for (const LoadedEnv& loaded : {environment(), environment(kWithHistory)}) {
      const auto model = EnvModel::make(loaded);
      const EnvConfig stated = with_joints_resolved(*model);
      for (const CandidateField& field : row.fields({*model, stated, servo_places(*model->world.robot)}))
        count += field.changes.size();
    }
    EXPECT_GT(count, 0U) << row.name;
  }
}

// Whether some change of `field` gives `healthy` back, but for numbers of joints that were not stated.
void expect_undone(const std::string& fault, const std::string& field) {
  const LoadedEnv healthy = environment();
  const LoadedEnv patient = environment(fault);
  const std::string wanted = EnvModel::make(healthy)->layout;
  bool undone = false;
  for (const Candidate& candidate : changes(patient)) {
    if (candidate.field != field) continue;
    try {
      undone = undone || EnvModel::make(patient.with(candidate.config))->layout == wanted;
    } catch (const ConfigError&) {
    }
  }
  EXPECT_TRUE(undone) << fault;
}

TEST(CandidateFields, UndoFaultsOfTheLayout) {
  expect_undone("joints: {scale: 1}", "joints.scale");
  expect_undone(
      "joints: {order: [FR_abduction, FR_hip_pitch, FR_knee, FL_abduction, FL_hip_pitch, FL_knee, "
      "RR_abduction, RR_hip_pitch, RR_knee, RL_abduction, RL_hip_pitch, RL_knee]}",
      "joints.order");
  const std::string blocks =
      "base_angular_velocity_local, gravity, joint_offsets, joint_velocities, last_action";
  expect_undone("observation: [base_linear_velocity, " + blocks + ", command]",
                "observation.base_linear_velocity");
  expect_undone("observation: [command, base_linear_velocity_local, " + blocks + "]", "observation");
}

TEST(CandidateFields, ComeInOtherStrengths) {
  const LoadedEnv patient = environment("servos: {kp: 50}");
  for (const Candidate& candidate : changes(patient)) {
    if (candidate.field != "servos.kp" || candidate.to != "100") continue;
    const Candidate twice = Search::in_strength(candidate, 2);
    EXPECT_EQ(twice.to, "200");
    const auto model = EnvModel::make(patient.with(twice.config));
    EXPECT_DOUBLE_EQ(model->world.robot->joint(model->joints.servos.front()).kp, 200);
    return;
  }
  FAIL() << "no factor of 2";
}

TEST(CandidateFields, AreLeftOutWhereTheyWereChanged) {
  const LoadedEnv patient = environment();
  const RelabelledPolicy policy = read_relabelled_policy("zero");
  const Search search(patient, policy, {}, 1, 0);
  const std::vector<Candidate> first = search.changes(nullptr);
  ASSERT_EQ(first.front().field, "joints.order");
  for (const Candidate& pair : search.changes(&first.front())) {
    EXPECT_EQ(pair.fields.size(), 2U);
    EXPECT_TRUE(pair.field.starts_with("joints.order + ")) << pair.field;
    EXPECT_NE(pair.fields[1], "joints.order");
  }
}

TEST(JointOrders, AreThoseOfTheirConventions) {
  const LoadedEnv loaded = environment();
  const std::vector<ServoPlace> servos = servo_places(*loaded.robot);
  std::map<std::string_view, std::vector<std::string>> orders;
  for (const JointOrder& order : joint_orders()) orders[order.name] = joints_in_order(order, servos);
  EXPECT_EQ(orders["unitree-sdk"].front(), "FR_abduction");
  EXPECT_EQ(orders["unitree-sdk"][3], "FL_abduction");
  EXPECT_EQ(orders["isaac-lab"][1], "FR_abduction");
  EXPECT_EQ(orders["isaac-lab"][4], "FL_hip_pitch");
  EXPECT_EQ(orders["isaac-gym"][2], "FL_knee");
  std::vector<std::string> file;
  for (const ServoPlace& servo : servos) file.push_back(servo.joint);
  EXPECT_EQ(orders["file"], file);
}

}  // namespace
}  // namespace crossgait
