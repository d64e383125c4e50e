// Puts Crossgait's contact points in the place of Bullet's, in one world.
#pragma once

#include <memory>
#include <vector>

#include <BulletCollision/CollisionDispatch/btCollisionCreateFunc.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>

#include "backends/bullet/multibody_model.h"
#include "physics/terrain/terrain.h"

namespace crossgait::bullet {

/// Makes the shape of a link: a sphere or a rim (a flat cylinder) for each of its features, or no children.
/// @param features  have to outlive it
/// @param children  keeps what the compound refers to
std::unique_ptr<btCompoundShape> make_link_shape(const std::vector<contact::BodyFeature>& features, int link,
                                                 std::vector<std::unique_ptr<btCollisionShape>>& children);

/// Bullet collides a sphere with every triangle near it, and takes the edges between them for corners: on a
/// perfectly flat incline of triangles a sled slides up to a fifth faster or slower than on a plane,
/// depending on its heading. `sphere_centres` and `Terrain::touch_sphere` give the same points as in every
/// engine. As in Bullet's own routines, points within the contact breaking threshold above the ground count,
/// with a positive distance. Bullet's own routine of a sphere and a plane is exact and stays.
class TerrainCollisionFactory final : public btCollisionAlgorithmCreateFunc {
 public:
  /// @param terrain must outlive this
  explicit TerrainCollisionFactory(const Terrain& terrain) : terrain_(terrain) {}

  /// Makes `dispatcher` use it; it must outlive the dispatcher. Shapes are to be children of those that
  /// `make_link_shape` makes, which hand themselves over first.
  void install(btCollisionDispatcher& dispatcher);

  btCollisionAlgorithm* CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                 const btCollisionObjectWrapper* shape,
                                                 const btCollisionObjectWrapper* ground) override;

 private:
  const Terrain& terrain_;
};

}  // namespace crossgait::bullet
