#include "physics/robot_files/sdf/sdf_shapes.h"

#include <cmath>
#include <iterator>
#include <numbers>
#include <optional>
#include <sstream>
#include <utility>

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/robot/robot_check.h"
#include "physics/robot_files/mesh/ellipsoid.h"
#include "physics/robot_files/mesh/mesh_path.h"
#include "physics/robot_files/mesh/mesh_vertices.h"
#include "physics/robot_files/sdf/sdf_contact.h"
#include "physics/robot_files/sdf/sdf_values.h"

namespace crossgait {
namespace {

/// The only child of <geometry>, whatever it is; null without one.
const SdfElement* shape_of(const SdfElement& element) {
  const SdfElement* geometry = element.find("geometry");
  if (geometry == nullptr || geometry->children.empty()) return nullptr;
  return geometry->find(geometry->children.front().tag);
}

/// Type and size of a box, sphere, cylinder or capsule, and of an ellipsoid that is a sphere. @returns false
/// for anything else
bool set_simple(const SdfElement& shape, CollisionShape& result) {
  const auto number = [&](const char* child) { return sdf_numbers(sdf_needed(shape, child), 1)[0]; };
  const auto vector = [&](const char* child) {
    sdf_needed(shape, child);
    return sdf_vector(shape, child, {});
  };
  if (shape.tag == "box") {
    result.type = ShapeType::kBox;
    result.size = vector("size") / 2;
  } else if (shape.tag == "sphere") {
    result.type = ShapeType::kSphere;
    result.size = {number("radius"), 0, 0};
  } else if (shape.tag == "cylinder" || shape.tag == "capsule") {
    result.type = shape.tag == "cylinder" ? ShapeType::kCylinder : ShapeType::kCapsule;
    result.size = {number("radius"), number("length") / 2, 0};
  } else if (shape.tag == "ellipsoid") {
    const Vector3 radii = vector("radii");
    result.type = ShapeType::kSphere;
    result.size = {radii.minCoeff(), 0, 0};
    return radii.minCoeff() == radii.maxCoeff();
  } else {
    return false;
  }
  return true;
}

VisualType visual_type(ShapeType type) {
  switch (type) {
    case ShapeType::kBox:
      return VisualType::kBox;
    case ShapeType::kCylinder:
      return VisualType::kCylinder;
    case ShapeType::kCapsule:
      return VisualType::kCapsule;
    default:
      return VisualType::kSphere;
  }
}

std::optional<Eigen::Vector4d> colour_of(const SdfElement& visual) {
  const SdfElement* material = visual.find("material");
  if (material == nullptr) return std::nullopt;
  for (const char* name : {"diffuse", "ambient"}) {
    const SdfElement* colour = material->find(name);
    if (colour == nullptr) continue;
    std::istringstream words(colour->text);
    const auto count = std::distance(std::istream_iterator<std::string>(words), {});
    const std::vector<double> v = sdf_numbers(*colour, count == 3 ? 3 : 4);
    return Eigen::Vector4d(v[0], v[1], v[2], count == 3 ? 1 : v[3]);
  }
  return std::nullopt;
}

}  // namespace

std::vector<int> SdfShapes::add(const SdfElement& link, const std::string& name, const Pose& X_BL,
                                Body& body) {
  std::vector<int> indices;
  for (const SdfElement* collision : link.all("collision")) {
    const SdfElement* element = shape_of(*collision);
    CollisionShape shape;
    shape.name = name_of(*collision, name);
    shape.X_BG = X_BL * sdf_pose(collision->find("pose"));
    collision->pass_over("laser_retro");
    collision->pass_over("max_contacts");
    const auto contact = read_contact(*collision, path_, warnings_);
    if (element == nullptr) warnings_.count("dropped ", " <collision> without a shape", where(*collision));
    if (element == nullptr || !set_geometry(*element, shape)) continue;
    check_shape(shape, path_, where(*collision));
    if (contact) contacts_[shape.name] = *contact;
    indices.push_back(static_cast<int>(body.shapes.size()));
    body.shapes.push_back(std::move(shape));
  }
  return indices;
}

std::string SdfShapes::name_of(const SdfElement& collision, const std::string& link) {
  std::string own = collision.attribute("name");
  if (!own.empty() && names_.insert(own).second) return own;
  std::string name = own.empty() ? link + "_collision" : fmt::format("{}_{}", link, own);
  while (!names_.insert(name).second) name = fmt::format("{}_collision_{}", link, next_name_++);
  return name;
}

bool SdfShapes::set_geometry(const SdfElement& shape, CollisionShape& collision) {
  if (shape.tag == "mesh") return set_mesh(shape, collision);
  if (set_simple(shape, collision)) return true;
  if (shape.tag != "ellipsoid") {
    warnings_.count("dropped ", " collision(s) that are no box, sphere, cylinder, capsule, ellipsoid or mesh",
                    where(shape));
    shape.pass_over_all();
    return false;
  }
  check_shape(collision, path_, where(shape));
  meshes_.set_vertices(ellipsoid_vertices(sdf_vector(shape, "radii", {})), where(shape), collision);
  return true;
}

bool SdfShapes::set_mesh(const SdfElement& mesh, CollisionShape& collision) {
  const SdfElement& uri = sdf_needed(mesh, "uri");
  const Vector3 scale = sdf_mesh_scale(mesh);
  const SdfSubmesh part = sdf_submesh(mesh);
  const std::string place = fmt::format("{} ('{}')", where(mesh), printable_text(uri.text, 200));
  if (!is_mesh_format(uri.text)) {
    warnings_.count("dropped ", fmt::format(" collision mesh(es) that are no {}", kMeshFormats), place);
    return false;
  }
  const auto file = find_named_file(uri.text, *uri.file);
  if (!file) {
    warnings_.count("dropped ", " collision mesh(es) whose file is not there", place);
    return false;
  }
  std::vector<Vector3> vertices = meshes_.vertices_of(*file, part.name);
  part.place(vertices);
  for (Vector3& vertex : vertices) vertex = vertex.cwiseProduct(scale);
  meshes_.set_vertices(std::move(vertices), place, collision);
  return true;
}

void SdfShapes::add_visuals(const SdfElement& link, const Pose& X_BL, Body& body) {
  for (const SdfElement* visual : link.all("visual")) {
    try {
      show(*visual, X_BL, body);
    } catch (const ConfigError&) {
      warnings_.count("dropped ", " <visual> without a shape or with numbers that are none", where(*visual));
    }
    visual->attribute("name");
    // Looks that no picture of ours has.
    for (const char* tag :
         {"material", "cast_shadows", "laser_retro", "transparency", "visibility_flags", "meta"})
      visual->pass_over(tag);
  }
}

void SdfShapes::show(const SdfElement& visual, const Pose& X_BL, Body& body) {
  const SdfElement* shape = shape_of(visual);
  if (shape == nullptr) fail_at(visual, "a shape", "none");
  VisualShape shown;
  shown.X_BG = X_BL * sdf_pose(visual.find("pose"));
  shown.rgba = colour_of(visual);
  CollisionShape simple;
  if (shape->tag == "mesh") {
    show_mesh(*shape, shown);
  } else if (set_simple(*shape, simple)) {
    check_shape(simple, path_, where(visual));
    shown.type = visual_type(simple.type);
    shown.size = simple.size;
  } else {
    warnings_.count("dropped ", " <visual> that are no box, sphere, cylinder, capsule or mesh",
                    where(visual));
    shape->pass_over_all();
    return;
  }
  body.visuals.push_back(std::move(shown));
}

void SdfShapes::show_mesh(const SdfElement& mesh, VisualShape& visual) {
  const SdfElement& uri = sdf_needed(mesh, "uri");
  visual.type = VisualType::kMesh;
  visual.scale = sdf_mesh_scale(mesh);
  const auto file = find_named_file(uri.text, *uri.file);
  const std::string place = fmt::format("{} ('{}')", where(mesh), printable_text(uri.text, 200));
  if (!file) {
    warnings_.count("dropped ", " visual mesh(es) whose file is not there", place);
  } else if (!sdf_submesh(mesh).name.empty()) {
    warnings_.count("dropped ", " visual mesh(es) that are one <submesh> of their file", place);
  } else {
    visual.mesh = *file;
  }
}

}  // namespace crossgait
