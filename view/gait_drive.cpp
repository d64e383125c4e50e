#include "view/gait_drive.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "physics/core/error.h"

namespace crossgait {
namespace {

// At the reference height: what the fastest gaits of docs/gaits-measured.md reach, and a turn in four
// seconds.
constexpr double kForward = 0.6, kLeft = 0.25, kYawRate = 1.5;
constexpr double kPushSpeed = 1;  // m/s, change of the whole robot's speed

void require_within(double value, double most, const char* element, const char* unit) {
  if (std::abs(value) <= most) return;  // false for what is not a number, too
  throw ConfigError("drive", element, fmt::format("-{:g} to {:g} {}", most, most, unit),
                    fmt::format("{:g}", value));
}

// A generator has to have a gait; `set_gait` chooses among those by speed.
GaitGenerator first_generator(const std::string& gait, const RobotDescription& robot) {
  const GaitScale scale = gait_scale(robot);
  const Gait first = scaled(is_automatic(gait) ? default_speed_bands().front().gait : find_gait(gait), scale);
  return {first, first.preferred, leg_origins(robot), scaled(StepLimits(), scale)};
}

}  // namespace

DriveLimits drive_limits(const RobotDescription& robot) noexcept {
  const double time = gait_scale(robot).time();
  return {kForward * time, kLeft * time, kYawRate / time, kPushSpeed * time * robot.total_mass()};
}

void check_drive(const RobotDescription& robot, const VelocityCommand& command) {
  const DriveLimits most = drive_limits(robot);
  require_within(command.vx, most.forward, "vx", "m/s");
  require_within(command.vy, most.left, "vy", "m/s");
  require_within(command.yaw_rate, most.yaw_rate, "yaw_rate", "rad/s");
}

AdaptationRanges::Interval parameter_range(std::string_view name, const GaitScale& scale) {
  const ParameterRow row = scaled(AdaptationRanges(), scale).row(name);
  AdaptationRanges::Interval range{row.min, row.max};
  for (const Gait& gait : gaits()) {
    const double preferred = scaled(gait, scale).preferred.*row.member;
    range = {std::min(range.min, preferred), std::max(range.max, preferred)};
  }
  return range;
}

GaitDrive::GaitDrive(const WorldSpec& world, const std::string& gait)
    : GaitWalker(first_generator(gait, *world.robot),
                 FootTargetTracker(world.robot, {}, weight_per_mass(world)),
                 scaled(HeadingHold(), gait_scale(*world.robot))),
      robot_(world.robot),
      scale_(gait_scale(*robot_)) {
  set_gait(gait);
  restart();
}

void GaitDrive::restart() {
  set_command({});
  mutable_generator().reset(GaitGenerator::Start::kStanding);
  begin();
}

void GaitDrive::set_command(const VelocityCommand& command) {
  check_drive(*robot_, command);
  static_cast<void>(mutable_generator().set_command(command));  // finite: within bounds
  command_ = command;
  follow(command);
  if (by_speed_) walk_as(chosen_by_speed());
}

void GaitDrive::set_gait(const std::string& gait) {
  if (is_automatic(gait)) {
    const MultiGaitOptions options = multi_gait_options(choose_gait(gait, {}, command_, scale_), scale_);
    by_speed_.emplace(options, leg_origins(legs().kinematics()));
  } else {
    const Gait wanted = scaled(find_gait(gait), scale_);
    mutable_generator().set_gait(wanted);
    by_speed_.reset();
  }
  chosen_ = gait;
  settings_ = {};
  walk_as(by_speed_ ? chosen_by_speed() : generator().gait().preferred);
}

GaitParameters GaitDrive::chosen_by_speed() {
  static_cast<void>(by_speed_->set_command(command_));  // finite: within bounds
  const GaitGenerator& chosen = by_speed_->generator();
  if (chosen.gait().name != generator().gait().name) mutable_generator().set_gait(chosen.gait());
  return chosen.parameters();
}

void GaitDrive::walk_as(const GaitParameters& parameters) {
  static_cast<void>(
      mutable_generator().set_parameters(settings_.over(parameters)));  // valid: both were checked
}

void GaitDrive::set_parameter(const std::string& name, double value) {
  const AdaptationRanges::Interval range = parameter_range(name, scale_);
  if (!(value >= range.min && value <= range.max)) {
    throw ConfigError("drive", name, fmt::format("{:g} to {:g}", range.min, range.max),
                      fmt::format("{:g}", value));
  }
  set(settings_, name, value);
  walk_as(generator().parameters());
}

void GaitDrive::set_curve(const std::string& curve) {
  assign(settings_, "swing=" + curve);
  walk_as(generator().parameters());
}

}  // namespace crossgait
