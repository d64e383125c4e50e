// The same robot, described from elsewhere.
#pragma once

#include "physics/robot/robot.h"

namespace crossgait {

/// Returns the robot with the base's frame at `X_BN` of what it was; no legs move over the ground.
inline RobotDescription with_base_frame(RobotDescription robot, const Pose& X_BN) {
  const Pose X_NB = X_BN.inverse();
  Body& base = robot.bodies[0];
  base.inertia.p_BC = X_NB * base.inertia.p_BC;
  base.inertia.I_C = X_NB.linear() * base.inertia.I_C * X_NB.linear().transpose();
  for (CollisionShape& shape : base.shapes) shape.X_BG = X_NB * shape.X_BG;
  for (VisualShape& visual : base.visuals) visual.X_BG = X_NB * visual.X_BG;
  for (Body& body : robot.bodies)
    if (body.parent == 0) body.X_PB = X_NB * body.X_PB;
  for (LoopClosure& loop : robot.loops) {
    if (loop.body_a == 0) loop.p_AP = X_NB * loop.p_AP;
    if (loop.body_b == 0) loop.p_BP = X_NB * loop.p_BP;
  }
  robot.home_height += X_BN.translation().z();
  return robot;
}

}  // namespace crossgait
