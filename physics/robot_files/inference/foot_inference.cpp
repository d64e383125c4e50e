#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include <Eigen/Dense>
#include <fmt/format.h>

#include "physics/core/across_axis.h"
#include "physics/core/error.h"
#include "physics/robot_files/inference/robot_inference.h"

namespace crossgait {
namespace {

constexpr double kTip = 0.1;          // of the way from the knee: how much of a mesh's end is its tip
constexpr double kRoundness = 0.12;   // of a sphere's radius: largest RMS distance of a mesh's tip from it
constexpr double kLargestFoot = 0.2;  // of the way from the knee: a larger sphere is no foot
constexpr double kSmallFoot = 0.05;   // likewise, radius of a foot whose shape says nothing

struct Ball {
  Vector3 centre;
  double radius;
};

/// Least squares in |p|^2 = 2 c.p + (r^2 - |c|^2), which is linear. @returns nothing if the points do not lie
/// on it
std::optional<Ball> fit_ball(const std::vector<Vector3>& points) {
  constexpr std::size_t kFew = 8;  // a box's corners lie on a sphere too
  if (points.size() <= kFew) return std::nullopt;
  Eigen::MatrixX4d A(points.size(), 4);
  Eigen::VectorXd b(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    A.row(row) << 2 * points[i].transpose(), 1;
    b[row] = points[i].squaredNorm();
  }
  const Eigen::Vector4d x = A.colPivHouseholderQr().solve(b);
  const double square = x[3] + x.head<3>().squaredNorm();
  if (!(x.allFinite() && square > 0)) return std::nullopt;
  const Ball ball{x.head<3>(), std::sqrt(square)};
  double squares = 0;
  for (const Vector3& p : points) squares += std::pow((p - ball.centre).norm() - ball.radius, 2);
  const double rms = std::sqrt(squares / static_cast<double>(points.size()));
  return rms < kRoundness * ball.radius ? std::optional(ball) : std::nullopt;
}

/// The ends of a cylinder's axis, or of a capsule's, in the body's frame.
std::array<Vector3, 2> ends(const CollisionShape& shape) {
  return {shape.X_BG * Vector3(0, 0, -shape.size[1]), shape.X_BG * Vector3(0, 0, shape.size[1])};
}

/// Points of a shape among which is its farthest from anywhere: a mesh's or hull's vertices, a box's corners,
/// the ends of a cylinder's axis (a foot touches with its middle).
std::vector<Vector3> outline(const ParsedRobot& robot, const CollisionShape& shape) {
  if (const auto mesh = robot.mesh_vertices.find(shape.name); mesh != robot.mesh_vertices.end())
    return mesh->second;
  std::vector<Vector3> points;
  if (shape.type == ShapeType::kCylinder || shape.type == ShapeType::kCapsule) {
    for (const Vector3& end : ends(shape)) points.push_back(end);
  } else if (shape.type == ShapeType::kHull) {
    for (const Vector3& vertex : shape.vertices) points.push_back(shape.X_BG * vertex);
  } else {
    for (int corner = 0; corner < 8; ++corner) {
      const auto sign = [corner](int bit) { return (corner >> bit & 1) != 0 ? 1.0 : -1.0; };
      points.push_back(shape.X_BG * Vector3(sign(0), sign(1), sign(2)).cwiseProduct(shape.size));
    }
  }
  return points;
}

/// The foot of a link without a collision sphere, from what is farthest along it.
FootPlace foot_at_the_tip(const std::vector<Vector3>& points, const Vector3& axis, std::string& reason) {
  const auto along = [&axis](const Vector3& p) { return across(p, axis).norm(); };
  const Vector3 farthest = *std::max_element(
      points.begin(), points.end(), [&](const auto& a, const auto& b) { return along(a) < along(b); });
  const double reach = along(farthest);
  const Vector3 down = across(farthest, axis) / reach;
  std::vector<Vector3> tip;
  for (const Vector3& p : points) {
    if (down.dot(p) > (1 - kTip) * reach) tip.push_back(p);
  }
  if (const auto ball = fit_ball(tip); ball && ball->radius < kLargestFoot * reach) {
    reason = "no collision sphere: the one through the mesh's vertices at its tip";
    return {ball->centre, ball->radius, -1};
  }
  // In the middle of the tip, not at its corner.
  Vector3 middle = Vector3::Zero();
  for (const Vector3& p : tip) middle += p / static_cast<double>(tip.size());
  const double radius = kSmallFoot * reach;
  reason = "no collision sphere, and no round tip: a small one at the end";
  return {middle + (reach - radius - down.dot(middle)) * down, radius, -1};
}

/// From a point of its body to a box, cylinder or capsule, m; 0 inside. To a hull: to the nearest vertex.
double distance_to(const CollisionShape& shape, const Vector3& p_B) {
  const Vector3 p = shape.X_BG.inverse() * p_B;
  if (shape.type == ShapeType::kHull) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Vector3& vertex : shape.vertices) nearest = std::min(nearest, (p - vertex).norm());
    return nearest;
  }
  if (shape.type == ShapeType::kCapsule) {
    const Vector3 on_axis(0, 0, std::clamp(p.z(), -shape.size[1], shape.size[1]));
    return std::max(0.0, (p - on_axis).norm() - shape.size[0]);
  }
  Vector3 outside = (p.cwiseAbs() - shape.size).cwiseMax(0);
  if (shape.type == ShapeType::kCylinder)
    outside = {std::max(0.0, std::hypot(p.x(), p.y()) - shape.size[0]), 0,
               std::max(0.0, std::abs(p.z()) - shape.size[1])};
  return outside.norm();
}

}  // namespace

FootPlace find_foot(const ParsedRobot& robot, int body_index, Leg leg, const std::string& source,
                    std::vector<Inference>& inferred) {
  const Body& body = robot.bodies[static_cast<std::size_t>(body_index)];
  FootPlace foot, capsule_end;
  double farthest = -1, farthest_end = -1;
  const auto take_if_farther = [&](const Vector3& p, double radius, int shape, FootPlace& place,
                                   double& most) {
    const double distance = across(p, body.joint.axis).norm();
    if (distance <= most) return;
    most = distance;
    place = {p, radius, shape};
  };
  std::vector<Vector3> points;
  for (std::size_t i = 0; i < body.shapes.size(); ++i) {
    const CollisionShape& shape = body.shapes[i];
    if (shape.type == ShapeType::kSphere) {
      take_if_farther(shape.X_BG.translation(), shape.size[0], static_cast<int>(i), foot, farthest);
      continue;
    }
    if (shape.type == ShapeType::kCapsule && robot.mesh_vertices.count(shape.name) == 0) {
      for (const Vector3& end : ends(shape))
        take_if_farther(end, shape.size[0], -1, capsule_end, farthest_end);
    }
    const std::vector<Vector3> more = outline(robot, shape);
    points.insert(points.end(), more.begin(), more.end());
  }
  std::string reason = "the collision sphere farthest from the knee";
  if (farthest < 0 && farthest_end >= 0) {
    foot = capsule_end;
    reason = "no collision sphere: the end of the capsule farthest from the knee";
  } else if (farthest < 0) {
    if (points.empty()) {
      throw ConfigError(source, fmt::format("link '{}'", body.name),
                        "a collision shape to find the foot by, or `foot` in a robot.yaml", "none");
    }
    foot = foot_at_the_tip(points, body.joint.axis, reason);
  }
  const Vector3& p = foot.p_BF;
  inferred.push_back({fmt::format("legs.{}.foot", name(leg)),
                      fmt::format("sphere of radius {:.4g} m at ({:.4g}, {:.4g}, {:.4g}) m of '{}'",
                                  foot.radius, p.x(), p.y(), p.z(), body.name),
                      reason});
  return foot;
}

std::size_t leave_out_around(const ParsedRobot& urdf, const Vector3& p_BF, double radius, Body& body) {
  // Boxes in the place of meshes reach beyond the foot; shins that end in it sink in along with it.
  return std::erase_if(body.shapes, [&](const CollisionShape& shape) {
    return urdf.mesh_vertices.count(shape.name) > 0 ||
           (shape.type != ShapeType::kSphere && distance_to(shape, p_BF) < 2 * radius);
  });
}

}  // namespace crossgait
