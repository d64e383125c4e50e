#include "env/start_settings.h"

#include <bit>
#include <cmath>

#include <fmt/format.h>

#include "motion/standing.h"
#include "physics/core/error.h"

namespace crossgait {
namespace {

constexpr std::string_view kStartKey = "start";
using enum Randomised;

// A draw for every servo, of a stream of its own: of nothing but the row's number.
class ServoDraws {
 public:
  ServoDraws(const Randomisation& randomisation, const RandomDraw& draw, Randomised what)
      : range_(randomisation[what]),
        on_(randomisation.is_on(what)),
        neutral_(draw[what]),
        random_(derived_seed(std::bit_cast<std::uint64_t>(draw[what]), static_cast<std::uint64_t>(what))) {}

  double next() noexcept { return on_ ? random_.uniform(range_.min, range_.max) : neutral_; }

 private:
  Range range_;
  bool on_;
  double neutral_;
  Random random_;
};

void check_servo_names(const ServoNumbers& numbers, const RobotDescription& robot, std::string_view key) {
  for (const auto& [name, value] : numbers.by_name) {
    bool known = false;
    for (const int i : robot.actuated_joints()) known = known || robot.joint(i).name == name;
    if (!known) throw ConfigError(kStartKey, key, "servos of the robot", fmt::format("'{}'", name));
  }
}

void move_servo(const Joint& joint, double angle, double& q) {
  if (!(angle >= joint.lower && angle <= joint.upper))
    throw ConfigError(kStartKey, fmt::format("joint_offsets of {}", joint.name),
                      fmt::format("an angle within its limits, [{:g}, {:g}] rad", joint.lower, joint.upper),
                      fmt::format("{:g}", angle));
  q = angle;
}

// Those of joints that no servo drives: by how far they move in a microsecond before and after.
JointVector with_passive_velocities(const RobotDescription& robot, const JointVector& q,
                                    const JointVector& qd) {
  constexpr double kShort = 1e-6;  // s; of a square of it times an acceleration of a joint nothing is left
  const JointVector before = with_legs_closed(robot, q - kShort * qd, "start.joint_velocities"),
                    after = with_legs_closed(robot, q + kShort * qd, "start.joint_velocities");
  JointVector all = (after - before) / (2 * kShort);
  for (const int i : robot.actuated_joints()) all[i] = qd[i];
  return all;
}

}  // namespace

void StartSettings::validate(std::string_view source) const {
  const auto check = [&](bool ok, const char* key, const char* expected, double found) {
    if (!ok) throw ConfigError(source, fmt::format("start.{}", key), expected, fmt::format("{:g}", found));
  };
  if (height) check(*height > 0 && *height <= 100, "height", "a height in (0, 100] m", *height);
  for (const double v : velocity) check(std::abs(v) <= 100, "velocity", "at most 100 m/s", v);
  for (const double w : angular_velocity)
    check(std::abs(w) <= 1000, "angular_velocity", "at most 1000 rad/s", w);
  const auto each = [&](const ServoNumbers& numbers, const char* key, double most, const char* expected) {
    if (numbers.all) check(std::abs(*numbers.all) <= most, key, expected, *numbers.all);
    for (const auto& [joint, number] : numbers.by_name)
      check(std::abs(number) <= most, key, expected, number);
  };
  each(joint_offsets, "joint_offsets", 2 * M_PI, "at most a turn, rad");
  each(joint_velocities, "joint_velocities", 1000, "at most 1000 rad/s");
}

RobotState start_state(const StartSettings& settings, const Randomisation& randomisation,
                       const RandomDraw& draw, const RobotDescription& robot, const Terrain& terrain,
                       const Placement& placement, RobotState standing) {
  check_servo_names(settings.joint_offsets, robot, "joint_offsets");
  check_servo_names(settings.joint_velocities, robot, "joint_velocities");
  ServoDraws offsets(randomisation, draw, kStartJointOffset), scales(randomisation, draw, kStartJointScale),
      velocities(randomisation, draw, kStartJointVelocity);
  RobotState state = std::move(standing);
  for (const int i : robot.actuated_joints()) {
    const Joint& joint = robot.joint(i);
    const double home = state.q[i];
    move_servo(joint,
               home * scales.next() + offsets.next() + settings.joint_offsets.find(joint.name).value_or(0),
               state.q[i]);
    state.qd[i] = velocities.next() + settings.joint_velocities.find(joint.name).value_or(0);
  }
  state.q = with_legs_closed(robot, state.q, "start.joint_offsets");
  robot.place_followers(state.q);
  if (!state.qd.isZero(0)) state.qd = with_passive_velocities(robot, state.q, state.qd);
  const double lowest = standing_on(terrain, placement, robot, state.q).p_WB.z();
  const Vector3& p = state.p_WB;
  const double asked = settings.height ? *settings.height + terrain.height(p.x(), p.y()) : lowest;
  constexpr double kFootClearance = 1e-3;  // m: `lowest` keeps a foot clear of the ground by less
  if (asked < lowest - kFootClearance)
    throw ConfigError(kStartKey, "height",
                      fmt::format("at least {:.4f} m, at which no foot is below the ground",
                                  lowest - terrain.height(p.x(), p.y())),
                      fmt::format("{:g}", *settings.height));
  state.p_WB.z() = asked + draw[kStartLift];
  const Eigen::AngleAxisd heading(placement.yaw, Vector3::UnitZ());
  state.v_WB = heading * (settings.velocity + Vector3(draw[kStartVx], draw[kStartVy], draw[kStartVz]));
  state.w_WB = heading * (settings.angular_velocity +
                          Vector3(draw[kStartRollRate], draw[kStartPitchRate], draw[kStartYawRate]));
  return state;
}

}  // namespace crossgait
