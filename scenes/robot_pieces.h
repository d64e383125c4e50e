// What robots built in code are put together from. Private to scenes.
#pragma once

#include <string>
#include <utility>

#include "physics/robot/robot.h"

namespace crossgait::scenes {

/// Makes a body that nothing holds.
inline Body free_body(std::string name, const SpatialInertia& inertia) {
  Body body;
  body.name = std::move(name);
  body.inertia = inertia;
  return body;
}

/// Makes a collision shape at `p_BG` of its body, m.
inline CollisionShape shape(std::string name, ShapeType type, const Vector3& size,
                            const Vector3& p_BG = Vector3::Zero()) {
  CollisionShape result;
  result.name = std::move(name);
  result.type = type;
  result.size = size;
  result.X_BG.translation() = p_BG;
  return result;
}

}  // namespace crossgait::scenes
