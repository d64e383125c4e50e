#include "backends/bullet/terrain_collision.h"

#include <new>

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/CollisionShapes/btCylinderShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>

#include "backends/bullet/convert.h"

namespace crossgait::bullet {
namespace {

class TerrainAlgorithm final : public btCollisionAlgorithm {
 public:
  TerrainAlgorithm(const btCollisionAlgorithmConstructionInfo& info, const btCollisionObject* shape,
                   const btCollisionObject* ground, const Terrain& terrain)
      : btCollisionAlgorithm(info),
        manifold_(m_dispatcher->getNewManifold(shape, ground)),
        terrain_(terrain) {}
  TerrainAlgorithm(const TerrainAlgorithm&) = delete;
  TerrainAlgorithm& operator=(const TerrainAlgorithm&) = delete;
  ~TerrainAlgorithm() override { m_dispatcher->releaseManifold(manifold_); }

  void processCollision(const btCollisionObjectWrapper* shape, const btCollisionObjectWrapper* /*ground*/,
                        const btDispatcherInfo& /*info*/, btManifoldResult* result) override {
    result->setPersistentManifold(manifold_);
    const auto& feature = *static_cast<const ContactFeature*>(shape->getCollisionShape()->getUserPointer());
    const double margin = manifold_->getContactBreakingThreshold();
    const double reach = feature.radius + margin;
    const btTransform& pose = shape->getWorldTransform();
    const SphereCentres centres = sphere_centres(feature, vector(pose.getOrigin()),
                                                 vector(pose.getBasis().getColumn(2)), terrain_, margin);
    for (int i = 0; i < centres.count; ++i) {
      const Vector3& centre = centres.points[static_cast<std::size_t>(i)];
      SphereContact touch;
      if (!terrain_.touch_sphere(centre, reach, touch)) continue;
      const double height = touch.distance + reach;  // of the centre, along the normal
      result->addContactPoint(vector(touch.normal), vector(Vector3(centre - height * touch.normal)),
                              height - feature.radius);
    }
    result->refreshContactPoints();
  }

  btScalar calculateTimeOfImpact(btCollisionObject* /*shape*/, btCollisionObject* /*ground*/,
                                 const btDispatcherInfo& /*info*/, btManifoldResult* /*result*/) override {
    return 1;  // no continuous collision detection
  }

  void getAllContactManifolds(btManifoldArray& manifolds) override { manifolds.push_back(manifold_); }

 private:
  btPersistentManifold* manifold_;
  const Terrain& terrain_;
};

std::unique_ptr<btCollisionShape> make_feature_shape(const ContactFeature& feature) {
  std::unique_ptr<btCollisionShape> shape;
  if (feature.rim > 0) {
    const double thickness = feature.rim / 100;  // for Bullet's bounding boxes alone
    shape = std::make_unique<btCylinderShapeZ>(btVector3(feature.rim, feature.rim, thickness));
  } else {
    shape = std::make_unique<btSphereShape>(feature.radius);
  }
  shape->setUserPointer(const_cast<ContactFeature*>(&feature));
  return shape;
}

}  // namespace

std::unique_ptr<btCompoundShape> make_link_shape(const std::vector<contact::BodyFeature>& features, int link,
                                                 std::vector<std::unique_ptr<btCollisionShape>>& children) {
  auto compound = std::make_unique<btCompoundShape>(/*enableDynamicAabbTree=*/false);
  for (const contact::BodyFeature& of : features) {
    if (of.feature.body != link + 1) continue;
    children.push_back(make_feature_shape(of.feature));
    const btQuaternion turn =
        of.feature.rim > 0 ? quaternion(rotation_of_z_to(of.axis_C)) : btQuaternion::getIdentity();
    compound->addChildShape(btTransform(turn, vector(of.p_CF)), children.back().get());
  }
  return compound;
}

void TerrainCollisionFactory::install(btCollisionDispatcher& dispatcher) {
  dispatcher.registerCollisionCreateFunc(SPHERE_SHAPE_PROXYTYPE, TERRAIN_SHAPE_PROXYTYPE, this);
  dispatcher.registerCollisionCreateFunc(CYLINDER_SHAPE_PROXYTYPE, TERRAIN_SHAPE_PROXYTYPE, this);
  dispatcher.registerCollisionCreateFunc(CYLINDER_SHAPE_PROXYTYPE, STATIC_PLANE_PROXYTYPE, this);
}

btCollisionAlgorithm* TerrainCollisionFactory::CreateCollisionAlgorithm(
    btCollisionAlgorithmConstructionInfo& info, const btCollisionObjectWrapper* shape,
    const btCollisionObjectWrapper* ground) {
  void* memory = info.m_dispatcher1->allocateCollisionAlgorithm(sizeof(TerrainAlgorithm));
  return new (memory)
      TerrainAlgorithm(info, shape->getCollisionObject(), ground->getCollisionObject(), terrain_);
}

}  // namespace crossgait::bullet
