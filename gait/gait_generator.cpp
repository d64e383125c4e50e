#include "gait/gait_generator.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace crossgait {
namespace {

/// Velocities are clamped to this before use, m/s and rad/s: no product of them overflows.
constexpr double kFastest = 100;
/// Fastest foot asked for below which the robot stands, and from which it walks again, m/s.
constexpr double kStandBelow = 0.005, kWalkFrom = 0.01;
/// Changes of stride are at least this fast even for a gait that does not lift its feet, m/s.
constexpr double kSlowestShift = 0.02;

double to_nearest_turn(double phase) { return phase - std::round(phase); }

/// Moves `value` towards `goal` by at most `most`. @returns whether it has arrived
bool move_towards(double& value, double goal, double most) {
  const double way = goal - value;
  if (std::abs(way) <= most) {
    value = goal;
    return true;
  }
  value += std::copysign(most, way);
  return false;
}

/// Centre of the shortest arc of the circle [0, 1) that holds all of `phases`.
double centre_of_arc(LegArray<double> phases) {
  std::sort(phases.begin(), phases.end());
  double gap = phases.front() + 1 - phases.back();  // the widest, and where it ends
  double end = phases.front();
  for (std::size_t i = 1; i < phases.size(); ++i) {
    if (phases[i] - phases[i - 1] > gap) {
      gap = phases[i] - phases[i - 1];
      end = phases[i];
    }
  }
  return end + (1 - gap) / 2;
}

GaitGenerator::Stride interpolate(const GaitGenerator::Stride& from, const GaitGenerator::Stride& to,
                                  double share) {
  GaitGenerator::Stride stride = from;
  for (const ParameterRow& row : gait_parameters()) {
    double& value = stride.parameters.*row.member;
    value += share * (to.parameters.*row.member - value);
  }
  for (const Leg leg : kLegs) stride.step[leg] += share * (to.step[leg] - stride.step[leg]);
  stride.lift_scale += share * (to.lift_scale - stride.lift_scale);
  return stride;
}

bool steps_are_zero(const LegArray<Vector2>& step) {
  return std::all_of(step.begin(), step.end(), [](const Vector2& s) { return s.isZero(0); });
}

}  // namespace

GaitGenerator::GaitGenerator(const Gait& gait, const GaitParameters& parameters,
                             const LegArray<Vector3>& p_BL, const StepLimits& limits)
    : gait_(gait), wanted_(parameters), p_BL_(p_BL), limits_(limits) {
  validate(gait);
  validate(parameters, "gait parameters");
  validate(limits, "step limits");
  reset();
}

void GaitGenerator::reset(Start start) noexcept {
  clock_.set(0);
  adopt_gait();
  stepping_ = true;
  curve_.fill(wanted_.swing);
  effective_ = wanted_stride();
  if (start == Start::kStanding) {
    effective_.step = no_steps();
    effective_.lift_scale = 0;
  }
  settled_ = false;
  place_feet();
}

bool GaitGenerator::set_parameters(const GaitParameters& parameters) noexcept {
  if (!is_valid(parameters)) return false;
  wanted_ = parameters;
  settled_ = false;
  return true;
}

void GaitGenerator::set_gait(const Gait& gait) noexcept {
  LegArray<double> way;
  for (const Leg leg : kLegs) {
    way[leg] = gait.offset[leg] - offset_[leg];
    way[leg] -= std::floor(way[leg]);
  }
  // Turning the clock and all offsets alike moves no leg.
  const double turn = centre_of_arc(way);
  clock_.set(clock_.phase() + turn);
  for (double& offset : offset_) {
    offset += turn;
    offset -= std::floor(offset);
  }
  gait_ = gait;
  wanted_.duty_factor = gait.preferred.duty_factor;
  in_step_ = false;
  settled_ = false;
}

bool GaitGenerator::set_command(const VelocityCommand& command) noexcept {
  if (!command.is_finite()) return false;
  const auto bound = [](double v) { return std::clamp(v, -kFastest, kFastest); };
  command_ = {bound(command.vx), bound(command.vy), bound(command.yaw_rate)};
  settled_ = false;
  return true;
}

void GaitGenerator::clear_command() noexcept {
  command_.reset();
  settled_ = false;
}

void GaitGenerator::set_steering(double yaw_rate) noexcept {
  const double bounded = std::isfinite(yaw_rate) ? std::clamp(yaw_rate, -kFastest, kFastest) : 0;
  if (bounded == steering_) return;
  steering_ = bounded;
  settled_ = false;
}

bool GaitGenerator::is_standing() const noexcept {
  return effective_.lift_scale == 0 && steps_are_zero(effective_.step);
}

const LegArray<FootTarget>& GaitGenerator::update(double dt) noexcept {
  if (!(dt > 0 && std::isfinite(dt))) return targets_;
  if (!settled_) {
    const Stride wanted = wanted_stride();
    if (is_standing()) {
      begin_cycle(wanted.parameters);
    }
    approach(wanted, dt);
  }
  if (!is_standing()) {
    const double cycles = dt / effective_.parameters.cycle_time;
    if (!in_step_) turn_to_gait(cycles);
    clock_.advance(dt, effective_.parameters.cycle_time);
  }
  place_feet();
  return targets_;
}

GaitGenerator::Stride GaitGenerator::wanted_stride() noexcept {
  Stride stride;
  stride.parameters = wanted_;
  limit_factor_ = 1;
  stepping_ = true;
  LegArray<Vector2> feet;
  for (const Leg leg : kLegs) {
    feet[leg] = {p_BL_[leg].x() + wanted_.stance_offset,
                 p_BL_[leg].y() + side_sign(leg) * outward_shift(wanted_, leg)};
  }
  const double stance_time = wanted_.duty_factor * wanted_.cycle_time;
  const LegArray<Vector2> turn = foot_velocities({0, 0, steering_}, feet);
  if (command_) {
    LegArray<Vector2> velocity = foot_velocities(*command_, feet);
    double fastest = 0;
    for (const Vector2& v : velocity) fastest = std::max(fastest, v.norm());
    const bool walks = !steps_are_zero(effective_.step);
    stepping_ = fastest >= (walks ? kStandBelow : kWalkFrom);
    if (stepping_) {
      for (const Leg leg : kLegs) velocity[leg] += turn[leg];
      const StepPlan plan = plan_steps(velocity, stance_time, limits_);
      stride.step = plan.step;
      limit_factor_ = plan.limit_factor;
    }
  } else {
    for (const Leg leg : kLegs) stride.step[leg] = Vector2(wanted_.step_length, 0) + stance_time * turn[leg];
  }
  // Coming to a stand, the feet first step to their places and are set down last.
  if (!stepping_) stride.lift_scale = steps_are_zero(effective_.step) ? 0 : 1;
  return stride;
}

/// Speed that changes of stride may add to a foot, m/s. Both swing curves somewhere rise by 3 swing_lift per
/// swing, so that, for the least lift and longest swing in play, is a lower bound of the top foot speed.
double GaitGenerator::shift_speed(const Stride& wanted) const noexcept {
  const GaitParameters &a = effective_.parameters, &b = wanted.parameters;
  const double duty = std::min(a.duty_factor, b.duty_factor);
  const double top =
      3 * std::min(swing_lift(a), swing_lift(b)) / ((1 - duty) * std::max(a.cycle_time, b.cycle_time));
  return std::max(kSlowestShift, (in_step_ ? kShiftShare : kShiftShareInTurn) * top);
}

double GaitGenerator::largest_shift(const Stride& candidate) const noexcept {
  double largest = 0;
  for (const Leg leg : kLegs) {
    largest = std::max(
        largest,
        (position_of(leg, candidate, phase_of(leg, candidate)) - targets_[leg].position).squaredNorm());
  }
  return std::sqrt(largest);
}

/// Moves `effective_` towards `wanted` as far as no foot, at its present phase, moves more than it may.
void GaitGenerator::approach(const Stride& wanted, double dt) noexcept {
  const double most = shift_speed(wanted) * dt;
  // Feet move almost linearly with the stride, so the first estimate of the share is good and the second
  // better; a share that is still too large waits for the next update.
  constexpr int kTries = 4;
  double share = 1;
  Stride candidate = wanted;
  for (int i = 0; i < kTries; ++i) {
    const double shift = largest_shift(candidate);
    if (shift <= most) {
      effective_ = candidate;
      break;
    }
    constexpr double kRounding = 1 - 1e-9;
    share *= kRounding * most / shift;
    candidate = interpolate(effective_, wanted, share);
  }
  // The lift follows the steps: it may want more next time.
  settled_ = share == 1 && in_step_ && stepping_ == (effective_.lift_scale > 0);
}

/// Moves offsets towards those of the gait by their share of `cycles`.
void GaitGenerator::turn_to_gait(double cycles) noexcept {
  bool arrived = true;
  for (const Leg leg : kLegs) {
    const double goal = offset_[leg] + to_nearest_turn(gait_.offset[leg] - offset_[leg]);
    arrived &= move_towards(offset_[leg], goal, kPhaseShare * cycles);
  }
  if (arrived) adopt_gait();
}

void GaitGenerator::adopt_gait() noexcept {
  offset_ = gait_.offset;
  in_step_ = true;
}

/// From the stand, where no foot is anywhere in its cycle: all that is wanted is in effect at once, but for
/// what standing feet, and their servos, feel.
void GaitGenerator::begin_cycle(const GaitParameters& wanted) noexcept {
  adopt_gait();
  clock_.set(0);
  const GaitParameters before = effective_.parameters;
  effective_.parameters = wanted;
  for (const auto felt :
       {&GaitParameters::body_height, &GaitParameters::stance_width, &GaitParameters::lateral_offset_fl,
        &GaitParameters::lateral_offset_fr, &GaitParameters::lateral_offset_rl,
        &GaitParameters::lateral_offset_rr, &GaitParameters::load_share, &GaitParameters::stance_offset}) {
    effective_.parameters.*felt = before.*felt;
  }
  place_feet();
}

LegPhase GaitGenerator::phase_of(Leg leg, const Stride& stride) const noexcept {
  return leg_phase(clock_.phase(), offset_[leg], stride.parameters.duty_factor);
}

Vector3 GaitGenerator::position_of(Leg leg, const Stride& stride, const LegPhase& phase) const noexcept {
  return foot_position(stride.parameters, leg, phase,
                       {rolling_correction_.cwiseProduct(stride.step[leg]), stride.lift_scale, curve_[leg]});
}

void GaitGenerator::place_feet() noexcept {
  const bool lifts = effective_.lift_scale > 0;
  for (const Leg leg : kLegs) {
    const LegPhase phase = phase_of(leg, effective_);
    // Both curves begin where the stance ends, so a foot changes over while it stands.
    if (!phase.swing) curve_[leg] = wanted_.swing;
    targets_[leg] = {position_of(leg, effective_, phase), phase.swing && lifts, phase.phase, phase.progress};
  }
}

}  // namespace crossgait
