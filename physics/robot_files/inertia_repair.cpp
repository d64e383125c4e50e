#include "physics/robot_files/inertia_repair.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/robot/robot_check.h"
#include "physics/robot/shape_box.h"

namespace crossgait {
namespace {

/// By which a raised moment exceeds what it has to be: a flat or thin body at the very limit is refused by
/// engines when its principal moments are rounded.
constexpr double kMargin = 1e-3;
/// As in check_inertia.
constexpr double kTriangleRounding = 1e-9;
constexpr double kLeastGyration = 1e-6;  // m; less is the rounding of zeros that were turned
constexpr double kWater = 1000;          // kg/m^3

/// Edges of the box along the body's axes that holds all shapes, m.
Vector3 bounding_box(const std::vector<CollisionShape>& shapes) {
  Eigen::AlignedBox3d box;
  for (const CollisionShape& shape : shapes) box.extend(box_around(shape));
  return box.sizes();
}

std::string_view invent(SpatialInertia& inertia, const std::vector<CollisionShape>& shapes) {
  if (shapes.empty()) {
    const double radius = std::cbrt(3 * inertia.mass / (4 * std::numbers::pi * kWater));
    inertia.I_C = 0.4 * inertia.mass * radius * radius * Matrix3::Identity();
    return "without inertia or shapes, given that of a solid sphere of water: ";
  }
  const Vector3 squares = bounding_box(shapes).cwiseAbs2();
  inertia.I_C = (inertia.mass / 12 * (Vector3::Constant(squares.sum()) - squares)).asDiagonal();
  return "without inertia, given that of the bounding box of their shapes: ";
}

}  // namespace

std::string_view repair_inertia(SpatialInertia& inertia, const std::vector<CollisionShape>& shapes) {
  if (inertia.I_C.cwiseAbs().maxCoeff() < inertia.mass * kLeastGyration * kLeastGyration) {
    return invent(inertia, shapes);
  }
  if (!inertia.I_C.allFinite() || inertia.I_C.cwiseAbs().maxCoeff() > kLargestInertia) return {};
  const Eigen::SelfAdjointEigenSolver<Matrix3> eigen(inertia.I_C);
  const Vector3& before = eigen.eigenvalues();  // rising
  const double largest = before[2];
  const bool possible = before[0] > 0 && largest <= (before[0] + before[1]) * (1 + kTriangleRounding);
  if (possible || largest <= 0) return {};
  // The smallest first, up to the middle one, and then both: the least that has to be added.
  const double needed = largest * (1 + kMargin);
  Vector3 after = before;
  after[1] = std::max(before[1], needed / 2);
  after[0] = std::max(before[0], needed - after[1]);
  const Matrix3& R = eigen.eigenvectors();
  inertia.I_C = R * after.asDiagonal() * R.transpose();
  inertia.I_C = 0.5 * (inertia.I_C + inertia.I_C.transpose()).eval();
  return before[0] < 0 ? "with negative principal moments, raised to what a real body has: "
                       : "whose small principal moments are raised to what a real body has: ";
}

void check_part(double mass, const Matrix3& I, const std::string& source, const std::string& element,
                ReaderWarnings& warnings) {
  const auto require = [&](bool ok, const std::string& expected, double found) {
    if (!ok) throw ConfigError(source, element, expected, fmt::format("{}", found));
  };
  require(mass >= 0, "mass (kg) >= 0", mass);
  require(mass <= kHeaviestBody, fmt::format("mass (kg) of at most {:g}", kHeaviestBody), mass);
  const double largest = I.cwiseAbs().maxCoeff();
  require(largest <= kLargestInertia, fmt::format("inertia (kg m^2) of at most {:g}", kLargestInertia),
          largest);
  if (mass == 0 && largest > 0) warnings.count("left out the inertia of ", " link(s) without mass", element);
}

void check_whole(Body& body, bool has_inertial, const std::string& source, const std::string& element,
                 ReaderWarnings& warnings) {
  if (body.inertia.mass == 0) {
    throw ConfigError(
        source, element,
        has_inertial ? "mass (kg) > 0 on a moving link" : "an <inertial> element on a moving link",
        has_inertial ? "0" : "none");
  }
  const std::string_view repair = repair_inertia(body.inertia, body.shapes);
  if (!repair.empty())
    warnings.list(fmt::format(" moving link(s) {}", repair), fmt::format("'{}'", body.name));
  check_inertia(body.inertia, source, element);
}

}  // namespace crossgait
