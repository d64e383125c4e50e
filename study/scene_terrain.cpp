#include "study/scene_terrain.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/core/math.h"
#include "physics/robot_files/mesh/convex_hull.h"
#include "physics/robot_files/mesh/mesh_vertices.h"
#include "physics/robot_files/mjcf/mjcf_compile.h"
#include "physics/robot_files/mjcf/mjcf_defaults.h"
#include "physics/terrain/terrain.h"

namespace crossgait {
namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();
constexpr double kOnBorder = 1e-9;     // m: what stands on a border is on it
constexpr double kSmallestGap = 1e-3;  // m: parts that are nearer are one

/// Heights between which a vertical line is inside a solid, m.
struct HeightRange {
  double bottom = -kUnbounded, top = kUnbounded;
};
using MaybeHeights = std::optional<HeightRange>;

/// One shape: its extent in x and y, and the line through it over a point.
struct Solid {
  double x_min, x_max, y_min, y_max;
  std::function<MaybeHeights(double x, double y)> over;
};

MaybeHeights common_part(const MaybeHeights& a, const MaybeHeights& b) {
  if (!a || !b) return std::nullopt;
  const HeightRange common{std::max(a->bottom, b->bottom), std::min(a->top, b->top)};
  return common.bottom <= common.top ? MaybeHeights(common) : std::nullopt;
}

MaybeHeights joined(const MaybeHeights& a, const MaybeHeights& b) {
  if (!a || !b) return a ? a : b;
  return HeightRange{std::min(a->bottom, b->bottom), std::max(a->top, b->top)};
}

/// Where a s^2 + 2 b s + c <= 0.
MaybeHeights below_zero(double a, double b, double c) {
  if (std::abs(a) < kOnBorder) return c <= kOnBorder ? MaybeHeights(HeightRange()) : std::nullopt;
  const double root = b * b - a * c;
  if (root < 0) return std::nullopt;
  return HeightRange{(-b - std::sqrt(root)) / a, (-b + std::sqrt(root)) / a};
}

/// Where |p + s d| <= h.
MaybeHeights within(double p, double d, double h) {
  if (std::abs(d) < kOnBorder)
    return std::abs(p) <= h + kOnBorder ? MaybeHeights(HeightRange()) : std::nullopt;
  const double s = (-h - p) / d, t = (h - p) / d;
  return HeightRange{std::min(s, t), std::max(s, t)};
}

/// The vertical line over a point, in the frame of a shape: p + s d is at the world's z = s.
struct Line {
  Vector3 p, d;
  Line(const Pose& X_WG, double x, double y)
      : p(X_WG.linear().transpose() * (Vector3(x, y, 0) - X_WG.translation())),
        d(X_WG.linear().transpose() * Vector3::UnitZ()) {}
};

MaybeHeights through_sphere(const Line& line, double radius, double z) {
  const Vector3 p = line.p - Vector3(0, 0, z);
  return below_zero(1, p.dot(line.d), p.squaredNorm() - radius * radius);
}

MaybeHeights through_cylinder(const Line& line, double radius, double half_length) {
  const double a = line.d.head<2>().squaredNorm(), b = line.p.head<2>().dot(line.d.head<2>());
  return common_part(below_zero(a, b, line.p.head<2>().squaredNorm() - radius * radius),
                     within(line.p.z(), line.d.z(), half_length));
}

MaybeHeights through_box(const Line& line, const Vector3& half) {
  MaybeHeights inside = HeightRange();
  for (int i = 0; i < 3; ++i) inside = common_part(inside, within(line.p[i], line.d[i], half[i]));
  return inside;
}

/// A face of a hull: what is inside has n . p <= d.
struct HalfSpace {
  Vector3 n;
  double d;
};

/// Every plane through three corners that has all others on one side: for as few corners as kMeshCorners.
std::vector<HalfSpace> faces_of(const std::vector<Vector3>& corners) {
  std::vector<HalfSpace> faces;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    for (std::size_t j = i + 1; j < corners.size(); ++j) {
      for (std::size_t k = j + 1; k < corners.size(); ++k) {
        const Vector3 n = (corners[j] - corners[i]).cross(corners[k] - corners[i]);
        if (n.norm() < kOnBorder * kOnBorder) continue;
        for (const double sign : {1.0, -1.0}) {
          const HalfSpace face{sign * n.normalized(), sign * n.normalized().dot(corners[i])};
          if (std::ranges::all_of(corners,
                                  [&](const Vector3& p) { return face.n.dot(p) <= face.d + kOnBorder; }))
            faces.push_back(face);
        }
      }
    }
  }
  return faces;
}

/// In the world's frame.
MaybeHeights through_hull(const std::vector<HalfSpace>& faces, double x, double y) {
  HeightRange inside;
  for (const HalfSpace& face : faces) {
    const double rest = face.d - face.n.x() * x - face.n.y() * y;
    if (std::abs(face.n.z()) < kOnBorder) {
      if (rest < -kOnBorder) return std::nullopt;
    } else if (face.n.z() > 0) {
      inside.top = std::min(inside.top, rest / face.n.z());
    } else {
      inside.bottom = std::max(inside.bottom, rest / face.n.z());
    }
  }
  return inside.bottom <= inside.top + kOnBorder ? MaybeHeights(inside) : std::nullopt;
}

/// A height field of the file's assets, around its own origin; `base` is how thick it is below its lowest.
struct FileField {
  HeightField field;
  double base;
};

class Scene {
 public:
  explicit Scene(const std::string& path) : document_(path), defaults_(document_.root()), path_(path) {
    prepare();
    ReaderWarnings of_robot;  // what is said of robots' files
    MjcfParts parts = take_parts(document_, of_robot);
    const MjcfModel model = compile_parts(document_, parts, of_robot);
    add_shapes(model, parts);
  }

  SceneTerrain sample(double cell) {
    double x = 0, y = 0;
    for (const Solid& solid : solids_) {
      x = std::max({x, std::abs(solid.x_min), std::abs(solid.x_max)});
      y = std::max({y, std::abs(solid.y_min), std::abs(solid.y_max)});
    }
    if (solids_.empty())
      throw ConfigError(path_, "worldbody", "shapes that are fixed to the world, beside a plane", "none");
    const double half_columns = std::max(1.0, std::ceil(x / cell - kOnBorder)),
                 half_rows = std::max(1.0, std::ceil(y / cell - kOnBorder));
    if ((2 * half_columns + 1) * (2 * half_rows + 1) > static_cast<double>(kMaxHeightSamples))
      throw ConfigError(path_, "cell", fmt::format("at most {} samples, so larger cells", kMaxHeightSamples),
                        fmt::format("cells of {:g} m over {:g} x {:g} m", cell, 2 * x, 2 * y));
    const int columns = 2 * static_cast<int>(half_columns) + 1, rows = 2 * static_cast<int>(half_rows) + 1;
    std::vector<float> heights;
    heights.reserve(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
    for (int r = 0; r < rows; ++r) sample_row((r - half_rows) * cell, cell, columns, heights);
    return finish(columns, rows, cell, std::move(heights));
  }

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
    const Vector3 n = X_WG.linear().col(2);
    if (n.z() < kOnBorder) fail_at(element, "a plane that faces upwards", "another one");
    const double d = n.dot(X_WG.translation());
    planes_.push_back({n, d});
  }

  void add_solid(const MjcfElement& element, const MjcfGeom& geom, const Pose& X_WG) {
    const Vector3 size = geom.size;
    Vector3 half = size;  // of a box around it, in its frame
    std::function<MaybeHeights(double, double)> over;
    switch (geom.type) {
      case MjcfGeomType::kSphere:
        half = Vector3::Constant(size[0]);
        over = [=](double x, double y) { return through_sphere(Line(X_WG, x, y), size[0], 0); };
        break;
      case MjcfGeomType::kCylinder:
        half = {size[0], size[0], size[1]};
        over = [=](double x, double y) { return through_cylinder(Line(X_WG, x, y), size[0], size[1]); };
        break;
      case MjcfGeomType::kCapsule:
        half = {size[0], size[0], size[0] + size[1]};
        over = [=](double x, double y) {
          const Line line(X_WG, x, y);
          return joined(
              through_cylinder(line, size[0], size[1]),
              joined(through_sphere(line, size[0], size[1]), through_sphere(line, size[0], -size[1])));
        };
        break;
      case MjcfGeomType::kBox:
        over = [=](double x, double y) { return through_box(Line(X_WG, x, y), size); };
        break;
      case MjcfGeomType::kMesh:
      case MjcfGeomType::kOther:
        warnings_.count("left out ",
                        " geom(s) that are no plane, box, sphere, capsule, cylinder, mesh or height field",
                        mjcf_place(element, path_));
        return;
    }
    const Vector3 reach = X_WG.linear().cwiseAbs() * half, centre = X_WG.translation();
    solids_.push_back({centre.x() - reach.x(), centre.x() + reach.x(), centre.y() - reach.y(),
                       centre.y() + reach.y(), std::move(over)});
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
    for (Vector3& v : vertices) v = X_WG * v;
    const ConvexHull hull = convex_hull(vertices, kMeshCorners);
    if (hull.error > kSmallestGap)
      warnings_.count("took for their convex hull of few corners, off by more than a millimetre, ",
                      " mesh(es)", mjcf_place(element, path_));
    Vector3 low = hull.vertices.front(), high = low;
    for (const Vector3& v : hull.vertices) low = low.cwiseMin(v), high = high.cwiseMax(v);
    solids_.push_back(
        {low.x(), high.x(), low.y(), high.y(),
         [faces = faces_of(hull.vertices)](double x, double y) { return through_hull(faces, x, y); }});
  }

  void add_field(const MjcfElement& element, const std::string& name, const Pose& X_WG) {
    const auto asset = fields_.find(name);
    if (asset == fields_.end())
      fail_at(element, "a height field of <asset>", fmt::format("'{}'", printable_text(name, 200)));
    if (X_WG.linear()(2, 2) < 1 - kOnBorder)
      fail_at(element, "a height field that lies level", "a tilted one");
    auto field = std::make_shared<const FileField>(read_field(asset->second));
    const double x = field->field.size_x() / 2, y = field->field.size_y() / 2;
    const Vector3 reach = X_WG.linear().cwiseAbs() * Vector3(x, y, 0), centre = X_WG.translation();
    solids_.push_back(
        {centre.x() - reach.x(), centre.x() + reach.x(), centre.y() - reach.y(), centre.y() + reach.y(),
         [=](double px, double py) -> MaybeHeights {
           // On the border is on it, whatever turning it there rounded to.
           Vector3 p = X_WG.linear().transpose() * (Vector3(px, py, 0) - centre);
           if (std::abs(p.x()) > x + kOnBorder || std::abs(p.y()) > y + kOnBorder) return std::nullopt;
           return HeightRange{centre.z() - field->base, centre.z() + field->field.height(p.x(), p.y())};
         }});
  }

  /// Elevations, from 0 to 1 of the asset's size, at most.
  FileField read_field(const MjcfElement& asset) const {
    const std::vector<double> size = mjcf_numbers(asset, "size", 4, 4);
    if (*std::ranges::min_element(size) <= 0) fail_at(asset, "four sizes above 0", "another one");
    int columns = 0, rows = 0;
    std::vector<float> heights;
    if (asset.has("file")) {
      const std::string file =
          (std::filesystem::path(path_).parent_path() / folder_ / asset.attribute("file")).lexically_normal();
      if (!file.ends_with(".png"))
        fail_at(asset, "a height field as PNG or elevations", fmt::format("'{}'", file));
      const Terrain picture = make_terrain(fmt::format("{}:size_x=1,size_y=1,z_min=0,z_max=1", file));
      columns = picture.field()->columns(), rows = picture.field()->rows();
      heights.assign(picture.field()->heights().begin(), picture.field()->heights().end());
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
    if (number != std::floor(number) || number < 2 || number > 4096)
      fail_at(asset, fmt::format("a whole number from 2 to 4096 for {}", name), fmt::format("{:g}", number));
    return static_cast<int>(number);
  }

  void sample_row(double y, double cell, int columns, std::vector<float>& heights) {
    std::vector<std::vector<HeightRange>> over(static_cast<std::size_t>(columns));
    const double first = -0.5 * (columns - 1) * cell;
    for (const Solid& solid : solids_) {
      if (y < solid.y_min - kOnBorder || y > solid.y_max + kOnBorder) continue;
      const int from = std::max(0, static_cast<int>(std::floor((solid.x_min - first) / cell)));
      const int to = std::min(columns - 1, static_cast<int>(std::ceil((solid.x_max - first) / cell)));
      for (int c = from; c <= to; ++c)
        if (const auto heights_here = solid.over(first + c * cell, y))
          over[static_cast<std::size_t>(c)].push_back(*heights_here);
    }
    for (int c = 0; c < columns; ++c) {
      std::vector<HeightRange>& here = over[static_cast<std::size_t>(c)];
      for (const HalfSpace& plane : planes_)
        here.push_back(
            {-kUnbounded, (plane.d - plane.n.x() * (first + c * cell) - plane.n.y() * y) / plane.n.z()});
      heights.push_back(height_of(here));
    }
  }

  /// The top of what is there, NaN where there is nothing; counts a gap below it.
  float height_of(std::vector<HeightRange>& here) {
    if (here.empty()) return std::numeric_limits<float>::quiet_NaN();
    std::ranges::sort(here, std::ranges::greater{}, &HeightRange::top);
    double bottom = here.front().bottom;
    for (const HeightRange& next : here) {
      if (next.top < bottom - kSmallestGap) {
        ++overhangs_;
        break;
      }
      bottom = std::min(bottom, next.bottom);
    }
    return static_cast<float>(here.front().top);
  }

  SceneTerrain finish(int columns, int rows, double cell, std::vector<float> heights) {
    float lowest = std::numeric_limits<float>::infinity();
    std::size_t empty = 0;
    for (const float h : heights) {
      if (std::isnan(h)) {
        ++empty;
      } else {
        lowest = std::min(lowest, h);
      }
    }
    for (float& h : heights) h = std::isnan(h) ? lowest : h;
    const auto count = static_cast<double>(heights.size());
    SceneTerrain scene;
    scene.overhang_ratio = static_cast<double>(overhangs_) / count;
    scene.warnings = warnings_.sentences();
    if (empty > 0)
      scene.warnings.push_back(
          fmt::format("{:.3g} % of the samples have nothing below them: they are as high as the lowest of "
                      "the others, {:g} m",
                      100 * static_cast<double>(empty) / count, lowest));
    if (overhangs_ > 0)
      scene.warnings.push_back(
          fmt::format("{:.3g} % of the samples overhang: there is air below the surface, and ground again "
                      "further down; a height field is filled there",
                      100 * scene.overhang_ratio));
    scene.field = std::make_shared<const HeightField>(columns, rows, (columns - 1) * cell, (rows - 1) * cell,
                                                      std::move(heights), path_);
    return scene;
  }

  MjcfDocument document_;
  MjcfDefaults defaults_;
  const std::string path_;
  std::string folder_;                          ///< of meshes and height fields
  std::map<std::string, MjcfElement> fields_;   ///< assets, by name
  std::map<std::string, std::string> grounds_;  ///< planes, and geoms that are height fields: which, by geom
  std::vector<HalfSpace> planes_;
  std::vector<Solid> solids_;
  std::size_t overhangs_ = 0;
  ReaderWarnings warnings_;
};

}  // namespace

SceneTerrain read_scene_terrain(const std::string& path, double cell) { return Scene(path).sample(cell); }

}  // namespace crossgait
