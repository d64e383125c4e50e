#include "motion/motion_statistics.h"

#include <algorithm>
#include <cmath>

#include "physics/robot/actuator.h"

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

double wrap(double angle) { return std::remainder(angle, 2 * M_PI); }

}  // namespace

bool MotionSummary::failed() const noexcept {
  return has(Outcome::kDiverged) || has(Outcome::kLoopViolated) || has(Outcome::kFell) ||
         has(Outcome::kCollapsed);
}

double servo_power(const PhysicsBackend& world, const std::vector<int>& servos) noexcept {
  double power = 0;
  for (const int i : servos) {
    const double qd = world.state().qd[i];
    const double servo = world.torques()[i] - passive_torque(world.robot().joint(i), world.state().q[i], qd);
    power += std::abs(servo * qd);
  }
  return power;
}

MotionStatistics::MotionStatistics(const RobotDescription& robot, const OutcomeLimits& limits)
    : limits_(limits),
      servos_(robot.actuated_joints()),
      loop_gaps_(std::make_shared<const LoopGaps>(robot)),
      leg_length_(robot.home_height),
      mass_(robot.total_mass()) {}

void MotionStatistics::begin(const PhysicsBackend& world, double standing_height) noexcept {
  const RobotState& s = world.state();
  t_ = {};
  t_.weight = mass_ * world.spec().gravity.norm();
  t_.standing_height = standing_height;
  t_.start = t_.piece_start = s.p_WB;
  t_.start_yaw = crossgait::roll_pitch_yaw(s.q_WB).z();
  t_.height = t_.begin_height = s.p_WB.z() - world.spec().terrain.height(s.p_WB.x(), s.p_WB.y());
}

void MotionStatistics::add_physics_step(const PhysicsBackend& world, const ControlTargets& targets) noexcept {
  const double h = world.spec().physics_dt;
  ++t_.physics_steps;
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
    t_.slip += feet[leg].slip_speed * h;
    if (scheduled.swing) continue;  // dragged, not stood upon
    t_.stance_slip += feet[leg].slip_speed * h;
    t_.stance_path += speed * h;
  }
}

void MotionStatistics::add_control_step(const PhysicsBackend& world, const ControlTargets& targets,
                                        double dt) noexcept {
  ++t_.control_steps;
  t_.time = static_cast<double>(t_.control_steps) * dt;  // not a sum, which would drift
  t_.ik_clamped += targets.ik_clamped;
  t_.limit_factor = std::min(t_.limit_factor, targets.limit_factor);
  t_.power = servo_power(world, servos_);
  t_.work += t_.power * dt;
  if (lasts(++t_.steps_since_gap, dt, kGapTime)) {
    t_.max_loop_gap = std::max(t_.max_loop_gap, loop_gaps_->largest(world.state().q));
    t_.steps_since_gap = 0;
  }
  add_attitude(world);
  add_path(world, targets, dt);
  find_outcomes(world, dt);
}

void MotionStatistics::add_attitude(const PhysicsBackend& world) noexcept {
  t_.roll_pitch_yaw = crossgait::roll_pitch_yaw(world.state().q_WB);
  t_.roll_squares += t_.roll_pitch_yaw.x() * t_.roll_pitch_yaw.x();
  t_.pitch_squares += t_.roll_pitch_yaw.y() * t_.roll_pitch_yaw.y();
  t_.roll_pitch_yaw.z() = wrap(t_.roll_pitch_yaw.z() - t_.start_yaw);
}

void MotionStatistics::add_path(const PhysicsBackend& world, const ControlTargets& targets,
                                double dt) noexcept {
  const RobotState& s = world.state();
  t_.height = s.p_WB.z() - world.spec().terrain.height(s.p_WB.x(), s.p_WB.y());
  if (lasts(++t_.steps_in_piece, dt, kPieceTime)) {
    t_.path += (s.p_WB - t_.piece_start).head<2>().norm();
    t_.piece_start = s.p_WB;
    t_.steps_in_piece = 0;
  }
  if (!targets.velocity) return;
  const VelocityCommand& asked = *targets.velocity;
  const double yaw = t_.start_yaw + t_.roll_pitch_yaw.z(), c = std::cos(yaw), sn = std::sin(yaw);
  const double speed = std::hypot(asked.vx, asked.vy);
  t_.commanded_path += speed * dt;
  t_.commanded_turn += std::abs(asked.yaw_rate) * dt;
  if (speed > 0) {
    const double forward = c * s.v_WB.x() + sn * s.v_WB.y(), left = c * s.v_WB.y() - sn * s.v_WB.x();
    t_.achieved_path += (forward * asked.vx + left * asked.vy) / speed * dt;
  }
  t_.achieved_turn += std::copysign(1.0, asked.yaw_rate) * s.w_WB.z() * dt;
  t_.commanded_yaw += asked.yaw_rate * targets.limit_factor * dt;
  t_.max_heading_error =
      std::max(t_.max_heading_error.value_or(0), std::abs(wrap(t_.roll_pitch_yaw.z() - t_.commanded_yaw)));
  if (!targets.contact_schedule) return;
  for (const ScheduledLeg& leg : *targets.contact_schedule)
    t_.planned_sweep += leg.swing ? 0 : speed * targets.limit_factor * dt;
}

void MotionStatistics::find_outcomes(const PhysicsBackend& world, double dt) noexcept {
  const double tilt = t_.roll_pitch_yaw.head<2>().cwiseAbs().maxCoeff() * kDegreesPerRadian;
  if (tilt > limits_.tilt_deg) note(Outcome::kFell);
  const bool low = t_.height < limits_.low_height * t_.standing_height ||
                   t_.body_load > limits_.nonfoot_contact_load * t_.weight;
  t_.steps_collapsed = low ? t_.steps_collapsed + 1 : 0;
  if (low && lasts(t_.steps_collapsed, dt, limits_.low_seconds)) note(Outcome::kCollapsed);
  const Vector3& p = world.state().p_WB;
  if (!world.spec().terrain.contains(p.x(), p.y())) note(Outcome::kLeftTerrain);
  if (t_.max_loop_gap > limits_.loop_gap * leg_length_) note(Outcome::kLoopViolated);
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

bool MotionStatistics::no_progress() const noexcept {
  if (t_.commanded_path > limits_.commanded_path * leg_length_)
    return t_.achieved_path < limits_.progress * t_.commanded_path;
  return t_.commanded_turn > limits_.commanded_turn &&
         t_.achieved_turn < limits_.progress * t_.commanded_turn;
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
  const Vector3 moved = s.p_WB - t_.start;
  const double c = std::cos(t_.start_yaw), sn = std::sin(t_.start_yaw);
  m.first_at_s = t_.first_at_s;
  m.distance_m = c * moved.x() + sn * moved.y();
  m.lateral_m = -sn * moved.x() + c * moved.y();
  m.path_m = t_.path + (s.p_WB - t_.piece_start).head<2>().norm();
  m.yaw_rad = wrap(crossgait::roll_pitch_yaw(s.q_WB).z() - t_.start_yaw);
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
    m.cost_of_transport = t_.work / (t_.weight * m.path_m);
  m.outcome = worst();
  if (m.outcome != Outcome::kWalked) return m;
  if (slid(m.path_m)) {
    m.outcome = Outcome::kSlid;
  } else if (no_progress()) {
    m.outcome = Outcome::kNoProgress;
  }
  return m;
}

}  // namespace crossgait
