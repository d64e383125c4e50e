#include "physics/robot_files/mjcf/mjcf_shapes.h"

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/robot/robot_check.h"
#include "physics/robot_files/mesh/ellipsoid.h"
#include "physics/robot_files/mesh/mesh_vertices.h"

namespace crossgait {
namespace {

constexpr int kLastShownGroup = 2;

}  // namespace

std::vector<int> MjcfShapes::add(const MjcfGeom& geom, const Pose& X_BA, Body& body) {
  const Pose X_BG = X_BA * geom.X_BG;
  const std::size_t first = body.shapes.size();
  if (geom.type == MjcfGeomType::kOther) {
    warnings_.count("dropped ", " geom(s) that are no sphere, ellipsoid, capsule, cylinder, box or mesh",
                    where(geom));
  } else {
    if (geom.collides) collide(geom, X_BG, body);
    if (geom.group <= kLastShownGroup) show(geom, X_BG, body);
  }
  std::vector<int> indices;
  for (std::size_t i = first; i < body.shapes.size(); ++i) indices.push_back(static_cast<int>(i));
  return indices;
}

void MjcfShapes::collide(const MjcfGeom& geom, const Pose& X_BG, Body& body) {
  switch (geom.type) {
    case MjcfGeomType::kSphere:
      return add_shape(geom.name, ShapeType::kSphere, {geom.size[0], 0, 0}, X_BG, body);
    case MjcfGeomType::kBox:
      return add_shape(geom.name, ShapeType::kBox, geom.size, X_BG, body);
    case MjcfGeomType::kCylinder:
      return add_shape(geom.name, ShapeType::kCylinder, {geom.size[0], geom.size[1], 0}, X_BG, body);
    case MjcfGeomType::kCapsule:
      return add_shape(geom.name, ShapeType::kCapsule, {geom.size[0], geom.size[1], 0}, X_BG, body);
    case MjcfGeomType::kEllipsoid:
      if (geom.size.minCoeff() == geom.size.maxCoeff())
        return add_shape(geom.name, ShapeType::kSphere, {geom.size[0], 0, 0}, X_BG, body);
      [[fallthrough]];
    case MjcfGeomType::kMesh: {
      CollisionShape shape;
      shape.name = geom.name;
      shape.X_BG = X_BG;
      if (set_vertices(geom, shape)) body.shapes.push_back(std::move(shape));
      return;
    }
    case MjcfGeomType::kOther:
      break;
  }
}

void MjcfShapes::add_shape(const std::string& name, ShapeType type, const Vector3& size, const Pose& X_BG,
                           Body& body) {
  CollisionShape shape;
  shape.name = name;
  shape.type = type;
  shape.size = size;
  shape.X_BG = X_BG;
  check_shape(shape, path_, fmt::format("geom '{}'", name));
  body.shapes.push_back(shape);
}

bool MjcfShapes::set_vertices(const MjcfGeom& geom, CollisionShape& shape) {
  if (geom.type == MjcfGeomType::kEllipsoid) {
    meshes_.set_vertices(ellipsoid_vertices(geom.size), where(geom), shape);
    return true;
  }
  const MjcfMesh& mesh = parts_.meshes.at(geom.mesh);
  const std::string place = fmt::format("{} ('{}')", where(geom), printable_text(mesh.written, 200));
  std::vector<Vector3> vertices;
  if (mesh.written.empty()) {
    vertices = geom.vertices;
  } else if (!is_mesh_format(mesh.written)) {
    warnings_.count("dropped ", fmt::format(" collision mesh(es) that are no {}", kMeshFormats), place);
    return false;
  } else if (mesh.file.empty()) {
    warnings_.count("dropped ", " collision mesh(es) whose file is not there", place);
    return false;
  } else {
    vertices = meshes_.vertices_of(mesh.file);
    for (Vector3& v : vertices) v = mesh.scale.cwiseProduct(mesh.R_ref.transpose() * (v - mesh.p_ref));
  }
  meshes_.set_vertices(std::move(vertices), where(geom), shape);
  check_shape(shape, path_, fmt::format("geom '{}'", geom.name));
  return true;
}

void MjcfShapes::show(const MjcfGeom& geom, const Pose& X_BG, Body& body) {
  VisualShape visual;
  visual.size = geom.size;
  visual.X_BG = X_BG;
  visual.rgba = geom.rgba;
  switch (geom.type) {
    case MjcfGeomType::kSphere:
      visual.type = VisualType::kSphere;
      break;
    case MjcfGeomType::kBox:
      visual.type = VisualType::kBox;
      break;
    case MjcfGeomType::kCylinder:
      visual.type = VisualType::kCylinder;
      break;
    case MjcfGeomType::kCapsule:
      visual.type = VisualType::kCapsule;
      break;
    case MjcfGeomType::kMesh:
    case MjcfGeomType::kEllipsoid:
    case MjcfGeomType::kOther:
      visual.type = VisualType::kMesh;
      visual.size = Vector3::Zero();
      if (geom.type == MjcfGeomType::kMesh) set_visual_mesh(geom, visual);
  }
  body.visuals.push_back(std::move(visual));
}

void MjcfShapes::set_visual_mesh(const MjcfGeom& geom, VisualShape& visual) {
  const MjcfMesh& mesh = parts_.meshes.at(geom.mesh);
  const bool uniform = (mesh.scale.array() == mesh.scale[0]).all();
  if (mesh.written.empty() || (mesh.is_moved() && !uniform)) {
    warnings_.count("dropped ", " visual mesh(es) that are no file, or one turned and then stretched",
                    where(geom));
    return;
  }
  if (mesh.file.empty()) {
    warnings_.count("dropped ", " visual mesh(es) whose file is not there",
                    fmt::format("{} ('{}')", where(geom), printable_text(mesh.written, 200)));
    return;
  }
  // p = s R^T (v - p_ref)
  Pose X_GM = Pose::Identity();
  X_GM.linear() = mesh.R_ref.transpose();
  X_GM.translation() = -mesh.scale[0] * (X_GM.linear() * mesh.p_ref);
  if (mesh.is_moved()) visual.X_BG = visual.X_BG * X_GM;
  visual.mesh = mesh.file;
  visual.scale = mesh.scale;
}

std::string MjcfShapes::where(const MjcfGeom& geom) const {
  return mjcf_place(parts_.element("geom", geom.name), path_);
}

}  // namespace crossgait
