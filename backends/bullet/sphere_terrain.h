// Replaces Bullet's sphere-heightfield narrowphase by Crossgait's exact one, in one world.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionCreateFunc.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>

#include "crossgait/physics/terrain.h"

namespace crossgait::bullet {

/// Bullet collides a sphere with every triangle near it, and takes the edges between them for corners: on a
/// perfectly flat incline of triangles a sled slides up to a fifth faster or slower than on a plane,
/// depending on its heading. `Terrain::touch_sphere` gives the deepest point alone, the same in every engine.
/// As in Bullet's own routines, points within the contact breaking threshold above the ground count, with a
/// positive distance.
class SphereTerrainFactory final : public btCollisionAlgorithmCreateFunc {
 public:
  /// @param terrain must have a field and outlive this
  explicit SphereTerrainFactory(const Terrain& terrain) : terrain_(terrain) {}

  /// Makes `dispatcher` use it; it must outlive the dispatcher. Spheres are to be children of compound
  /// shapes, which hand themselves over first.
  void install(btCollisionDispatcher& dispatcher);

  btCollisionAlgorithm* CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                 const btCollisionObjectWrapper* sphere,
                                                 const btCollisionObjectWrapper* field) override;

 private:
  const Terrain& terrain_;
};

}  // namespace crossgait::bullet
