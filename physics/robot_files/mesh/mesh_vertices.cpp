#include "physics/robot_files/mesh/mesh_vertices.h"

#include <algorithm>
#include <map>
#include <string_view>
#include <tuple>

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/robot_files/file_extension.h"
#include "physics/robot_files/mesh/dae_reader.h"
#include "physics/robot_files/mesh/mesh_corners.h"
#include "physics/robot_files/mesh/obj_reader.h"
#include "physics/robot_files/mesh/stl_reader.h"

namespace crossgait {
namespace {

/// As the file has it: vertices may be equal, or in no triangle.
TriangleMesh read_mesh(const std::string& path, const std::string& part) {
  const std::string extension = lower_extension(path);
  if (extension == ".dae") return read_dae(path, part);
  if (extension == ".obj") return read_obj(path, part);
  if (!part.empty()) MeshPartNames().fail_without(path, part);  // of an STL
  return read_stl(path);
}

/// Drops vertices that no triangle has: what is left over of an edit stands anywhere.
void keep_used(TriangleMesh& mesh) {
  std::vector<bool> is_used(mesh.vertices.size());
  for (const std::uint32_t corner : mesh.triangles) is_used[corner] = true;
  std::size_t i = 0;
  std::erase_if(mesh.vertices, [&](const Vector3&) { return !is_used[i++]; });
}

/// Equal vertices become one.
TriangleMesh weld(const TriangleMesh& from) {
  TriangleMesh mesh;
  std::map<std::tuple<double, double, double>, std::uint32_t> known;
  for (const std::uint32_t corner : from.triangles) {
    const Vector3& v = from.vertices[corner];
    const auto [it, is_new] =
        known.try_emplace({v.x(), v.y(), v.z()}, static_cast<std::uint32_t>(mesh.vertices.size()));
    if (is_new) mesh.vertices.push_back(v);
    mesh.triangles.push_back(it->second);
  }
  return mesh;
}

}  // namespace

bool is_mesh_format(const std::string& path) {
  const std::string extension = lower_extension(path);
  return extension == ".stl" || extension == ".obj" || extension == ".dae";
}

std::vector<Vector3> read_mesh_vertices(const std::string& path, const std::string& part) {
  TriangleMesh mesh = read_mesh(path, part);
  if (!mesh.triangles.empty()) keep_used(mesh);
  std::vector<Vector3> vertices = std::move(mesh.vertices);
  const auto key = [](const Vector3& v) { return std::tuple(v.x(), v.y(), v.z()); };
  std::ranges::sort(vertices, {}, key);
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  vertices.shrink_to_fit();
  return vertices;
}

TriangleMesh read_mesh_triangles(const std::string& path) {
  const TriangleMesh mesh = read_mesh(path, "");
  if (mesh.triangles.empty() || mesh.triangles.size() % 3 != 0)
    throw ConfigError(path, "file", "whole triangles", fmt::format("{} corners", mesh.triangles.size()));
  return lower_extension(path) == ".stl" ? weld(mesh) : mesh;
}

}  // namespace crossgait
