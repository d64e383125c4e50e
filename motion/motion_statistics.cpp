#include "motion/motion_statistics.h"

#include <algorithm>
#include <cmath>

#include "physics/robot/hips.h"

namespace crossgait {
namespace {

constexpr double kPieceTime = 0.5;  // s, of the straight pieces that make the path
// s, between two looks at the loops: each costs three times all else here together, and a loop that opens
// stays open.
constexpr double kGapTime = 0.01;
constexpr double kMoved = 0.1;                  // leg lengths, below which a cost per distance means nothing
constexpr double kSwingContactLoad = 1.0 / 50;  // of the weight
constexpr double kSwingEdge = 0.1;              // of a swing, at either end: not its inner part

// Whether so many steps of `dt` make `seconds`, whatever the rounding of times written as decimals.
bool lasts(std::int64_t steps, double dt, double seconds) {
  return static_cast<double>(steps) * dt > seconds * (1 - 1e-9);
}

}  // namespace

bool MotionSummary::failed() const noexcept {
  return std::any_of(outcome_rows().begin(), outcome_rows().end(),
                     [this](const OutcomeRow& row) { return is_failure(row.outcome) && has(row.outcome); });
}

MotionStatistics::MotionStatistics(const RobotDescription& robot, const OutcomeLimits& limits)
    : limits_(limits),
      servos_(robot.actuated_joints()),
      qd_(JointVector::Zero(robot.joint_count())),
      loop_gaps_(std::make_shared<const LoopGaps>(robot)),
      hip_middle_(hip_middle(robot)),
      leg_length_(crossgait::leg_length(robot)),
      mass_(robot.total_mass()) {}

void MotionStatistics::begin(const PhysicsBackend& world, double standing_height) noexcept {
  const RobotState& s = world.state();
  t_ = {};
  qd_ = s.qd;
  t_.weight = mass_ * world.spec().gravity.norm();
  t_.standing_hip_height = standing_height + hip_middle_.z();
  t_.start = t_.piece_start = t_.last_position = s.p_WB;
  t_.start_yaw = yaw_of(s.q_WB);
  t_.start_heading = t_.course = Heading(s.q_WB);
  see_attitude(s);
  t_.height = t_.begin_height = s.p_WB.z() - world.spec().terrain.height(s.p_WB.x(), s.p_WB.y());
}

void MotionStatistics::add_physics_step(const PhysicsBackend& world, const ControlTargets& targets) noexcept {
  const double h = world.spec().physics_dt;
  ++t_.physics_steps;
  add_torques(world, h);
  double other = 0;
  for (const Contact& c : world.contacts()) {
    t_.max_penetration = std::max(t_.max_penetration, -c.distance);
    if (c.leg < 0) other += c.force.dot(c.normal);
  }
  t_.body_load += h / (limits_.load_smoothing + h) * (other - t_.body_load);
  const LegArray<FootContact> feet = world.foot_contacts();
  const double speed = world.state().v_WB.norm();
  for (const Leg leg : kLegs) {
    const ScheduledLeg scheduled =
        targets.contact_schedule ? (*targets.contact_schedule)[leg] : ScheduledLeg{};
    if (scheduled.swing) {
      const int loaded = feet[leg].force.norm() > kSwingContactLoad * t_.weight ? 1 : 0;
      const bool inner = scheduled.progress >= kSwingEdge && scheduled.progress <= 1 - kSwingEdge;
      ++t_.swings[leg].steps;
      t_.swings[leg].loaded += loaded;
      t_.inner_swings[leg].steps += inner ? 1 : 0;
      t_.inner_swings[leg].loaded += inner ? loaded : 0;
    }
    if (!feet[leg].touching) continue;
    ++t_.contact_steps[leg];
    t_.integrals.slip_squares += feet[leg].slip_speed * feet[leg].slip_speed * h;
    t_.slip += feet[leg].slip_speed * h;
    if (scheduled.swing) continue;  // dragged, not stood upon
    t_.stance_slip += feet[leg].slip_speed * h;
    t_.stance_path += speed * h;
  }
}

void MotionStatistics::add_torques(const PhysicsBackend& world, double h) noexcept {
  // As they were in this step: torques are of the state before it.
  const JointVector &torques = world.torques(), &servo = world.servo_torques(), &qd = world.state().qd;
  double power = 0, squares = 0;
  for (const int i : servos_) {
    power += std::abs(servo[i] * (qd_[i] + qd[i]) / 2);
    squares += torques[i] * torques[i];
  }
  t_.integrals.seconds += h;
  t_.integrals.work += power * h;
  t_.integrals.torque_squares += squares * h;
  qd_ = qd;
}

void MotionStatistics::add_control_step(const PhysicsBackend& world, const ControlTargets& targets,
                                        double dt) noexcept {
  ++t_.control_steps;
  t_.time = static_cast<double>(t_.control_steps) * dt;  // not a sum, which would drift
  t_.ik_clamped += targets.ik_clamped;
  t_.limit_factor = std::min(t_.limit_factor, targets.limit_factor);
  if (lasts(++t_.steps_since_gap, dt, kGapTime)) {
    t_.max_loop_gap = std::max(t_.max_loop_gap, loop_gaps_->largest(world.state().q));
    t_.steps_since_gap = 0;
  }
  const double last_yaw = t_.roll_pitch_yaw.z();
  add_attitude(world);
  add_path(world, dt);
  add_command(world, targets, last_yaw, dt);
  find_outcomes(world, dt);
}

void MotionStatistics::add_attitude(const PhysicsBackend& world) noexcept {
  see_attitude(world.state());
  t_.roll_squares += t_.roll_pitch_yaw.x() * t_.roll_pitch_yaw.x();
  t_.pitch_squares += t_.roll_pitch_yaw.y() * t_.roll_pitch_yaw.y();
}

void MotionStatistics::see_attitude(const RobotState& state) noexcept {
  t_.roll_pitch_yaw = crossgait::roll_pitch_yaw(state.q_WB);
  t_.roll_pitch_yaw.z() = wrapped(t_.roll_pitch_yaw.z() - t_.start_yaw);
}

void MotionStatistics::add_path(const PhysicsBackend& world, double dt) noexcept {
  const RobotState& s = world.state();
  t_.height = s.p_WB.z() - world.spec().terrain.height(s.p_WB.x(), s.p_WB.y());
  if (lasts(++t_.steps_in_piece, dt, kPieceTime)) {
    t_.path += (s.p_WB - t_.piece_start).head<2>().norm();
    t_.piece_start = s.p_WB;
    t_.steps_in_piece = 0;
  }
}

void MotionStatistics::add_command(const PhysicsBackend& world, const ControlTargets& targets,
                                   double last_yaw, double dt) noexcept {
  const Vector3 moved = world.state().p_WB - t_.last_position;
  t_.last_position = world.state().p_WB;
  if (!targets.velocity) return;
  const VelocityCommand& asked = *targets.velocity;
  // A turn may fall short of what was asked for: then the robot goes where it faces. Without one it is to
  // keep the heading that it has.
  if (asked.yaw_rate != 0) t_.course = Heading(world.state().q_WB);
  const double speed = std::hypot(asked.vx, asked.vy);
  t_.commanded_path += speed * dt;
  t_.commanded_turn += std::abs(asked.yaw_rate) * dt;
  if (speed > 0) {
    const Vector3 way = t_.course.components(moved);  // forward, left
    t_.achieved_path += (way.x() * asked.vx + way.y() * asked.vy) / speed;
    t_.strayed_path += (way.y() * asked.vx - way.x() * asked.vy) / speed;
  }
  if (asked.yaw_rate != 0)
    t_.achieved_turn += std::copysign(1.0, asked.yaw_rate) * wrapped(t_.roll_pitch_yaw.z() - last_yaw);
  t_.commanded_yaw += asked.yaw_rate * targets.limit_factor * dt;
  t_.max_heading_error =
      std::max(t_.max_heading_error.value_or(0), std::abs(wrapped(t_.roll_pitch_yaw.z() - t_.commanded_yaw)));
  if (!targets.contact_schedule) return;
  for (const ScheduledLeg& leg : *targets.contact_schedule)
    t_.planned_sweep += leg.swing ? 0 : speed * targets.limit_factor * dt;
}

void MotionStatistics::find_outcomes(const PhysicsBackend& world, double dt) noexcept {
  const double tilt = t_.roll_pitch_yaw.head<2>().cwiseAbs().maxCoeff() * kDegreesPerRadian;
  if (tilt > limits_.tilt_deg) note(Outcome::kFell);
  const bool low = hip_height(world) < limits_.low_height * t_.standing_hip_height ||
                   t_.body_load > limits_.nonfoot_contact_load * t_.weight;
  t_.steps_collapsed = low ? t_.steps_collapsed + 1 : 0;
  if (low && lasts(t_.steps_collapsed, dt, limits_.low_seconds)) note(Outcome::kCollapsed);
  const Vector3& p = world.state().p_WB;
  if (!world.spec().terrain.contains(p.x(), p.y())) note(Outcome::kLeftTerrain);
  if (t_.max_loop_gap > limits_.loop_gap * leg_length_) note(Outcome::kLoopViolated);
}

double MotionStatistics::hip_height(const PhysicsBackend& world) const noexcept {
  const Vector3 middle = world.state().X_WB() * hip_middle_;
  return middle.z() - world.spec().terrain.height(middle.x(), middle.y());
}

void MotionStatistics::moved(const PhysicsBackend& world) noexcept {
  const RobotState& s = world.state();
  qd_ = s.qd;
  const double turned = yaw_of(s.q_WB) - (t_.start_yaw + t_.roll_pitch_yaw.z());
  t_.start_yaw += turned;
  t_.start_heading = Heading(t_.start_yaw);
  t_.course = t_.course.turned(turned);
  see_attitude(s);
  // What was behind it stays behind it.
  const Eigen::AngleAxisd turn(turned, Vector3::UnitZ());
  t_.start = s.p_WB - turn * (t_.last_position - t_.start);
  t_.piece_start = s.p_WB - turn * (t_.last_position - t_.piece_start);
  t_.last_position = s.p_WB;
  t_.height = s.p_WB.z() - world.spec().terrain.height(s.p_WB.x(), s.p_WB.y());
  if (t_.control_steps == 0) t_.begin_height = t_.height;
}

void MotionStatistics::note(Outcome outcome) noexcept {
  std::optional<double>& first = t_.first_at_s[static_cast<std::size_t>(outcome)];
  if (!first) first = t_.time;
}

Outcome MotionStatistics::worst() const noexcept {
  for (const OutcomeRow& row : outcome_rows()) {
    if (has(row.outcome)) return row.outcome;
  }
  return Outcome::kWalked;
}

bool MotionStatistics::any(const OutcomeSet& terminations) const noexcept {
  for (const OutcomeRow& row : outcome_rows()) {
    if (terminations.has(row.outcome) && has(row.outcome)) return true;
  }
  return false;
}

bool MotionStatistics::slid(double path) const noexcept {
  return path > limits_.slip_path * leg_length_ && t_.stance_slip > limits_.slip * t_.stance_path;
}

Outcome MotionStatistics::of_path() const noexcept {
  if (t_.commanded_path <= limits_.commanded_path * leg_length_) return Outcome::kWalked;
  const double way = std::hypot(t_.achieved_path, t_.strayed_path);
  const double slow = limits_.no_progress_speed * std::sqrt(t_.weight / mass_ * leg_length_);
  if (way < limits_.no_progress * t_.commanded_path && way < slow * t_.time) return Outcome::kNoProgress;
  const double off = std::atan2(std::abs(t_.strayed_path), t_.achieved_path) * kDegreesPerRadian;
  if (off > 180 - limits_.strayed_deg) return Outcome::kBackward;
  if (off > limits_.strayed_deg) return Outcome::kStrayed;
  return t_.achieved_path < limits_.too_slow * t_.commanded_path ? Outcome::kTooSlow : Outcome::kWalked;
}

Outcome MotionStatistics::of_turn() const noexcept {
  if (t_.commanded_turn <= limits_.commanded_turn) return Outcome::kWalked;
  const bool alone = t_.commanded_path <= limits_.commanded_path * leg_length_;
  const double share = t_.achieved_turn / t_.commanded_turn;
  if (alone && std::abs(share) < limits_.no_progress) return Outcome::kNoProgress;
  if (alone && share < 0) return Outcome::kBackward;
  return share < limits_.too_slow ? Outcome::kTooSlow : Outcome::kWalked;
}

std::optional<double> MotionStatistics::loaded_fraction(const LegArray<Swing>& legs) noexcept {
  double sum = 0;
  int planned = 0;
  for (const Swing& leg : legs) {
    if (leg.steps == 0) continue;
    ++planned;
    sum += static_cast<double>(leg.loaded) / static_cast<double>(leg.steps);
  }
  return planned > 0 ? std::optional(sum / planned) : std::nullopt;
}

MotionSummary MotionStatistics::summary(const PhysicsBackend& world) const {
  MotionSummary m;
  const RobotState& s = world.state();
  m.first_at_s = t_.first_at_s;
  const Vector3 way = t_.start_heading.components(s.p_WB - t_.start);
  m.distance_m = way.x();
  m.lateral_m = way.y();
  m.path_m = t_.path + (s.p_WB - t_.piece_start).head<2>().norm();
  m.yaw_rad = wrapped(yaw_of(s.q_WB) - t_.start_yaw);
  m.final_position_m = s.p_WB;
  m.simulated_seconds = t_.time;
  m.physics_steps = t_.physics_steps;
  m.ik_clamped = t_.ik_clamped;
  m.limit_factor = t_.limit_factor;
  m.max_penetration_m = t_.max_penetration;
  m.max_loop_gap_m = t_.max_loop_gap;
  m.slip_m = t_.slip;
  if (t_.control_steps > 0) {
    const auto n = static_cast<double>(t_.control_steps);
    m.mean_speed_mps = m.distance_m / m.simulated_seconds;
    m.rms_roll_deg = std::sqrt(t_.roll_squares / n) * kDegreesPerRadian;
    m.rms_pitch_deg = std::sqrt(t_.pitch_squares / n) * kDegreesPerRadian;
  }
  for (const Leg leg : kLegs) {
    if (t_.physics_steps > 0)
      m.duty_factor[leg] = static_cast<double>(t_.contact_steps[leg]) / static_cast<double>(t_.physics_steps);
  }
  m.swing_contact_ratio = loaded_fraction(t_.swings);
  m.swing_contact_ratio_inner = loaded_fraction(t_.inner_swings);
  if (t_.planned_sweep > 0) m.slip_per_path = t_.slip / t_.planned_sweep;
  if (t_.max_heading_error) m.heading_error_deg = *t_.max_heading_error * kDegreesPerRadian;
  if (m.path_m > kMoved * leg_length_ && t_.weight > 0)
    m.cost_of_transport = t_.integrals.work / (t_.weight * m.path_m);
  m.outcome = worst();
  if (m.outcome != Outcome::kWalked) return m;
  m.outcome = slid(m.path_m) ? Outcome::kSlid : std::min(of_path(), of_turn());
  return m;
}

}  // namespace crossgait
