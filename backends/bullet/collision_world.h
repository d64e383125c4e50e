// Bullet's collision side: colliders of the robot and the terrain.
#pragma once

#include <memory>
#include <vector>

#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>
#include <btBulletDynamicsCommon.h>

#include "backends/bullet/constraint_solver.h"
#include "backends/bullet/multibody_model.h"
#include "backends/bullet/terrain_collision.h"

namespace crossgait::bullet {

/// Steps as btMultiBodyDynamicsWorld does, without predicting where bodies would go and which of them sleep:
/// nothing here looks at it.
class StepWorld final : public btMultiBodyDynamicsWorld {
 public:
  using btMultiBodyDynamicsWorld::btMultiBodyDynamicsWorld;

 private:
  void predictUnconstraintMotion(btScalar) override {}
  void updateActivationState(btScalar) override {}
};

/// Holds the btMultiBodyDynamicsWorld with one robot and one terrain, set up so that nothing but physics is
/// left in it.
class CollisionWorld {
 public:
  CollisionWorld(const WorldSpec& spec, const ContactFactors& factors, MultibodyModel& model,
                 ConstraintSolver& solver);
  ~CollisionWorld();
  CollisionWorld(const CollisionWorld&) = delete;
  CollisionWorld& operator=(const CollisionWorld&) = delete;

  /// Takes exactly one step of the spec's physics_dt. Contacts are found afresh: nothing survives from the
  /// last step.
  void step();
  /// Takes note that the robot was moved by hand.
  void robot_moved();
  /// Returns the height of the terrain under (x, y) by Bullet's ray test; NaN where the ray misses.
  double terrain_height(double x, double y) const;

 private:
  void add_terrain();
  void add_robot();

  const WorldSpec& spec_;
  ContactFactors factors_;
  MultibodyModel& model_;
  ConstraintSolver& solver_;

  btDefaultCollisionConfiguration configuration_;
  TerrainCollisionFactory terrain_collision_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broadphase_;
  StepWorld world_;
  std::vector<double> heights_;                 // Bullet keeps a pointer
  std::vector<contact::BodyFeature> features_;  // that Bullet is to find contacts of
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btMultiBodyLinkCollider>> colliders_;
  btCollisionObject terrain_;
  btAlignedObjectArray<btQuaternion> scratch_rotations_;
  btAlignedObjectArray<btVector3> scratch_origins_;
};

}  // namespace crossgait::bullet
