#include "study/sdf_ground.h"

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/robot_files/mesh/mesh_path.h"
#include "physics/robot_files/mesh/mesh_vertices.h"
#include "physics/robot_files/sdf/sdf_model.h"
#include "physics/robot_files/sdf/sdf_values.h"
#include "physics/terrain/terrain.h"
#include "study/ground_shapes.h"

namespace crossgait {
namespace {

/// Reads a size above 0 that has to be there.
double length_in(const SdfElement& shape, const char* name) {
  const SdfElement& element = sdf_needed(shape, name);
  const double number = sdf_numbers(element, 1)[0];
  if (!(number > 0)) fail_at(element, "a number above 0", fmt::format("{:g}", number));
  return number;
}

Vector3 lengths_in(const SdfElement& shape, const char* name) {
  Vector3 lengths = sdf_vector(shape, name, Vector3::Ones());
  if (!(lengths.minCoeff() > 0)) fail_at(shape, fmt::format("a {} above 0", name), "another one");
  return lengths;
}

class SdfGround {
 public:
  explicit SdfGround(const std::string& path) : path_(path), document_(path, warnings_), shapes_(path) {
    const auto add_all = [this](const SdfElement& parent) {
      for (const SdfElement* model : parent.all("model")) add_model(*model);
    };
    add_all(document_.root());
    for (const SdfElement* world : document_.root().all("world")) add_all(*world);
  }

  SceneTerrain sample(double cell) { return shapes_.sample(cell, warnings_.sentences()); }

 private:
  std::string where(const SdfElement& element) const { return sdf_place(element, path_); }

  void add_model(const SdfElement& model) {
    if (!sdf_flag(model, "static", false)) {
      warnings_.count("left out ", " <model> that are not <static>", where(model));
      return;
    }
    const SdfElement* pose = model.find("pose");
    if (pose != nullptr) {
      const std::string relative_to = pose->attribute("relative_to");
      if (!relative_to.empty() && relative_to != "world")
        fail_at(*pose, "a pose in the world", fmt::format("one relative to '{}'", relative_to));
    }
    if (!model.attribute("placement_frame").empty())
      fail_at(model, "a pose of the model itself", "a placement_frame");
    const Pose X_WM = sdf_pose(pose);
    for (const SdfLink& link : resolve_model(model).links) {
      for (const SdfElement* collision : link.element->all("collision")) {
        const SdfElement* geometry = collision->find("geometry");
        if (geometry == nullptr || geometry->children.empty()) {
          warnings_.count("left out ", " <collision> without a shape", where(*collision));
          continue;
        }
        add_shape(geometry->children.front(), X_WM * link.X_ML * sdf_pose(collision->find("pose")));
      }
    }
  }

  void add_shape(const SdfElement& shape, const Pose& X_WG) {
    if (shape.tag == "plane") {
      add_plane(shape, X_WG);
    } else if (shape.tag == "box") {
      shapes_.add_box(X_WG, lengths_in(shape, "size") / 2);
    } else if (shape.tag == "sphere") {
      shapes_.add_sphere(X_WG, length_in(shape, "radius"));
    } else if (shape.tag == "cylinder") {
      shapes_.add_cylinder(X_WG, length_in(shape, "radius"), length_in(shape, "length") / 2);
    } else if (shape.tag == "capsule") {
      shapes_.add_capsule(X_WG, length_in(shape, "radius"), length_in(shape, "length") / 2);
    } else if (shape.tag == "mesh") {
      add_mesh(shape, X_WG);
    } else if (shape.tag == "heightmap") {
      add_height_map(shape, X_WG);
    } else {
      warnings_.count("left out ",
                      " collision(s) that are no plane, box, sphere, capsule, cylinder, mesh or height map",
                      where(shape));
    }
  }

  void add_plane(const SdfElement& shape, const Pose& X_WG) {
    const Vector3 normal = sdf_vector(shape, "normal", Vector3::UnitZ());
    if (!(normal.norm() > 1e-6)) fail_at(shape, "a normal of non-zero length", "none");
    const Pose turned = X_WG * Quaternion::FromTwoVectors(Vector3::UnitZ(), normal);
    if (!shapes_.add_plane(turned)) fail_at(shape, "a plane that faces upwards", "another one");
  }

  void add_mesh(const SdfElement& shape, const Pose& X_WG) {
    const SdfElement& uri = sdf_needed(shape, "uri");
    const auto file = is_mesh_format(uri.text) ? find_named_file(uri.text, *uri.file) : std::nullopt;
    if (!file) {
      warnings_.count("left out ", fmt::format(" mesh(es) whose file is not there, or no {}", kMeshFormats),
                      where(shape));
      return;
    }
    const Vector3 scale = sdf_mesh_scale(shape);
    const SdfSubmesh part = sdf_submesh(shape);
    std::vector<Vector3> vertices = read_mesh_vertices(*file, part.name);
    part.place(vertices);
    for (Vector3& v : vertices) v = X_WG * scale.cwiseProduct(v).eval();
    if (!shapes_.add_hull(vertices))
      warnings_.count("took for their convex hull of few corners, off by more than a millimetre, ",
                      " mesh(es)", where(shape));
  }

  void add_height_map(const SdfElement& shape, const Pose& X_WG) {
    const SdfElement& uri = sdf_needed(shape, "uri");
    const auto file = find_named_file(uri.text, *uri.file);
    if (!file) fail_at(uri, "a file that is there", fmt::format("'{}'", printable_text(uri.text, 200)));
    if (!file->ends_with(".png")) fail_at(uri, "a height map as PNG", fmt::format("'{}'", *file));
    const Vector3 size = lengths_in(shape, "size");
    const Terrain picture = make_terrain(fmt::format("{}:size_x=1,size_y=1,z_min=0,z_max=1", *file));
    const HeightField& grey = *picture.field();
    std::vector<float> heights(grey.heights().begin(), grey.heights().end());
    const float lightest = std::ranges::max(heights);
    for (float& h : heights) h = lightest > 0 ? static_cast<float>(size.z()) * h / lightest : 0;
    Pose X_WF = X_WG;
    X_WF.translation() += X_WG.linear() * sdf_vector(shape, "pos", Vector3::Zero());
    GroundField field{HeightField(grey.columns(), grey.rows(), size.x(), size.y(), std::move(heights), *file),
                      std::numeric_limits<double>::infinity()};
    if (!shapes_.add_field(std::move(field), X_WF))
      fail_at(shape, "a height map that lies level", "a tilted one");
  }

  const std::string path_;
  ReaderWarnings warnings_;
  SdfDocument document_;
  GroundShapes shapes_;
};

}  // namespace

SceneTerrain read_sdf_ground(const std::string& path, double cell) { return SdfGround(path).sample(cell); }

}  // namespace crossgait
