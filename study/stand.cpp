#include "study/stand.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "backends/registry.h"
#include "physics/core/error.h"
#include "physics/core/table.h"
#include "physics/engine/lost_engine.h"
#include "physics/robot/actuator.h"

namespace crossgait {
namespace {

constexpr double kAveraged = 0.25, kShortest = 0.5;  // s
constexpr double kBorneByOthers = 0.1;               // of the weight
constexpr double kLow = 0.5;                         // of the standing height

double borne_by_others(const PhysicsBackend& world) {
  double force = 0;
  for (const Contact& contact : world.contacts()) {
    if (contact.leg < 0) force += contact.force.z();
  }
  return force;
}

/// Angles at which servos are held, within what they take.
JointTargets home_targets(const RobotDescription& robot, const std::vector<int>& servos) {
  JointTargets targets;
  targets.q.resize(static_cast<Eigen::Index>(servos.size()));
  for (std::size_t i = 0; i < servos.size(); ++i) {
    const Joint& joint = robot.joint(servos[i]);
    targets.q[static_cast<Eigen::Index>(i)] =
        std::clamp(robot.home[servos[i]], joint.target_lower, joint.target_upper);
  }
  return targets;
}

StandingJoint standing_joint(const Joint& joint, double target, double reached, double torque) {
  const double limit = torque < 0 ? negative_effort(joint) : joint.effort_limit;
  return {joint.name, target, reached, torque, limit > 0 ? std::abs(torque) / limit : 0};
}

Standing stand_in(PhysicsBackend& world, const std::string& engine, double seconds) {
  const RobotDescription& robot = world.robot();
  const std::vector<int> servos = robot.actuated_joints();
  const JointTargets targets = home_targets(robot, servos);
  Standing standing;
  standing.engine = engine;
  standing.outcome = "diverged";
  world.reset();
  const double begin = world.state().p_WB.z();
  const auto steps = std::llround(seconds / world.spec().physics_dt);
  const auto averaged = std::llround(kAveraged / world.spec().physics_dt);
  JointVector reached = JointVector::Zero(robot.joint_count()), torques = reached;
  double borne = 0;
  for (std::int64_t i = 0; i < steps; ++i) {
    if (world.step(targets) != StepStatus::kOk) {
      throw_if_lost(world);
      return standing;
    }
    if (i < steps - averaged) continue;
    const double share = 1 / static_cast<double>(averaged);
    reached += share * world.state().q;
    torques += share * world.servo_torques();
    borne += share * borne_by_others(world);
    standing.height += share * world.state().p_WB.z();
  }
  for (std::size_t i = 0; i < servos.size(); ++i)
    standing.joints.push_back(standing_joint(robot.joint(servos[i]), targets.q[static_cast<Eigen::Index>(i)],
                                             reached[servos[i]], torques[servos[i]]));
  standing.sag = begin - standing.height;
  const Vector3 angles = roll_pitch_yaw(world.state().q_WB);
  standing.roll = angles.x();
  standing.pitch = angles.y();
  const double weight = -robot.total_mass() * world.spec().gravity.z();
  const bool is_down =
      borne > kBorneByOthers * weight || standing.height < begin - kLow * robot.standing_height;
  standing.outcome = is_down ? "collapsed" : "stood";
  return standing;
}

}  // namespace

std::vector<Standing> stand(const WorldSpec& world, const std::vector<std::string>& engines, double seconds) {
  if (!(seconds >= kShortest && seconds <= 1e3))
    throw ConfigError("stand", "seconds", fmt::format("{} to 1000 s", kShortest), fmt::format("{}", seconds));
  std::vector<Standing> standings;
  for (const std::string& engine : engines)
    standings.push_back(stand_in(*find_engine(engine).make(world), engine, seconds));
  return standings;
}

std::string describe(const std::vector<Standing>& standings) {
  std::string text;
  for (const Standing& s : standings) {
    text += fmt::format("{}{}: {}", text.empty() ? "" : "\n", s.engine, s.outcome);
    if (s.joints.empty()) {
      text += "\n";
      continue;
    }
    text += fmt::format(
        ", base {:.4f} m high, {:.1f} mm below where the targets have it; roll {:.2f}, pitch {:.2f} deg\n",
        s.height, 1000 * s.sag, s.roll * 180 / M_PI, s.pitch * 180 / M_PI);
    Table table({"joint", "target, rad", "reached, rad", "torque, N m", "of its limit"});
    for (const StandingJoint& joint : s.joints)
      table.add_row({joint.name, fmt::format("{:.4f}", joint.target), fmt::format("{:.4f}", joint.reached),
                     fmt::format("{:.3g}", joint.torque),
                     fmt::format("{:.0f} %", 100 * joint.share_of_effort)});
    text += table.str();
  }
  return text;
}

nlohmann::ordered_json to_json(const std::vector<Standing>& standings) {
  nlohmann::ordered_json engines;
  for (const Standing& s : standings) {
    nlohmann::ordered_json joints = nlohmann::ordered_json::array();
    for (const StandingJoint& joint : s.joints)
      joints.push_back({{"name", joint.name},
                        {"target", joint.target},
                        {"reached", joint.reached},
                        {"torque", joint.torque},
                        {"share_of_effort", joint.share_of_effort}});
    engines[s.engine] = {{"outcome", s.outcome}, {"height_m", s.height}, {"sag_m", s.sag},
                         {"roll_rad", s.roll},   {"pitch_rad", s.pitch}, {"joints", joints}};
  }
  return engines;
}

}  // namespace crossgait
