#include "env/env_arrays.h"

#include <algorithm>
#include <array>

#include "physics/robot/multibody.h"

namespace crossgait {
namespace {

using Shape = std::vector<std::size_t>;
using Env = const QuadrupedEnv&;

constexpr std::size_t kFeet = 4;

const RobotState& state_of(Env env) { return env.world().state(); }
std::size_t joints_of(Env env) { return static_cast<std::size_t>(env.model().robot->joint_count()); }

Shape number(Env) { return {}; }
Shape vector(Env) { return {3}; }
Shape feet(Env) { return {kFeet}; }
Shape feet_vectors(Env) { return {kFeet, 3}; }
Shape joints(Env env) { return {joints_of(env)}; }
Shape actions(Env env) { return {env.action_size()}; }
Shape body_vectors(Env env) { return {env.model().robot->bodies.size(), 3}; }
Shape body_quaternions(Env env) { return {env.model().robot->bodies.size(), 4}; }

void put(const Vector3& v, double*& out) { out = std::copy_n(v.data(), 3, out); }
void put(const JointVector& v, double* out) { std::copy_n(v.data(), v.size(), out); }
void put(const Quaternion& q, double*& out) {
  const std::array<double, 4> wxyz{q.w(), q.x(), q.y(), q.z()};
  out = std::copy_n(wxyz.data(), 4, out);
}
void put_turned(Env env, const Vector3& v, double* out) {
  put(Vector3(state_of(env).q_WB.conjugate() * v), out);
}
template <typename T>
void put_feet(const LegArray<T>& all, T* out) {
  std::copy(all.begin(), all.end(), out);
}
void put_feet(const LegArray<Vector3>& all, double* out) {
  for (const Vector3& v : all) put(v, out);
}

// Of the bodies of one environment, in storage that the next call of this thread uses again.
const std::vector<Pose>& poses_of(Env env) {
  static thread_local std::vector<Pose> poses;
  forward_kinematics(env.world().robot(), state_of(env), poses);
  return poses;
}
const std::vector<BodyVelocity>& velocities_of(Env env) {
  static thread_local std::vector<BodyVelocity> velocities;
  forward_velocities(env.world().robot(), state_of(env), poses_of(env), velocities);
  return velocities;
}

void write_body_forces(Env env, double* out) {
  std::fill_n(out, 3 * env.world().robot().bodies.size(), 0.0);
  for (const Contact& c : env.world().contacts()) {
    for (int i = 0; i < 3; ++i) out[3 * c.body + i] += c.force[i];
  }
}

void write_command(Env env, double* out) {
  const VelocityCommand& command = env.command();
  out[0] = command.vx;
  out[1] = command.vy;
  out[2] = command.yaw_rate;
}

// NOLINTBEGIN(readability-function-size): a table
const std::vector<EnvArray>& table() {
  static const std::vector<EnvArray> rows{
      {"qpos", "m, -, rad",
       "position in W and unit quaternion (w, x, y, z) of the base, and all joint angles",
       [](Env env) { return Shape{qpos_size(*env.model().robot)}; },
       [](Env env, double* out) { write_qpos(state_of(env), out); }},
      {"qvel", "m/s, rad/s",
       "velocity of the base's origin and its angular velocity, both in W, and all joint velocities",
       [](Env env) { return Shape{qvel_size(*env.model().robot)}; },
       [](Env env, double* out) { write_qvel(state_of(env), out); }},
      {"base_linear_velocity_b", "m/s", "velocity of the base's origin in the base's frame", vector,
       [](Env env, double* out) { put_turned(env, state_of(env).v_WB, out); }},
      {"base_angular_velocity_b", "rad/s", "angular velocity of the base in its own frame", vector,
       [](Env env, double* out) { put_turned(env, state_of(env).w_WB, out); }},
      {"projected_gravity", "-", "direction of gravity in the base's frame; (0, 0, -1) of a level one",
       vector, [](Env env, double* out) { put_turned(env, Vector3(0, 0, -1), out); }},
      {"base_height", "m", "height of the base's origin over the ground below it", number,
       [](Env env, double* out) { *out = env.height(); }},
      {"joint_accelerations", "rad/s^2",
       "change of the joint velocities in the last policy step, over its time", joints,
       [](Env env, double* out) { put(env.joint_acceleration(), out); }},
      {"joint_torques", "N m",
       "torques in the last physics step, of servos and of passive damping and springs", joints,
       [](Env env, double* out) { put(env.world().torques(), out); }},
      {"joint_targets", "rad", "what the servos hold, in their order",
       [](Env env) { return Shape{env.model().joints.servos.size()}; },
       [](Env env, double* out) {
         const JointVector& q = env.targets().joints.q;
         std::copy_n(q.data(), q.size(), out);
       }},
      {"actions", "-", "of the last step, clipped to their bounds; zeros before the first", actions,
       [](Env env, double* out) { std::copy(env.action().begin(), env.action().end(), out); }},
      {"last_actions", "-", "of the step before", actions,
       [](Env env, double* out) { std::copy(env.last_action().begin(), env.last_action().end(), out); }},
      {"commands", "m/s, m/s, rad/s", "velocity asked for: forward, to the left, yaw rate", vector,
       write_command},
      {"time", "s", "since the episode began", number, [](Env env, double* out) { *out = env.info().time; }},
      {"foot_positions", "m", "centres of the feet FL, FR, RL, RR, in W", feet_vectors,
       [](Env env, double* out) { put_feet(env.feet().p_WF, out); }},
      {"foot_velocities", "m/s", "of the same, in W", feet_vectors,
       [](Env env, double* out) { put_feet(env.feet().v_WF, out); }},
      {"foot_forces", "N", "of the ground on the feet, in W, mean over the last physics step", feet_vectors,
       [](Env env, double* out) {
         for (const FootContact& foot : env.info().contacts) put(foot.force, out);
       }},
      {"foot_contacts", "-", "whether the ground carries them", feet, nullptr,
       [](Env env, bool* out) { put_feet(env.foot_times().touching, out); }},
      {"foot_air_time", "s", "how long each has been off the ground; zero on it", feet,
       [](Env env, double* out) { put_feet(env.foot_times().air, out); }},
      {"foot_contact_time", "s", "how long each has been on the ground; zero off it", feet,
       [](Env env, double* out) { put_feet(env.foot_times().contact, out); }},
      {"last_foot_air_time", "s", "how long its last swing took", feet,
       [](Env env, double* out) { put_feet(env.foot_times().last_air, out); }},
      {"last_foot_contact_time", "s", "how long its last stance took", feet,
       [](Env env, double* out) { put_feet(env.foot_times().last_contact, out); }},
      {"foot_landed", "-", "whether it came down in the last policy step", feet, nullptr,
       [](Env env, bool* out) { put_feet(env.foot_times().landed, out); }},
      {"body_positions", "m", "origins of all bodies in W, in the order of `Robot.bodies`", body_vectors,
       [](Env env, double* out) {
         for (const Pose& pose : poses_of(env)) put(Vector3(pose.translation()), out);
       }},
      {"body_quaternions", "-", "attitudes of all bodies in W, w, x, y, z", body_quaternions,
       [](Env env, double* out) {
         for (const Pose& pose : poses_of(env)) put(Quaternion(pose.linear()), out);
       }},
      {"body_linear_velocities", "m/s", "of the bodies' origins, in W", body_vectors,
       [](Env env, double* out) {
         for (const BodyVelocity& of : velocities_of(env)) put(of.v, out);
       }},
      {"body_angular_velocities", "rad/s", "of the bodies, in W", body_vectors,
       [](Env env, double* out) {
         for (const BodyVelocity& of : velocities_of(env)) put(of.w, out);
       }},
      {"body_contact_forces", "N",
       "of the ground on the bodies, feet included, in W, in the last physics step", body_vectors,
       write_body_forces},
  };
  return rows;
}
// NOLINTEND(readability-function-size)

constexpr std::array kParts{
    EnvArrayPart{"base_position", "m", "origin of the base in W", false, 0, 3},
    EnvArrayPart{"base_quaternion", "-", "attitude of the base in W, w, x, y, z", false, 3, 4},
    EnvArrayPart{"joint_positions", "rad", "angles of all joints, in the order of `joint_names`", false, 7,
                 0},
    EnvArrayPart{"base_linear_velocity", "m/s", "of the base's origin, in W", true, 0, 3},
    EnvArrayPart{"base_angular_velocity", "rad/s", "of the base, in W", true, 3, 3},
    EnvArrayPart{"joint_velocities", "rad/s", "of all joints, in the order of `joint_names`", true, 6, 0},
};

}  // namespace

std::span<const EnvArray> env_arrays() { return table(); }
std::span<const EnvArrayPart> env_array_parts() { return kParts; }

std::size_t qpos_size(const RobotDescription& robot) noexcept {
  return 7 + static_cast<std::size_t>(robot.joint_count());
}
std::size_t qvel_size(const RobotDescription& robot) noexcept {
  return 6 + static_cast<std::size_t>(robot.joint_count());
}

void write_qpos(const RobotState& state, double* out) noexcept {
  put(state.p_WB, out);
  put(state.q_WB, out);
  put(state.q, out);
}

void write_qvel(const RobotState& state, double* out) noexcept {
  put(state.v_WB, out);
  put(state.w_WB, out);
  put(state.qd, out);
}

void read_qpos(const double* qpos, RobotState& state) {
  state.p_WB = Eigen::Map<const Vector3>(qpos);
  state.q_WB = Quaternion(qpos[3], qpos[4], qpos[5], qpos[6]);
  state.q = Eigen::Map<const Eigen::VectorXd>(qpos + 7, state.q.size());
}

void read_qvel(const double* qvel, RobotState& state) {
  state.v_WB = Eigen::Map<const Vector3>(qvel);
  state.w_WB = Eigen::Map<const Vector3>(qvel + 3);
  state.qd = Eigen::Map<const Eigen::VectorXd>(qvel + 6, state.qd.size());
}

}  // namespace crossgait
