#include "physics/robot_files/mesh/ellipsoid.h"

#include <cmath>
#include <numbers>

namespace crossgait {

std::vector<Vector3> ellipsoid_vertices(const Vector3& radii) {
  constexpr int kRings = 16, kOnARing = 32;
  std::vector<Vector3> vertices{{0, 0, radii.z()}, {0, 0, -radii.z()}};
  for (int ring = 1; ring < kRings; ++ring) {
    const double polar = std::numbers::pi * ring / kRings;
    for (int i = 0; i < kOnARing; ++i) {
      const double around = 2 * std::numbers::pi * i / kOnARing;
      vertices.push_back(radii.cwiseProduct(
          Vector3(std::sin(polar) * std::cos(around), std::sin(polar) * std::sin(around), std::cos(polar))));
    }
  }
  return vertices;
}

}  // namespace crossgait
