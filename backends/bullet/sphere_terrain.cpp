#include "crossgait/backends/bullet/sphere_terrain.h"

#include <new>

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>

#include "crossgait/backends/bullet/convert.h"

namespace crossgait::bullet {
namespace {

class SphereTerrainAlgorithm final : public btCollisionAlgorithm {
 public:
  SphereTerrainAlgorithm(const btCollisionAlgorithmConstructionInfo& info, const btCollisionObject* sphere,
                         const btCollisionObject* field, const Terrain& terrain)
      : btCollisionAlgorithm(info),
        manifold_(m_dispatcher->getNewManifold(sphere, field)),
        terrain_(terrain) {}
  SphereTerrainAlgorithm(const SphereTerrainAlgorithm&) = delete;
  SphereTerrainAlgorithm& operator=(const SphereTerrainAlgorithm&) = delete;
  ~SphereTerrainAlgorithm() override { m_dispatcher->releaseManifold(manifold_); }

  void processCollision(const btCollisionObjectWrapper* sphere, const btCollisionObjectWrapper* /*field*/,
                        const btDispatcherInfo& /*info*/, btManifoldResult* result) override {
    result->setPersistentManifold(manifold_);
    const double radius = static_cast<const btSphereShape*>(sphere->getCollisionShape())->getRadius();
    const double reach = radius + manifold_->getContactBreakingThreshold();
    const Vector3 centre = vector(sphere->getWorldTransform().getOrigin());
    SphereContact touch;
    if (terrain_.touch_sphere(centre, reach, touch)) {
      const double height = touch.distance + reach;  // of the centre, along the normal
      result->addContactPoint(vector(touch.normal), vector(Vector3(centre - height * touch.normal)),
                              height - radius);
    }
    result->refreshContactPoints();
  }

  btScalar calculateTimeOfImpact(btCollisionObject* /*sphere*/, btCollisionObject* /*field*/,
                                 const btDispatcherInfo& /*info*/, btManifoldResult* /*result*/) override {
    return 1;  // no continuous collision detection
  }

  void getAllContactManifolds(btManifoldArray& manifolds) override { manifolds.push_back(manifold_); }

 private:
  btPersistentManifold* manifold_;
  const Terrain& terrain_;
};

}  // namespace

void SphereTerrainFactory::install(btCollisionDispatcher& dispatcher) {
  dispatcher.registerCollisionCreateFunc(SPHERE_SHAPE_PROXYTYPE, TERRAIN_SHAPE_PROXYTYPE, this);
}

btCollisionAlgorithm* SphereTerrainFactory::CreateCollisionAlgorithm(
    btCollisionAlgorithmConstructionInfo& info, const btCollisionObjectWrapper* sphere,
    const btCollisionObjectWrapper* field) {
  void* memory = info.m_dispatcher1->allocateCollisionAlgorithm(sizeof(SphereTerrainAlgorithm));
  return new (memory)
      SphereTerrainAlgorithm(info, sphere->getCollisionObject(), field->getCollisionObject(), terrain_);
}

}  // namespace crossgait::bullet
