// Worlds and sources in which a motion comes to each of its ends.
#pragma once

#include <cmath>
#include <optional>

#include "motion/gait_source.h"
#include "motion/walk.h"
#include "scenes/scenes.h"

namespace crossgait::motions {

inline TargetSource trot(const scenes::RobotPtr& robot, const std::optional<VelocityCommand>& command = {}) {
  return make_gait_source(choose_gait("trot", {}, command), robot);
}

/// Feet that stay under the shoulders.
inline TargetSource standing(const scenes::RobotPtr& robot, double height = 0.06) {
  LegArray<Vector3> feet;
  feet.fill(Vector3(0, 0, -height));
  return make_feet_source([feet](double) { return feet; }, robot);
}

/// The quadruped with servos that can hold next to nothing.
inline scenes::RobotPtr weak_quadruped() {
  RobotDescription robot = *scenes::quadruped();
  for (Body& body : robot.bodies) body.joint.effort_limit *= 0.01;
  return scenes::finished(robot);
}

/// The quadruped at a hundredth of its mass and of every force that moves it: the same motion, but for
/// pushes.
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

/// A push that throws the robot beyond any state that an engine accepts, at `time` (s).
inline Pushes catastrophe(double time) { return {{1e9, 1e9}, {time, time}, time, 0, Random(1)}; }

/// On a plane that falls away by `angle` towards +x.
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
