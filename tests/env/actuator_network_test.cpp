// Networks in the place of the servos' law.
#include <functional>

#include "env/quadruped_env.h"
#include "tests/physics/core/config_error.h"
#include "tests/physics/core/scratch_folder.h"
#include "tests/policy/actuator_networks.h"
#include "tests/support/engine_test.h"
#include "tests/support/environments.h"

namespace crossgait {
namespace {

using actuator_tests::file_of;
using actuator_tests::plain;
using actuator_tests::PlainActuator;

EnvConfig with_actuator(const std::string& file) {
  EnvConfig config = joint_environment();
  config.robot = "serial_quadruped";
  config.joints.actuator = file;
  config.control_dt = config.physics_dt;
  return config;
}

class ActuatorNetworks : public ScratchFolder, public ::testing::WithParamInterface<std::string> {};
INSTANTIATE_TEST_SUITE_P(EveryEngine, ActuatorNetworks, ::testing::ValuesIn(available_engines()),
                         [](const auto& engine) { return test_name(engine.param); });

TEST_P(ActuatorNetworks, MakeTorquesOfTargetsStepByStep) {
  for (const bool lstm : {false, true}) {
    write_safetensors(path("actuator.safetensors"), file_of(plain(lstm)));
    EnvConfig config = with_actuator(path("actuator.safetensors"));
    config.joints.scale.all = 0.2;
    config.control_dt = config.physics_dt = 1e-3;
    config.policy_dt = 4e-3;
    config.settle_seconds = 0;
    QuadrupedEnv env(config, find_engine(GetParam()));
    const auto alone = find_engine(GetParam()).make(env.world().spec());
    std::vector<double> seen(env.observation_size());
    for (int episode = 0; episode < 2; ++episode) {  // what it remembers does not outlive an episode
      env.reset(0, seen);
      alone->restore(env.world().save());
      std::vector<PlainActuator> each(12, plain(lstm));
      for (int i = 0; i < 5; ++i) {
        const double action = 0.2 * (i + 1);
        env.step(std::vector<double>(12, action), seen);
        for (int step = 0; step < 4; ++step) {
          const RobotState state = alone->state();
          JointTargets targets;
          targets.q.resize(12);
          for (std::size_t k = 0; k < 12; ++k) {
            const int servo = env.model().joints.servos[k];
            const Joint& joint = env.world().robot().joint(servo);
            const double error = env.model().joints.home[k] + 0.2 * action - state.q[servo];
            each[k].past.push_back({error, state.qd[servo]});
            targets.q[env.model().joints.slots[k]] =
                state.q[servo] + (each[k].torque() + joint.kd * state.qd[servo]) / joint.kp;
          }
          ASSERT_EQ(alone->step(targets), StepStatus::kOk);
        }
        // Torques of 20 N m in single precision, 1e-6 of them, over 20 ms at joints of some 1e-3 kg m^2 in a
        // robot that stands: velocities to 1e-3 rad/s, angles to 1e-5 rad.
        EXPECT_LT((env.world().state().q - alone->state().q).cwiseAbs().maxCoeff(), 1e-5) << lstm << i;
        EXPECT_LT((env.world().state().qd - alone->state().qd).cwiseAbs().maxCoeff(), 1e-3) << lstm << i;
      }
    }
  }
}

TEST_P(ActuatorNetworks, AreRefusedWithAReason) {
  const std::string file = path("actuator.safetensors");
  const auto complaint = [&](
                             const std::function<void(TensorFile&)>& change,
                             const std::function<void(EnvConfig&)>& otherwise = [](EnvConfig&) {}) {
    TensorFile tensors = file_of(plain(true));
    change(tensors);
    write_safetensors(file, tensors);
    EnvConfig config = with_actuator(file);
    otherwise(config);
    return std::string(config_error([&] { static_cast<void>(EnvModel::make(config)); }).what());
  };
  const auto nothing = [](TensorFile&) {};
  EXPECT_NE(complaint([](TensorFile& t) {
              t.tensors["golden.torque"].values[5] += 0.01;
            }).find("golden.torque [5]: expected what the network makes of golden.error"),
            std::string::npos);
  EXPECT_NE(complaint([](TensorFile& t) {
              t.tensors["lstm.0.weight_hh"].shape = {64, 1};
            }).find("lstm.0.weight_hh: expected shape [16, 4], found [64, 1]"),
            std::string::npos);
  EXPECT_NE(complaint([](TensorFile& t) {
              t.metadata["instants"] = "[101]";
            }).find("instants: expected a JSON list of physics steps ago, 0 to 100, found '[101]'"),
            std::string::npos);
  EXPECT_NE(complaint([](TensorFile& t) {
              t.tensors["more"] = t.tensors["layer.0.bias"];
            }).find("more: expected no further tensor"),
            std::string::npos);
  EXPECT_NE(complaint(nothing, [](EnvConfig& c) { c.physics_dt = c.control_dt = 2e-3; })
                .find("physics_dt: expected 0.001 s, the step of " + file + ", found 0.002 s"),
            std::string::npos);
  EXPECT_NE(complaint(nothing, [](EnvConfig& c) { c.control_dt = 2 * c.physics_dt; })
                .find("control_dt: expected physics_dt"),
            std::string::npos);
  EXPECT_NE(
      complaint(nothing, [](EnvConfig& c) { c.servos["kp"].all = 0; }).find("servos.kp of FL_abduction"),
      std::string::npos);
}

}  // namespace
}  // namespace crossgait
