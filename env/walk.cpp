#include "crossgait/env/walk.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "crossgait/env/time_steps.h"
#include "crossgait/physics/error.h"
#include "crossgait/physics/multibody.h"

namespace crossgait {
namespace {

constexpr double kFallen = M_PI / 3;  // rad
constexpr double kDegrees = 180 / M_PI;
constexpr double kMovedDistance = 1e-3;  // m, below which a cost per distance means nothing

double wrap(double angle) { return std::remainder(angle, 2 * M_PI); }

// Sums what WalkSummary reports, one control step at a time.
class Statistics {
 public:
  Statistics(const PhysicsBackend& backend, double dt)
      : backend_(backend), dt_(dt), actuated_(backend.robot().actuated_joints()) {
    const RobotState& s = backend.state();
    start_ = s.p_WB;
    start_yaw_ = roll_pitch_yaw(s.q_WB).z();
  }

  void add(const LegArray<FootContact>& feet) {
    ++count_;
    add_attitude();
    for (const Leg leg : kLegs) {
      if (!feet[leg].touching) continue;
      ++touching_[leg];
      summary_.slip_m += feet[leg].slip_speed * dt_;
    }
    for (const Contact& c : backend_.contacts()) {
      summary_.max_penetration_m = std::max(summary_.max_penetration_m, -c.distance);
    }
    forward_kinematics(backend_.robot(), backend_.state(), poses_);
    summary_.max_loop_gap_m = std::max(summary_.max_loop_gap_m, max_loop_gap(backend_.robot(), poses_));
    for (const int i : actuated_) {
      const double qd = backend_.state().qd[i];
      const double servo = backend_.torques()[i] + backend_.robot().joint(i).damping * qd;
      work_ += std::abs(servo * qd) * dt_;
    }
  }

  WalkSummary finish() {
    const RobotState& s = backend_.state();
    const Vector3 moved = s.p_WB - start_;
    const double c = std::cos(start_yaw_), sn = std::sin(start_yaw_);
    summary_.distance_m = c * moved.x() + sn * moved.y();
    summary_.lateral_m = -sn * moved.x() + c * moved.y();
    summary_.yaw_rad = wrap(roll_pitch_yaw(s.q_WB).z() - start_yaw_);
    summary_.final_position_m = s.p_WB;
    summary_.simulated_seconds = count_ * dt_;
    summary_.physics_steps = std::llround(summary_.simulated_seconds / backend_.spec().physics_dt);
    if (count_ == 0) return summary_;
    summary_.mean_speed_mps = summary_.distance_m / summary_.simulated_seconds;
    summary_.rms_roll_deg = std::sqrt(roll2_ / count_) * kDegrees;
    summary_.rms_pitch_deg = std::sqrt(pitch2_ / count_) * kDegrees;
    for (const Leg leg : kLegs) summary_.duty_factor[leg] = static_cast<double>(touching_[leg]) / count_;
    const double travelled = moved.head<2>().norm();
    const double weight = backend_.robot().total_mass() * backend_.spec().gravity.norm();
    if (travelled > kMovedDistance && weight > 0) summary_.cost_of_transport = work_ / (weight * travelled);
    return summary_;
  }

 private:
  void add_attitude() {
    const Vector3 rpy = roll_pitch_yaw(backend_.state().q_WB);
    roll2_ += rpy.x() * rpy.x();
    pitch2_ += rpy.y() * rpy.y();
    if (!summary_.fell && std::max(std::abs(rpy.x()), std::abs(rpy.y())) > kFallen) {
      summary_.fell = true;
      summary_.fell_at_s = count_ * dt_;
    }
  }

  const PhysicsBackend& backend_;
  double dt_;
  std::vector<int> actuated_;
  std::vector<Pose> poses_;
  Vector3 start_;
  double start_yaw_ = 0;
  int count_ = 0;
  LegArray<int> touching_{};
  double roll2_ = 0, pitch2_ = 0, work_ = 0;
  WalkSummary summary_;
};

}  // namespace

int WalkTiming::substeps(double physics_dt) const {
  const auto require = [](bool ok, const char* element, const char* expected, double found) {
    if (!ok) throw ConfigError("walk", element, expected, fmt::format("{}", found));
  };
  require(std::isfinite(seconds) && seconds > 0 && seconds <= 1e6, "seconds", "a time in (0, 1e6] s",
          seconds);
  require(std::isfinite(control_dt) && control_dt > 0 && control_dt <= 1, "control_dt",
          "a time step in (0, 1] s", control_dt);
  require(std::isfinite(settle_seconds) && settle_seconds >= 0, "settle_seconds", "a time >= 0 s",
          settle_seconds);
  require(is_whole_multiple(control_dt, physics_dt), "control_dt",
          fmt::format("a whole multiple of the physics step of {} s", physics_dt).c_str(), control_dt);
  return step_count(control_dt, physics_dt);
}

int WalkTiming::control_steps() const { return step_count(seconds, control_dt); }

WalkSummary run_walk(PhysicsBackend& backend, LegController& legs, const GaitSource& gait,
                     const WalkTiming& timing, const WalkObserver& observer,
                     const LegController::Placement& start) {
  const auto begin = std::chrono::steady_clock::now();
  const double dt = timing.control_dt;
  const int substeps = timing.substeps(backend.spec().physics_dt);
  const LegArray<Vector3> standing = gait.feet(0);

  backend.reset(legs.standing_state(standing, backend.spec().terrain, start));
  legs.restart();
  StepStatus status = StepStatus::kOk;
  const int settling = step_count(timing.settle_seconds, dt);
  for (int i = 0; i < settling && status == StepStatus::kOk; ++i) {
    status = backend.step(legs.update(standing, dt), substeps);
  }

  Statistics statistics(backend, dt);
  double limit_factor = 1;
  for (int i = 0; i < timing.control_steps() && status == StepStatus::kOk; ++i) {
    const JointTargets& targets = legs.update(gait.feet(dt), dt);
    status = backend.step(targets, substeps);
    if (status != StepStatus::kOk) break;
    const LegArray<FootContact> feet = backend.foot_contacts();
    statistics.add(feet);
    const GaitGenerator* generator = gait.generator ? &gait.generator() : nullptr;
    if (generator != nullptr) limit_factor = std::min(limit_factor, generator->limit_factor());
    const GaitParameters* parameters = generator != nullptr ? &generator->parameters() : nullptr;
    if (observer && !observer({backend.state(), targets, feet, parameters})) break;
  }
  WalkSummary summary = statistics.finish();
  summary.ik_clamped = legs.clamped();
  summary.limit_factor = limit_factor;
  summary.diverged = status != StepStatus::kOk;
  summary.wall_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return summary;
}

}  // namespace crossgait
