#include "report/mesh_detail.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

namespace crossgait {

TriangleMesh coarser(const TriangleMesh& mesh, double cell) {
  std::map<std::array<double, 3>, std::uint32_t> cubes;
  std::vector<std::uint32_t> place(mesh.vertices.size());
  std::vector<double> counts;
  TriangleMesh result;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Vector3& p = mesh.vertices[i];
    const std::array<double, 3> cube{std::floor(p.x() / cell), std::floor(p.y() / cell),
                                     std::floor(p.z() / cell)};
    const auto [known, is_new] = cubes.try_emplace(cube, static_cast<std::uint32_t>(counts.size()));
    if (is_new) {
      result.vertices.emplace_back(Vector3::Zero());
      counts.push_back(0);
    }
    place[i] = known->second;
    result.vertices[place[i]] += p;
    ++counts[place[i]];
  }
  for (std::size_t i = 0; i < counts.size(); ++i) result.vertices[i] /= counts[i];
  std::set<std::array<std::uint32_t, 3>> seen;
  for (std::size_t t = 0; t + 2 < mesh.triangles.size(); t += 3) {
    std::array<std::uint32_t, 3> corners{place[mesh.triangles[t]], place[mesh.triangles[t + 1]],
                                         place[mesh.triangles[t + 2]]};
    // From the least corner on, so that the way around, which says which side is seen, stays.
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[0] == corners[2]) continue;
    if (seen.insert(corners).second)
      result.triangles.insert(result.triangles.end(), corners.begin(), corners.end());
  }
  return result;
}

}  // namespace crossgait
