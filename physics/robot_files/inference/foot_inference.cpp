#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <Eigen/Dense>
#include <fmt/format.h>

#include "physics/core/across_axis.h"
#include "physics/core/error.h"
#include "physics/robot_files/inference/robot_inference.h"
#include "physics/robot_files/inference/shape_outline.h"
#include "physics/robot_files/mesh/mesh_vertices.h"

namespace crossgait {
namespace {

constexpr double kTip = 0.1;           // of the way from the knee: how much of a mesh's end is its tip
constexpr double kRoundness = 0.12;    // of a sphere's radius: largest RMS distance of a mesh's tip from it
constexpr double kLargestFoot = 0.2;   // of the way from the knee: a larger sphere is no foot
constexpr double kSmallFoot = 0.05;    // likewise, radius of a foot whose shape says nothing
constexpr double kFarHalf = 0.5;       // likewise: a round nearer than that is the knee's, and no foot
constexpr double kSole = 0.1;          // of the way from the knee: how unlike the ends of a sole are
constexpr double kAcrossTheLeg = 0.9;  // cosine: a cylinder about the knee's axis

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

/// The end that is farther from the knee; of a sole, whose ends are as far, its middle.
Vector3 foot_of_capsule(const CollisionShape& capsule, const Vector3& axis) {
  const auto [one, other] = ends_of(capsule);
  const double far_one = across(one, axis).norm(), far_other = across(other, axis).norm();
  if (std::abs(far_one - far_other) < kSole * std::max(far_one, far_other)) return capsule.X_BG.translation();
  return far_one > far_other ? one : other;
}

/// Moves a foot that is one of several like spheres, as far from the knee, to their middle.
void put_between_toes(const Body& body, FootPlace& foot) {
  constexpr double kAlike = 0.05, kAsFar = 0.15;  // of radii, and of the way from the knee
  const double far = across(foot.p_BF, body.joint.axis).norm();
  Vector3 sum = Vector3::Zero();
  int toes = 0;
  for (const CollisionShape& shape : body.shapes) {
    const Vector3& p = shape.X_BG.translation();
    if (shape.type != ShapeType::kSphere || std::abs(shape.size[0] - foot.radius) > kAlike * foot.radius ||
        far - across(p, body.joint.axis).norm() > kAsFar * far)
      continue;
    sum += p;
    ++toes;
  }
  if (toes < 2) return;
  foot.p_BF = sum / toes;
  foot.reason = fmt::format("the middle of {} spheres as far from the knee as any", toes);
}

/// The foot of a link without a collision sphere, from what is farthest along it.
FootPlace foot_at_the_tip(const std::vector<Vector3>& points, const Vector3& axis) {
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
    return {ball->centre, ball->radius, -1, "no sphere: the one through the mesh's vertices at its tip"};
  }
  // In the middle of the tip, not at its corner.
  Vector3 middle = Vector3::Zero();
  for (const Vector3& p : tip) middle += p / static_cast<double>(tip.size());
  const double radius = kSmallFoot * reach;
  return {middle + (reach - radius - down.dot(middle)) * down, radius, -1,
          "no sphere, and no round tip: a small one at the end"};
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

/// Vertices of a mesh that is only looked at; none if it cannot be read, for looks make no file unfit.
std::vector<Vector3> vertices_of_look(const std::string& file) {
  if (!is_mesh_format(file)) return {};
  try {
    return read_mesh_vertices(file);
  } catch (const ConfigError&) {
    return {};
  }
}

}  // namespace

std::optional<FootPlace> find_foot(const ParsedRobot& robot, const Body& body) {
  FootPlace foot, round_end;
  double farthest = -1, farthest_end = -1, reach = 0;
  const auto take_if_farther = [&](const Vector3& p, double radius, int shape, FootPlace& place,
                                   double& most) {
    const double distance = across(p, body.joint.axis).norm();
    if (distance <= most) return;
    most = distance;
    place.p_BF = p, place.radius = radius, place.shape = shape;
  };
  std::vector<Vector3> points;
  for (std::size_t i = 0; i < body.shapes.size(); ++i) {
    const CollisionShape& shape = body.shapes[i];
    if (shape.type == ShapeType::kSphere) {
      take_if_farther(shape.X_BG.translation(), shape.size[0], static_cast<int>(i), foot, farthest);
      continue;
    }
    const bool is_mesh = robot.mesh_vertices.contains(shape.name);
    if (shape.type == ShapeType::kCapsule && !is_mesh)
      take_if_farther(foot_of_capsule(shape, body.joint.axis), shape.size[0], -1, round_end, farthest_end);
    if (shape.type == ShapeType::kCylinder && !is_mesh &&
        std::abs(shape.X_BG.linear().col(2).dot(body.joint.axis)) > kAcrossTheLeg)
      take_if_farther(shape.X_BG.translation(), shape.size[0], -1, round_end, farthest_end);
    const std::vector<Vector3> more = outline_of(robot, shape);
    for (const Vector3& p : more) reach = std::max(reach, across(p, body.joint.axis).norm());
    points.insert(points.end(), more.begin(), more.end());
  }
  if (farthest >= 0) {
    foot.reason = "sphere farthest from the knee";
    put_between_toes(body, foot);
    return foot;
  }
  if (farthest_end > kFarHalf * reach) {
    round_end.reason =
        "no sphere: of the capsule or the round that lies across farthest from the knee the end, or the "
        "middle of "
        "a sole";
    return round_end;
  }
  if (points.empty() || !(reach > 0)) return std::nullopt;
  return foot_at_the_tip(points, body.joint.axis);
}

std::optional<FootPlace> find_seen_foot(const Body& body) {
  ParsedRobot seen;
  Body looks = body;
  looks.shapes.clear();
  for (std::size_t i = 0; i < body.visuals.size(); ++i) {
    const VisualShape& visual = body.visuals[i];
    CollisionShape shape;
    shape.name = std::to_string(i);
    shape.size = visual.size;
    shape.X_BG = visual.X_BG;
    if (visual.type == VisualType::kMesh) {
      std::vector<Vector3> vertices = vertices_of_look(visual.mesh);
      if (vertices.empty()) continue;
      for (Vector3& vertex : vertices) vertex = visual.X_BG * vertex.cwiseProduct(visual.scale);
      shape.type = ShapeType::kHull;
      seen.mesh_vertices[shape.name] = std::move(vertices);
    } else {
      shape.type = visual.type == VisualType::kSphere     ? ShapeType::kSphere
                   : visual.type == VisualType::kBox      ? ShapeType::kBox
                   : visual.type == VisualType::kCylinder ? ShapeType::kCylinder
                                                          : ShapeType::kCapsule;
    }
    looks.shapes.push_back(std::move(shape));
  }
  std::optional<FootPlace> foot = find_foot(seen, looks);
  if (foot) foot->shape = -1;  // it does not touch: there is none yet
  return foot;
}

std::optional<FootPlace> find_foot_link(const ParsedRobot& robot, int body_index) {
  const Body& body = robot.bodies[static_cast<std::size_t>(body_index)];
  FootPlace foot;
  double farthest = 0;
  for (const auto& [name, link] : robot.links) {
    const double distance = across(link.X_BL.translation(), body.joint.axis).norm();
    if (link.body != body_index || distance <= farthest) continue;
    farthest = distance;
    foot.p_BF = link.X_BL.translation();
    foot.radius = kSmallFoot * distance;
    foot.reason = fmt::format(
        "no shape: the origin of '{}', the link fixed to it that is farthest from the knee", name);
  }
  return farthest > 0 ? std::optional(foot) : std::nullopt;
}

std::size_t leave_out_around(const ParsedRobot& urdf, const Vector3& p_BF, double radius, Body& body) {
  // Boxes in the place of meshes reach beyond the foot; shins that end in it sink in along with it.
  return std::erase_if(body.shapes, [&](const CollisionShape& shape) {
    return urdf.mesh_vertices.count(shape.name) > 0 ||
           (shape.type != ShapeType::kSphere && distance_to(shape, p_BF) < 2 * radius);
  });
}

}  // namespace crossgait
