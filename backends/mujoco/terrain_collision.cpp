#include "backends/mujoco/terrain_collision.h"

#include <algorithm>
#include <mutex>
#include <string>
#include <utility>

#include "backends/mujoco/convert.h"
#include "backends/mujoco/engine_call.h"
#include "backends/mujoco/model_xml.h"

namespace crossgait::mujoco {
namespace {

template <int kGround, int kShape>
struct TableEntry {
  static mjfCollision& place() { return mjCOLLISIONFUNC[kGround][kShape]; }
  static inline mjfCollision original = nullptr;

  static int collide(const mjModel* m, CollisionData* d, FoundContact* contacts, int ground, int geom,
                     mjtNum margin) {
    // A sphere on a plane MuJoCo does to rounding as we do: only whether it is one of the deepest is ours to
    // say.
    constexpr bool kExact = kGround == mjGEOM_PLANE && kShape == mjGEOM_SPHERE;
    TerrainCollision* const collision = collision_of(m);
    const int count = collision == nullptr ? 0 : collision->write(*d, geom, contacts);
    const bool ours = collision != nullptr && !(kExact && count > 0);
    return ours ? count : original(m, d, contacts, ground, geom, margin);
  }
  static void install() { original = std::exchange(place(), collide); }
};

template <int kGround>
void install_row() {
  TableEntry<kGround, mjGEOM_SPHERE>::install();
  TableEntry<kGround, mjGEOM_CAPSULE>::install();
  TableEntry<kGround, mjGEOM_CYLINDER>::install();
  TableEntry<kGround, mjGEOM_BOX>::install();
}

}  // namespace

TerrainCollision::TerrainCollision(const RobotDescription& robot, bool fixed_base, const Terrain& terrain)
    : features_(contact_features(robot, fixed_base)), terrain_(terrain) {}

void TerrainCollision::set_model(const mjModel& model, const RobotDescription& robot) {
  geoms_.clear();
  reach_.assign(static_cast<std::size_t>(model.ngeom), 0);
  int number = 0;  // among those of its shape
  for (std::size_t i = 0; i < features_.size(); ++i) {
    const ContactFeature& feature = features_[i];
    const bool same_shape =
        i > 0 && features_[i - 1].body == feature.body && features_[i - 1].shape == feature.shape;
    number = same_shape ? number + 1 : 0;
    const CollisionShape& shape =
        robot.bodies[static_cast<std::size_t>(feature.body)].shapes[static_cast<std::size_t>(feature.shape)];
    const std::string name = shape_name(feature.body, feature.shape, part_of(shape, number));
    geoms_.push_back(mj_name2id(&model, mjOBJ_GEOM, name.c_str()));
    double& farthest = reach_[static_cast<std::size_t>(geoms_.back())];
    farthest = std::max(farthest, reach(feature));
  }
}

void TerrainCollision::find(const mjData& data) noexcept {
  points_.clear();
  for (std::size_t i = 0; i < features_.size(); ++i) {
    const ContactFeature& feature = features_[i];
    const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> R_WG(data.geom_xmat + 9 * geoms_[i]);
    const Vector3 p_WG = vector(data.geom_xpos + 3 * geoms_[i]);
    if (p_WG.z() - reach_[static_cast<std::size_t>(geoms_[i])] > terrain_.max()) continue;
    const SphereCentres centres =
        sphere_centres(feature, p_WG + R_WG * feature.p_GC, R_WG * feature.axis_G, terrain_, /*margin=*/0);
    for (int k = 0; k < centres.count; ++k) {
      SphereContact touch;
      if (!terrain_.touch_sphere(centres.points[static_cast<std::size_t>(k)], feature.radius, touch))
        continue;
      points_.add({geoms_[i], touch.position, touch.normal, touch.distance});
    }
  }
  found_ = true;
}

int TerrainCollision::write(const mjData& data, int geom, FoundContact* contacts) noexcept {
  if (!found_) find(data);
  int count = 0;
  for (const Point& point : points_) {
    if (point.geom != geom || count == kMaxPlaneContacts) continue;
    FoundContact& contact = contacts[count++];
    contact.dist = point.distance;
    mju_copy3(contact.pos, point.position.data());
    mju_copy3(normal_of(contact), point.normal.data());
    mju_zero3(tangent_of(contact));  // MuJoCo completes the tangents
  }
  return count;
}

void install_terrain_collision() {
  static std::once_flag once;
  std::call_once(once, [] {
    install_row<mjGEOM_PLANE>();
    install_row<mjGEOM_HFIELD>();
  });
}

}  // namespace crossgait::mujoco
