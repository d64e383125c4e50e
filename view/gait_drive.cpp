#include "crossgait/view/gait_drive.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "crossgait/physics/error.h"

namespace crossgait {
namespace {

// At the reference height: what the fastest gaits of docs/gaits.md reach, and a turn in four seconds.
constexpr double kForward = 0.6, kLeft = 0.25, kYawRate = 1.5;
constexpr double kPushSpeed = 1;  // m/s, change of the whole robot's speed

void require_within(double value, double most, const char* element, const char* unit) {
  if (std::abs(value) <= most) return;  // false for what is not a number, too
  throw ConfigError("drive", element, fmt::format("-{:g} to {:g} {}", most, most, unit),
                    fmt::format("{:g}", value));
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

GaitDrive::GaitDrive(std::shared_ptr<const RobotDescription> robot, const std::string& gait)
    : robot_(std::move(robot)),
      scale_(gait_scale(*robot_)),
      hold_heading_(scaled(HeadingHold(), scale_)),
      legs_(robot_),
      generator_(scaled(find_gait(gait), scale_), scaled(find_gait(gait), scale_).preferred,
                 leg_origins(legs_.kinematics()), scaled(StepLimits(), scale_)) {
  restart();
}

void GaitDrive::restart() {
  set_command({});
  generator_.reset(GaitGenerator::Start::kStanding);
  heading_.restart();
  legs_.restart();
  standing_ = target_positions(generator_.targets());
  generator_.set_sweep(legs_.foot_sweep(standing_, generator_.parameters()));
  legs_.set_load_share(generator_.parameters().load_share);
}

void GaitDrive::set_command(const VelocityCommand& command) {
  check_drive(*robot_, command);
  static_cast<void>(generator_.set_command(command));  // finite: within bounds
  command_ = command;
}

void GaitDrive::set_gait(const std::string& gait) {
  const Gait wanted = scaled(find_gait(gait), scale_);
  generator_.set_gait(wanted);
  static_cast<void>(generator_.set_parameters(wanted.preferred));  // valid: `validate(Gait)`
}

void GaitDrive::set_parameter(const std::string& name, double value) {
  const AdaptationRanges::Interval range = parameter_range(name, scale_);
  if (!(value >= range.min && value <= range.max)) {
    throw ConfigError("drive", name, fmt::format("{:g} to {:g}", range.min, range.max),
                      fmt::format("{:g}", value));
  }
  GaitParameters parameters = generator_.parameters();
  set(parameters, name, value);
  static_cast<void>(generator_.set_parameters(parameters));  // `set` has checked it
}

void GaitDrive::look(const RobotState& state, double dt) noexcept {
  generator_.set_steering(heading_.look(hold_heading_, state, command_.yaw_rate, dt));
}

void GaitDrive::advance(double dt, ControlTargets& out) noexcept {
  const LegArray<FootTarget>& feet = generator_.update(dt);
  drive_legs(legs_, generator_, feet, command_, dt, out);
}

}  // namespace crossgait
