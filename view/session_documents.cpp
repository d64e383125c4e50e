// What a session tells pages.
#include <array>
#include <cmath>

#include "gait/scale.h"
#include "physics/engine/world_quantities.h"
#include "physics/robot/multibody.h"
#include "report/scene.h"
#include "view/gait_drive.h"
#include "view/session.h"

namespace crossgait {
namespace {

using nlohmann::ordered_json;

/// Half the side of the plane that is drawn, m; the page moves it along with the robot.
constexpr double kPlaneReach = 4;

/// A quantity of the world on a slider: by a factor, or a value.
struct LiveQuantity {
  std::string_view name;
  bool is_factor;
  double min, max;
};
constexpr std::array kLiveQuantities{
    LiveQuantity{"friction", false, 0.05, 1.5}, LiveQuantity{"slope", false, -25, 25},
    LiveQuantity{"gravity", false, 1, 15},      LiveQuantity{"trunk_mass", true, 0.5, 3},
    LiveQuantity{"mass", true, 0.5, 2},         LiveQuantity{"kp", true, 0.1, 3},
    LiveQuantity{"kd", true, 0.1, 3},           LiveQuantity{"effort", true, 0.1, 2},
    LiveQuantity{"impratio", false, 1, 100},    LiveQuantity{"torsional_friction", false, 0, 0.05},
    LiveQuantity{"erp", false, 0.05, 0.8},
};

// Five digits behind the point: what a picture shows of metres and quaternions, and short as text.
double rounded(double value) noexcept { return std::round(value * 1e5) / 1e5; }

void append(ordered_json& list, const Vector3& v) {
  for (const double value : v) list.push_back(rounded(value));
}

/// Rounded numbers of servos.
ordered_json of_servos(const RobotDescription& robot, const JointVector& numbers) {
  ordered_json list = ordered_json::array();
  for (const int i : robot.actuated_joints()) list.push_back(rounded(numbers[i]));
  return list;
}

ordered_json quantities_of(const WorldSpec& world) {
  ordered_json list = ordered_json::array();
  for (const LiveQuantity& live : kLiveQuantities) {
    const WorldQuantity& quantity = find_world_quantity(live.name, "view");
    const double value = live.is_factor ? 1 : quantity.get(world).front();
    list.push_back({{"name", live.name},
                    {"unit", live.is_factor ? "times" : quantity.unit},
                    {"help", quantity.help},
                    {"factor", live.is_factor},
                    {"min", live.min},
                    {"max", live.max},
                    {"value", value}});
  }
  return list;
}

/// @param first  of all robots
ordered_json robot_frame(const RobotInstance& instance, const RobotState& first) {
  const PhysicsBackend& world = instance.world();
  const RobotState& state = world.state();
  const RobotDescription& robot = world.robot();
  std::vector<Pose> all;
  forward_kinematics(robot, state, all);
  ordered_json poses = ordered_json::array(), feet = ordered_json::array(), forces = ordered_json::array(),
               contact = ordered_json::array(), swing = ordered_json::array();
  for (const Pose& pose : all) {
    const Quaternion q(pose.linear());
    append(poses, pose.translation());
    for (const double value : {q.x(), q.y(), q.z(), q.w()}) poses.push_back(rounded(value));
  }
  const LegArray<FootContact> touched = world.foot_contacts();
  for (const Leg leg : kLegs) {
    append(feet, foot_position(robot, leg, all));
    append(forces, touched[leg].force);
    contact.push_back(touched[leg].touching);
    swing.push_back(instance.targets().contact_schedule && (*instance.targets().contact_schedule)[leg].swing);
  }
  const Vector3 angles = roll_pitch_yaw(state.q_WB);
  const Vector3 velocity = Eigen::AngleAxisd(-angles.z(), Vector3::UnitZ()) * state.v_WB;
  const Vector3& p = state.p_WB;
  return {{"engine", world.info().name},
          {"law", world.info().laws.contact},
          {"outcome", name(instance.outcome())},
          {"time", rounded(state.time)},
          {"poses", std::move(poses)},
          {"feet", std::move(feet)},
          {"forces", std::move(forces)},
          {"contact", std::move(contact)},
          {"swing", std::move(swing)},
          {"velocity", {rounded(velocity.x()), rounded(velocity.y()), rounded(state.w_WB.z())}},
          {"roll", rounded(angles.x())},
          {"pitch", rounded(angles.y())},
          {"height", rounded(p.z() - world.spec().terrain.height(p.x(), p.y()))},
          {"angles", of_servos(robot, state.q)},
          {"speeds", of_servos(robot, state.qd)},
          {"torques", of_servos(robot, world.servo_torques())},
          {"gap", rounded((p - first.p_WB).norm())},
          {"turned", rounded(state.q_WB.angularDistance(first.q_WB))}};
}

}  // namespace

ordered_json ViewSession::options() const {
  const RobotDescription& robot = *world().robot;
  const GaitScale scale = gait_scale(robot);
  const DriveLimits limits = drive_limits(robot);
  ordered_json gaits_ = ordered_json::array(), parameters = ordered_json::array(),
               terrains = ordered_json::array();
  for (const Gait& gait : gaits()) gaits_.push_back({{"name", gait.name}, {"summary", gait.summary}});
  for (const std::string_view gait : {kAutomaticGait, kGuidesAutomaticGait})
    gaits_.push_back({{"name", gait}, {"summary", "the gait for the speed"}});
  for (const ParameterRow& row : gait_parameters()) {
    const AdaptationRanges::Interval range = parameter_range(row.name, scale);
    parameters.push_back(
        {{"name", row.name}, {"unit", row.unit}, {"help", row.help}, {"min", range.min}, {"max", range.max}});
  }
  ordered_json joints = ordered_json::array();
  for (const int i : robot.actuated_joints()) joints.push_back(robot.joint(i).name);
  for (const TerrainGenerator& terrain : terrain_generators())
    terrains.push_back({{"name", terrain.name}, {"help", terrain.help}});
  return {{"subject", subject_revision_},
          {"robots", subjects_.robots},
          {"policies", subjects_.policies},
          {"robot", setup_.subject.robot},
          {"engines", provider_.names},
          {"most_engines", kMaxInstances},
          {"gaits", std::move(gaits_)},
          {"parameters", std::move(parameters)},
          {"curves", {name(SwingCurve::kBezier), name(SwingCurve::kMatched)}},
          {"terrains", std::move(terrains)},
          {"joints", std::move(joints)},
          {"quantities", quantities_of(nominal_)},
          {"limits",
           {{"forward", limits.forward},
            {"left", limits.left},
            {"yaw_rate", limits.yaw_rate},
            {"push", limits.push}}},
          {"mass", robot.total_mass()},
          {"policy", setup_.policy ? ordered_json(setup_.policy->policy) : ordered_json()}};
}

ordered_json ViewSession::scene_of(const WorldSpec& world, int revision) {
  const HeightField* field = world.terrain.field();
  const double x = field ? field->size_x() / 2 : kPlaneReach, y = field ? field->size_y() / 2 : kPlaneReach;
  PageNumbers numbers;
  ordered_json scene = scene_document(*world.robot, world.terrain, {{-x, -y}, {x, y}}, numbers);
  return {{"revision", revision}, {"scene", std::move(scene)}, {"numbers", numbers.base64()}};
}

ordered_json ViewSession::frame() const {
  const GaitGenerator* gait = instances_.front()->gait();
  ordered_json parameters, robots = ordered_json::array();
  if (gait != nullptr) {
    for (const ParameterRow& row : gait_parameters()) parameters.push_back(gait->parameters().*row.member);
  }
  for (const auto& instance : instances_)
    robots.push_back(robot_frame(*instance, instances_.front()->world().state()));
  ordered_json recorded;
  if (!recorders_.empty()) recorded = rounded(static_cast<double>(recorded_steps_) * setup_.control_dt);
  const VelocityCommand& command = instances_.front()->command();
  return {{"subject", subject_revision_},
          {"scene", scene_revision_},
          {"paused", paused_},
          {"pace", pace_},
          {"back", rounded(history_.seconds())},
          {"changes", changes_},
          {"pull", pulled_to_ ? ordered_json{rounded(pulled_to_->x()), rounded(pulled_to_->y()),
                                             rounded(pulled_to_->z())}
                              : ordered_json()},
          {"pull_force", rounded(pull_force_)},
          {"gait", gait != nullptr ? ordered_json(gait->gait().name) : ordered_json()},
          {"chosen", gait != nullptr ? ordered_json(instances_.front()->chosen_gait()) : ordered_json()},
          {"curve", gait != nullptr ? ordered_json(name(gait->parameters().swing)) : ordered_json()},
          {"phase", gait != nullptr ? ordered_json(rounded(gait->phase())) : ordered_json()},
          {"command", {{"vx", command.vx}, {"vy", command.vy}, {"yaw_rate", command.yaw_rate}}},
          {"parameters", std::move(parameters)},
          {"terrain", world().terrain.name()},
          {"seed", setup_.terrain_seed},
          {"recorded", std::move(recorded)},
          {"reports", recordings_},
          {"robots", std::move(robots)}};
}

}  // namespace crossgait
