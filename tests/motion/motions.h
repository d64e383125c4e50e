// Worlds and sources in which a motion comes to each of its ends.
#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <optional>

#include "motion/gait_source.h"
#include "motion/walk.h"
#include "scenes/scenes.h"

namespace crossgait::motions {

inline ControllerPtr trot(const scenes::RobotPtr& robot, const std::optional<VelocityCommand>& command = {}) {
  return make_gait_controller(choose_gait("trot", {}, command), scenes::world_of(robot));
}

/// Makes feet stay under the shoulders.
inline ControllerPtr standing(const scenes::RobotPtr& robot, double height = 0.06) {
  LegArray<Vector3> feet;
  feet.fill(Vector3(0, 0, -height));
  return make_feet_controller([feet](double) { return feet; }, scenes::world_of(robot));
}

/// Is a controller made of functions, so that a test can change one of another's.
struct FunctionController final : Controller {
  explicit FunctionController(const ControllerPtr& of)
      : on_stand(
            [of](const Terrain& terrain, const Placement& at) { return of->initial_state(terrain, at); }),
        on_hold([of](double dt, ControlTargets& out) { of->hold_pose(dt, out); }),
        on_advance([of](double dt, ControlTargets& out) { of->advance(dt, out); }),
        on_look([of](const RobotState& state, double dt) { of->observe(state, dt); }) {}

  RobotState initial_state(const Terrain& terrain, const Placement& at) const override {
    return on_stand(terrain, at);
  }
  void hold_pose(double dt, ControlTargets& out) override { on_hold(dt, out); }
  void advance(double dt, ControlTargets& out) override { on_advance(dt, out); }
  void observe(const RobotState& state, double dt) override { on_look(state, dt); }

  std::function<RobotState(const Terrain&, const Placement&)> on_stand;
  std::function<void(double, ControlTargets&)> on_hold, on_advance;
  std::function<void(const RobotState&, double)> on_look;
};

inline std::shared_ptr<FunctionController> functions_of(const ControllerPtr& controller) {
  return std::make_shared<FunctionController>(controller);
}

/// Returns the quadruped with servos that can hold next to nothing.
inline scenes::RobotPtr weak_quadruped() {
  RobotDescription robot = *scenes::quadruped();
  for (Body& body : robot.bodies) body.joint.effort_limit *= 0.01;
  return scenes::finished(robot);
}

/// Returns the quadruped at a hundredth of its mass and of every force that moves it: the same motion, but
/// for pushes.
inline scenes::RobotPtr light_quadruped() {
  RobotDescription robot = *scenes::quadruped();
  for (Body& body : robot.bodies) {
    body.inertia.mass *= 0.01;
    body.inertia.I_C *= 0.01;
    for (double* value : {&body.joint.damping, &body.joint.armature, &body.joint.kp, &body.joint.kd,
                          &body.joint.effort_limit})
      *value *= 0.01;
  }
  return scenes::finished(robot);
}

/// Throws the robot beyond any state that an engine accepts, by a push at `time` (s).
inline Pushes catastrophe(double time) { return {{1e9, 1e9}, {time, time}, time, 0, Random(1)}; }

/// Describes a plane that falls away by `angle` towards +x.
inline WorldSpec inclined(double angle, double friction) {
  WorldSpec spec = scenes::world_of(scenes::quadruped());
  spec.gravity = 9.81 * Vector3(std::sin(angle), 0, -std::cos(angle));
  spec.contact.friction = friction;
  return spec;
}

inline double at(const MotionSummary& motion, Outcome outcome) {
  return motion.first_at_s[static_cast<std::size_t>(outcome)].value_or(-1);
}

}  // namespace crossgait::motions
