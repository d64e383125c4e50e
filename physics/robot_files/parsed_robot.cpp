#include "physics/robot_files/parsed_robot.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "physics/robot/rigid_pair.h"

namespace crossgait {
namespace {

void move_vertices(ParsedRobot& robot, const std::string& shape, const Pose& X) {
  const auto mesh = robot.mesh_vertices.find(shape);
  if (mesh == robot.mesh_vertices.end()) return;
  for (Vector3& vertex : mesh->second) vertex = X * vertex;
}

}  // namespace

bool follows(const ParsedRobot& robot, const std::string& joint) {
  return std::ranges::any_of(robot.couplings, [&joint](const NamedCoupling& coupling) {
    return coupling.follower == joint && !coupling.is_driven;
  });
}

ParsedRobot lock_joints(ParsedRobot robot, const std::map<std::string, double>& joints) {
  std::vector<int> index(robot.bodies.size(), 0);                // of the body that each becomes part of
  std::vector<Pose> X(robot.bodies.size(), Pose::Identity());    // and its pose there
  std::vector<std::size_t> first_shape(robot.bodies.size(), 0);  // and where its shapes are
  std::vector<Body> kept;
  for (std::size_t i = 0; i < robot.bodies.size(); ++i) {
    Body& body = robot.bodies[i];
    const auto held = i > 0 ? joints.find(body.joint.name) : joints.end();
    const bool locked = held != joints.end();
    if (i > 0) {
      const auto parent = static_cast<std::size_t>(body.parent);
      body.X_PB = X[parent] * body.X_PB;
      body.parent = index[parent];
    }
    if (!locked) {
      index[i] = static_cast<int>(kept.size());
      kept.push_back(std::move(body));
      continue;
    }
    Body& host = kept[static_cast<std::size_t>(body.parent)];
    index[i] = body.parent;
    X[i] = body.X_PB * Eigen::AngleAxisd(held->second, body.joint.axis);
    first_shape[i] = host.shapes.size();
    host.inertia = combine(host.inertia, moved(X[i], body.inertia));
    for (CollisionShape& shape : body.shapes) {
      shape.X_BG = X[i] * shape.X_BG;
      move_vertices(robot, shape.name, X[i]);
      host.shapes.push_back(std::move(shape));
    }
    for (VisualShape& visual : body.visuals) {
      visual.X_BG = X[i] * visual.X_BG;
      host.visuals.push_back(std::move(visual));
    }
  }
  robot.bodies = std::move(kept);
  for (auto& [name, link] : robot.links) {
    const auto body = static_cast<std::size_t>(link.body);
    link.body = index[body];
    link.X_BL = X[body] * link.X_BL;
    for (int& shape : link.shapes) shape += static_cast<int>(first_shape[body]);
  }
  return robot;
}

ParsedRobot turn_base(ParsedRobot robot, const Matrix3& R_BA) {
  Pose X_AB = Pose::Identity();
  X_AB.linear() = R_BA.transpose();
  robot.bodies[0].inertia = moved(X_AB, robot.bodies[0].inertia);
  for (CollisionShape& shape : robot.bodies[0].shapes) {
    shape.X_BG = X_AB * shape.X_BG;
    move_vertices(robot, shape.name, X_AB);
  }
  for (VisualShape& visual : robot.bodies[0].visuals) visual.X_BG = X_AB * visual.X_BG;
  for (Body& body : robot.bodies) {
    if (body.parent == 0) body.X_PB = X_AB * body.X_PB;
  }
  for (auto& [name, link] : robot.links) {
    if (link.body == 0) link.X_BL = X_AB * link.X_BL;
  }
  return robot;
}

}  // namespace crossgait
