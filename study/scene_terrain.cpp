#include "study/scene_terrain.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/core/math.h"
#include "physics/core/text.h"
#include "physics/robot_files/mesh/ellipsoid.h"
#include "physics/robot_files/mesh/mesh_vertices.h"
#include "physics/robot_files/mjcf/mjcf_compile.h"
#include "physics/robot_files/mjcf/mjcf_defaults.h"
#include "physics/robot_files/mjcf/mjcf_frames.h"
#include "physics/robot_files/robot_formats.h"
#include "physics/terrain/terrain.h"
#include "study/ground_shapes.h"
#include "study/sdf_ground.h"

namespace crossgait {
namespace {

constexpr int kLeastSamples = 2, kMostSamples = 4096;  // of a row or a column of a height field

/// Reads MuJoCo's own format: rows, columns (int32), and as many floats, the row of the smallest y first, as
/// machines of this byte order write them (MuJoCo, XML reference, "asset/hfield/file").
std::vector<float> read_binary_field(const std::string& file, int& columns, int& rows) {
  const std::string bytes = read_text_file(file, kTerrainTableBudget);
  std::array<std::int32_t, 2> counts{};
  const auto fail = [&file](std::string_view element, const std::string& expected, const std::string& found) {
    throw ConfigError(file, element, expected, found);
  };
  if (bytes.size() < sizeof counts)
    fail("file", "a height field of MuJoCo's: rows, columns, floats", fmt::format("{} bytes", bytes.size()));
  std::memcpy(counts.data(), bytes.data(), sizeof counts);
  for (const std::int32_t count : counts)
    if (count < kLeastSamples || count > kMostSamples)
      fail("rows and columns", fmt::format("{} to {} of each", kLeastSamples, kMostSamples),
           fmt::format("{} x {}", counts[0], counts[1]));
  rows = counts[0], columns = counts[1];
  std::vector<float> heights(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  const std::size_t expected = sizeof counts + heights.size() * sizeof(float);
  if (bytes.size() != expected)
    fail("file", fmt::format("{} bytes for {} x {} floats", expected, rows, columns),
         fmt::format("{}", bytes.size()));
  std::memcpy(heights.data(), bytes.data() + sizeof counts, heights.size() * sizeof(float));
  if (!std::ranges::all_of(heights, [](float h) { return std::isfinite(h); }))
    fail("heights", "finite numbers", "one that is not");
  return heights;
}

class Scene {
 public:
  explicit Scene(const std::string& path)
      : document_(path), defaults_(document_.root()), path_(path), shapes_(path) {
    write_out_frames(document_, defaults_);
    prepare();
    ReaderWarnings of_robot;  // what is said of robots' files
    MjcfParts parts = take_parts(document_, of_robot);
    const MjcfModel model = compile_parts(document_, defaults_, parts, of_robot);
    add_shapes(model, parts);
  }

  SceneTerrain sample(double cell) { return shapes_.sample(cell, warnings_.sentences()); }

 private:
  /// Leaves in the document what a ground is made of. Geoms of the world go to a body of their own, planes
  /// and height fields become planes: a compiler says where they are.
  void prepare() {
    MjcfElement& root = document_.root();
    for (const MjcfElement& section : root.children) {
      if (section.tag == "compiler" && section.has("meshdir")) folder_ = section.attribute("meshdir");
      if (section.tag != "asset") continue;
      for (const MjcfElement& asset : section.children)
        if (asset.tag == "hfield") fields_.emplace(std::string(asset.attribute("name")), asset);
    }
    static const std::set<std::string_view> kKept{"compiler", "default", "asset", "worldbody"};
    std::erase_if(root.children, [](const MjcfElement& e) { return !kKept.contains(e.tag); });
    for (MjcfElement& world : root.children) {
      if (world.tag != "worldbody") continue;
      for_each_with_class(world, "", [this](MjcfElement& geom, const std::string& class_name) {
        if (geom.tag == "geom") prepare_geom(geom, class_name);
      });
      MjcfElement ground = world;
      ground.tag = "body";
      std::erase_if(ground.children, [](const MjcfElement& e) { return e.tag != "geom"; });
      std::erase_if(world.children, [](const MjcfElement& e) { return e.tag == "geom"; });
      world.children.push_back(std::move(ground));
    }
  }

  void prepare_geom(MjcfElement& geom, const std::string& class_name) {
    const auto says = [&](const char* attribute) -> std::string {
      const MjcfElement* element = defaults_.find(geom, class_name, attribute);
      return element == nullptr ? "" : std::string(element->attribute(attribute));
    };
    const std::string field = says("hfield");
    if (says("type") != "plane" && field.empty()) return;
    if (geom.attribute("name").empty()) geom.set("name", fmt::format("crossgait ground {}", grounds_.size()));
    geom.remove("hfield");
    geom.set("type", "plane");
    geom.set("size", "1 1 1");
    grounds_.emplace(std::string(geom.attribute("name")), field);
  }

  /// Poses of the bodies that nothing moves; the others are left out.
  std::map<int, Pose> fixed_bodies(const MjcfModel& model) {
    std::set<int> moving;  // with all on whose way to the world there is a joint, or from which one hangs
    for (const MjcfJoint& joint : model.joints) {
      for (int at = joint.body; at > 0; at = model.bodies[static_cast<std::size_t>(at)].parent)
        moving.insert(at);
    }
    std::map<int, Pose> fixed{{0, Pose::Identity()}};
    for (std::size_t i = 1; i < model.bodies.size(); ++i) {
      const MjcfBody& body = model.bodies[i];
      const auto parent = fixed.find(body.parent);
      if (parent == fixed.end() || moving.contains(static_cast<int>(i))) continue;
      if (body.mocap) {
        warnings_.count("left out ", " body or bodies that mocap moves", fmt::format("body '{}'", body.name));
        continue;
      }
      fixed.emplace(static_cast<int>(i), parent->second * body.X_PB);
    }
    return fixed;
  }

  void add_shapes(const MjcfModel& model, const MjcfParts& parts) {
    const std::map<int, Pose> fixed = fixed_bodies(model);
    for (const MjcfGeom& geom : model.geoms) {
      const auto body = fixed.find(geom.body);
      if (body == fixed.end() || !geom.collides) continue;
      const Pose X_WG = body->second * geom.X_BG;
      const MjcfElement& element = parts.element("geom", geom.name);
      const auto ground = grounds_.find(geom.name);
      if (ground != grounds_.end() && ground->second.empty()) {
        add_plane(element, X_WG);
      } else if (ground != grounds_.end()) {
        add_field(element, ground->second, X_WG);
      } else if (geom.type == MjcfGeomType::kMesh) {
        add_mesh(element, geom, parts.meshes.at(geom.mesh), X_WG);
      } else {
        add_solid(element, geom, X_WG);
      }
    }
  }

  void add_plane(const MjcfElement& element, const Pose& X_WG) {
    if (!shapes_.add_plane(X_WG)) fail_at(element, "a plane that faces upwards", "another one");
  }

  void add_solid(const MjcfElement& element, const MjcfGeom& geom, const Pose& X_WG) {
    const Vector3 size = geom.size;
    switch (geom.type) {
      case MjcfGeomType::kSphere:
        return shapes_.add_sphere(X_WG, size[0]);
      case MjcfGeomType::kCylinder:
        return shapes_.add_cylinder(X_WG, size[0], size[1]);
      case MjcfGeomType::kCapsule:
        return shapes_.add_capsule(X_WG, size[0], size[1]);
      case MjcfGeomType::kBox:
        return shapes_.add_box(X_WG, size);
      case MjcfGeomType::kEllipsoid:
        return add_hull(element, ellipsoid_vertices(size), X_WG);
      case MjcfGeomType::kMesh:
      case MjcfGeomType::kOther:
        warnings_.count(
            "left out ",
            " geom(s) that are no plane, box, sphere, ellipsoid, capsule, cylinder, mesh or height field",
            mjcf_place(element, path_));
    }
  }

  void add_mesh(const MjcfElement& element, const MjcfGeom& geom, const MjcfMesh& mesh, const Pose& X_WG) {
    std::vector<Vector3> vertices = geom.vertices;
    if (!mesh.written.empty()) {
      if (mesh.file.empty() || !is_mesh_format(mesh.file)) {
        warnings_.count("left out ", fmt::format(" mesh(es) whose file is not there, or no {}", kMeshFormats),
                        mjcf_place(element, path_));
        return;
      }
      vertices = read_mesh_vertices(mesh.file);
      for (Vector3& v : vertices) v = mesh.scale.cwiseProduct(mesh.R_ref.transpose() * (v - mesh.p_ref));
    }
    add_hull(element, std::move(vertices), X_WG);
  }

  void add_hull(const MjcfElement& element, std::vector<Vector3> vertices, const Pose& X_WG) {
    for (Vector3& v : vertices) v = X_WG * v;
    if (!shapes_.add_hull(vertices))
      warnings_.count("took for their convex hull of few corners, off by more than a millimetre, ",
                      " mesh(es) or ellipsoid(s)", mjcf_place(element, path_));
  }

  void add_field(const MjcfElement& element, const std::string& name, const Pose& X_WG) {
    const auto asset = fields_.find(name);
    if (asset == fields_.end())
      fail_at(element, "a height field of <asset>", fmt::format("'{}'", printable_text(name, 200)));
    if (!shapes_.add_field(read_field(asset->second), X_WG))
      fail_at(element, "a height field that lies level", "a tilted one");
  }

  /// Elevations, from 0 to 1 of the asset's size, at most.
  GroundField read_field(const MjcfElement& asset) const {
    const std::vector<double> size = mjcf_numbers(asset, "size", 4, 4);
    if (*std::ranges::min_element(size) <= 0) fail_at(asset, "four sizes above 0", "another one");
    int columns = 0, rows = 0;
    std::vector<float> heights;
    if (asset.has("file")) {
      const std::string file =
          (std::filesystem::path(path_).parent_path() / folder_ / asset.attribute("file")).lexically_normal();
      const std::string_view type = asset.attribute("content_type");
      if (type == "image/png" || (type.empty() && file.ends_with(".png"))) {
        const Terrain picture = make_terrain(fmt::format("{}:size_x=1,size_y=1,z_min=0,z_max=1", file));
        columns = picture.field()->columns(), rows = picture.field()->rows();
        heights.assign(picture.field()->heights().begin(), picture.field()->heights().end());
      } else {
        heights = read_binary_field(file, columns, rows);
      }
    } else {
      columns = whole(asset, "ncol"), rows = whole(asset, "nrow");
      const std::size_t count = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
      heights.assign(count, 0);
      if (asset.has("elevation")) {
        const std::vector<double> numbers = mjcf_numbers(asset, "elevation", count, count);
        for (int r = 0; r < rows; ++r) {  // the first row has the largest y
          for (int c = 0; c < columns; ++c)
            heights[static_cast<std::size_t>((rows - 1 - r) * columns + c)] =
                static_cast<float>(numbers[static_cast<std::size_t>(r * columns + c)]);
        }
      }
    }
    const auto [low, high] = std::ranges::minmax(heights);
    const float least = low, range = high - low;
    for (float& h : heights) h = range > 0 ? static_cast<float>(size[2]) * (h - least) / range : 0;
    return {HeightField(columns, rows, 2 * size[0], 2 * size[1], std::move(heights), path_), size[3]};
  }

  static int whole(const MjcfElement& asset, const char* name) {
    const double number = mjcf_numbers(asset, name, 1, 1)[0];
    if (number != std::floor(number) || number < kLeastSamples || number > kMostSamples)
      fail_at(asset, fmt::format("a whole number from {} to {} for {}", kLeastSamples, kMostSamples, name),
              fmt::format("{:g}", number));
    return static_cast<int>(number);
  }

  MjcfDocument document_;
  MjcfDefaults defaults_;
  const std::string path_;
  std::string folder_;                          ///< of meshes and height fields
  std::map<std::string, MjcfElement> fields_;   ///< assets, by name
  std::map<std::string, std::string> grounds_;  ///< planes, and geoms that are height fields: which, by geom
  GroundShapes shapes_;
  ReaderWarnings warnings_;
};

}  // namespace

SceneTerrain read_scene_terrain(const std::string& path, double cell) {
  const RobotFormat* const format = robot_format_of(path);
  return format != nullptr && format->key == "sdf" ? read_sdf_ground(path, cell) : Scene(path).sample(cell);
}

}  // namespace crossgait
