#include "report/scene.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "ik/leg_kinematics.h"
#include "physics/core/error.h"
#include "physics/core/files_read.h"
#include "physics/core/read_budget.h"
#include "physics/robot/principal_inertia.h"
#include "physics/robot_files/mesh/mesh_vertices.h"
#include "report/mesh_detail.h"

namespace crossgait {
namespace {

using nlohmann::ordered_json;

/// Radius of a stick that stands in for a link, standing heights.
constexpr double kStick = 0.04;

/// Smallest part of a mesh that is shown, standing heights: a third of a pixel of a picture of the robot. A
/// tenth or less of the triangles of robots that come from CAD remains.
constexpr double kMeshDetail = 0.01;

/// Most samples of the ground in one page, 2 MB of them; more are thinned.
constexpr int kMaxGroundSamples = 400'000;

ordered_json list(const Vector3& v) { return {v.x(), v.y(), v.z()}; }

ordered_json placed(std::string_view type, const Vector3& size, const Pose& X_BG) {
  const Quaternion q(X_BG.linear());
  return {{"type", type},
          {"size", list(size)},
          {"position", list(X_BG.translation())},
          {"quaternion", {q.x(), q.y(), q.z(), q.w()}},
          {"rgba", nullptr}};
}

/// The box of even density that has such a mass and such moments, about its principal axes: of half sides a,
/// b, c the first moment is m (b^2 + c^2) / 3.
ordered_json inertia_box(const SpatialInertia& inertia) {
  const PrincipalInertia principal = principal_inertia(inertia);
  const Vector3& I = principal.moments;
  const Vector3 squares = 1.5 * (Vector3::Constant(I.sum()) - 2 * I) / inertia.mass;
  return placed("box", squares.cwiseMax(0).cwiseSqrt(), principal.X_BP);
}

std::vector<double> coordinates(const std::vector<Vector3>& points) {
  std::vector<double> numbers;
  numbers.reserve(3 * points.size());
  for (const Vector3& p : points) numbers.insert(numbers.end(), p.data(), p.data() + 3);
  return numbers;
}

/// The shapes of all bodies. A mesh that several shapes show is there once.
class Shapes {
 public:
  /// @param detail  of meshes, m; 0: all of it
  Shapes(PageNumbers& numbers, ordered_json& notes, double detail)
      : numbers_(numbers), notes_(notes), detail_(detail) {}

  ordered_json of(const Body& body) {
    ordered_json shapes = ordered_json::array();
    bool dropped = false;
    for (const VisualShape& visual : body.visuals) {
      const bool is_mesh = visual.type == VisualType::kMesh;
      const std::optional<std::size_t> index =
          is_mesh ? index_of(visual.mesh, detail_ / visual.scale.cwiseAbs().maxCoeff()) : std::nullopt;
      if (is_mesh && !index) {
        note_missing(visual.mesh, body);
        dropped = true;
        continue;
      }
      ordered_json shape = placed(name(visual.type), visual.size, visual.X_BG);
      if (visual.rgba)
        shape["rgba"] = {(*visual.rgba)[0], (*visual.rgba)[1], (*visual.rgba)[2], (*visual.rgba)[3]};
      if (is_mesh) {
        shape["mesh"] = *index;
        shape["scale"] = list(visual.scale);
      }
      shapes.push_back(std::move(shape));
      show_visuals_ = true;
    }
    if (!shapes.empty() && !dropped) return shapes;
    for (ordered_json& shape : collision(body)) shapes.push_back(std::move(shape));
    return shapes;
  }
  ordered_json collision(const Body& body) {
    ordered_json shapes = ordered_json::array();
    for (const CollisionShape& collision : body.shapes) {
      ordered_json shape = placed(name(collision.type), collision.size, collision.X_BG);
      if (collision.type == ShapeType::kHull)
        shape["vertices"] = numbers_.add(coordinates(collision.vertices));
      shapes.push_back(std::move(shape));
    }
    return shapes;
  }
  /// Tells whether any body so far shows what it looks like, and not what collides.
  bool show_visuals() const { return show_visuals_; }
  ordered_json meshes() {
    if (coarse_) {
      notes_.push_back(fmt::format(
          "of meshes with many triangles, what is smaller than {:.2g} mm is not shown", 1e3 * detail_));
    }
    return std::move(meshes_);
  }

  /// Draws the links of a body that has no shape as sticks: from its origin to where the next bodies hang,
  /// and to its foot.
  ordered_json sticks(const RobotDescription& robot, std::size_t body) {
    std::vector<Vector3> ends;
    for (const Body& other : robot.bodies) {
      if (other.parent == static_cast<int>(body)) ends.emplace_back(other.X_PB.translation());
    }
    if (robot.legs) {
      for (const Leg leg : kLegs) {
        const LegModel& model = (*robot.legs)[leg];
        if (model.foot_body == static_cast<int>(body)) ends.push_back(model.p_BF);
      }
    }
    const double radius = kStick * (robot.standing_height > 0 ? robot.standing_height : 0.2);
    ordered_json shapes = ordered_json::array();
    for (const Vector3& end : ends) {
      const double length = end.norm();
      if (length <= radius) continue;
      Pose X_BG = Pose::Identity();
      X_BG.translation() = 0.5 * end;
      X_BG.linear() = Quaternion::FromTwoVectors(Vector3::UnitZ(), end).toRotationMatrix();
      shapes.push_back(placed("capsule", Vector3(radius, 0.5 * length, 0), X_BG));
    }
    return shapes;
  }

 private:
  /// Notes what stands in for a mesh that cannot be shown.
  void note_missing(const std::string& mesh, const Body& body) {
    const std::string what = mesh.empty() ? fmt::format("a mesh of {} is not there", body.name)
                                          : fmt::format("{} of {} is no {} mesh that can be read{}",
                                                        std::filesystem::path(mesh).filename().string(),
                                                        body.name, kMeshFormats, problems_[mesh]);
    std::string note = fmt::format("{}: {}", what,
                                   body.shapes.empty() ? "it is not shown, and there is no collision shape"
                                                       : "collision shapes stand in for it");
    if (std::find(notes_.begin(), notes_.end(), note) == notes_.end()) notes_.push_back(std::move(note));
  }

  /// Reads a mesh once; nothing if it cannot be read, for looks make no robot unfit (`problems_` says why).
  std::optional<TriangleMesh> read(const std::string& file) {
    const FilesRead apart(FilesRead::Scope::kApart);  // what a robot looks like makes no result
    if (!is_mesh_format(file)) return std::nullopt;
    try {
      return read_mesh_triangles(file);
    } catch (const ConfigError& error) {
      problems_[file] =
          fmt::format(" ({}: expected {}, found {})", error.element(), error.expected(), error.found());
      return std::nullopt;
    }
  }

  /// The place of a file's mesh among all, or nothing if it cannot be read.
  /// @param cell  what is smaller is not shown, in the units of the mesh
  std::optional<std::size_t> index_of(const std::string& file, double cell) {
    const auto [it, is_new] = known_.try_emplace({file, cell});
    if (is_new) {
      const std::optional<TriangleMesh> found = read(file);
      if (!found) return std::nullopt;
      const TriangleMesh& mesh = *found;
      it->second = meshes_.size();
      vertices_ += mesh.vertices.size();
      triangles_ += mesh.triangles.size() / 3;
      if (triangles_ > kMeshBudget.values) {
        throw ConfigError(file, "file",
                          fmt::format("at most {} triangles in all meshes of a robot", kMeshBudget.values),
                          "more");
      }
      if (vertices_ > kMaxRobotMeshVertices) {
        throw ConfigError(file, "file",
                          fmt::format("at most {} vertices in all meshes of a robot", kMaxRobotMeshVertices),
                          "more");
      }
      TriangleMesh shown = mesh;
      if (mesh.triangles.size() / 3 > kFineTriangles && cell > 0 && std::isfinite(cell)) {
        TriangleMesh coarse = coarser(mesh, cell);
        // What is smaller than a cube as a whole stays as it is.
        if (!coarse.triangles.empty()) shown = std::move(coarse);
        coarse_ = true;
      }
      meshes_.push_back({{"vertices", numbers_.add(coordinates(shown.vertices))},
                         {"triangles", numbers_.add(std::span<const std::uint32_t>(shown.triangles))}});
    }
    return it->second;
  }

  PageNumbers& numbers_;
  ordered_json& notes_;
  ordered_json meshes_ = ordered_json::array();
  double detail_;
  std::map<std::pair<std::string, double>, std::optional<std::size_t>> known_;
  std::map<std::string, std::string> problems_;
  bool coarse_ = false, show_visuals_ = false;
  std::size_t vertices_ = 0, triangles_ = 0;
};

/// Of the leg's frame in the base, or null: a robot whose legs no kinematics fit is shown all the same.
ordered_json origin_of(const RobotDescription& robot, Leg leg) {
  try {
    return list(make_leg_kinematics(robot, leg).origin());
  } catch (const ConfigError&) {
    return nullptr;
  }
}

ordered_json legs_of(const RobotDescription& robot) {
  ordered_json legs = ordered_json::array();
  if (!robot.legs) return legs;
  for (const Leg leg : kLegs) {
    const LegModel& model = (*robot.legs)[leg];
    legs.push_back({{"name", name(leg)},
                    {"body", model.foot_body},
                    {"foot", list(model.p_BF)},
                    {"radius", model.foot_radius},
                    {"origin", origin_of(robot, leg)}});
  }
  return legs;
}

/// First and last sample of a row (or column) of the field within `reach` of the path, at least two.
std::pair<int, int> near_path(double cell, int count, double from, double to) {
  const double middle = cell * (count - 1) / 2;
  // Clamped before they are whole numbers: a trace may say that the base was anywhere.
  const double first = std::clamp(std::floor((from + middle) / cell), 0.0, count - 2.0);
  const double last = std::clamp(std::ceil((to + middle) / cell), first + 1, count - 1.0);
  return {static_cast<int>(first), static_cast<int>(last)};
}

ordered_json ground_of(const HeightField& field, const PathBounds& path, double reach, PageNumbers& numbers,
                       ordered_json& notes) {
  const auto [c0, c1] = near_path(field.cell_x(), field.columns(), path.min[0] - reach, path.max[0] + reach);
  const auto [r0, r1] = near_path(field.cell_y(), field.rows(), path.min[1] - reach, path.max[1] + reach);
  const double samples = static_cast<double>(c1 - c0 + 1) * (r1 - r0 + 1);
  const int stride = static_cast<int>(std::ceil(std::sqrt(std::max(1.0, samples / kMaxGroundSamples))));
  if (stride > 1) notes.push_back(fmt::format("of the ground, every {}th sample is shown", stride));
  const int columns = (c1 - c0) / stride + 1, rows = (r1 - r0) / stride + 1;
  std::vector<double> heights;
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) heights.push_back(field.at(c0 + c * stride, r0 + r * stride));
  }
  return {{"columns", columns},
          {"rows", rows},
          {"x", c0 * field.cell_x() - field.size_x() / 2},
          {"y", r0 * field.cell_y() - field.size_y() / 2},
          {"cell_x", stride * field.cell_x()},
          {"cell_y", stride * field.cell_y()},
          {"heights", numbers.add(heights)}};
}

}  // namespace

nlohmann::ordered_json scene_document(const RobotDescription& robot, const Terrain& terrain,
                                      const PathBounds& path, PageNumbers& numbers) {
  ordered_json notes = ordered_json::array(), bodies = ordered_json::array();
  Shapes shapes(numbers, notes, kMeshDetail * std::max(0.0, robot.standing_height));
  std::vector<ordered_json> of_bodies;
  for (const Body& body : robot.bodies) of_bodies.push_back(shapes.of(body));
  for (std::size_t i = 0; i < robot.bodies.size(); ++i) {
    const Body& body = robot.bodies[i];
    const Vector3& com = body.inertia.p_BC;
    ordered_json& its = of_bodies[i];
    if (!shapes.show_visuals() && its.empty()) its = shapes.sticks(robot, i);
    bodies.push_back({{"name", body.name},
                      {"mass", body.inertia.mass},
                      {"centre_of_mass", {com.x(), com.y(), com.z()}},
                      {"shapes", std::move(its)},
                      {"collision", shapes.collision(body)},
                      {"inertia", inertia_box(body.inertia)}});
  }
  // About two lengths of a quadruped, whose legs are half as long as it is.
  const double reach = robot.standing_height > 0 ? 8 * robot.standing_height : 1;
  ordered_json scene{{"robot", robot.name},
                     {"terrain", terrain.name()},
                     {"standing_height", robot.standing_height},
                     {"reach", reach},
                     {"path", {path.min[0], path.min[1], path.max[0], path.max[1]}},
                     {"bodies", std::move(bodies)},
                     {"meshes", shapes.meshes()},
                     {"legs", legs_of(robot)},
                     {"ground", nullptr}};
  if (const HeightField* field = terrain.field())
    scene["ground"] = ground_of(*field, path, reach, numbers, notes);
  scene["notes"] = std::move(notes);
  return scene;
}

}  // namespace crossgait
