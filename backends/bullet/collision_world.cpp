#include "backends/bullet/collision_world.h"

#include <algorithm>
#include <limits>

#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>

#include "backends/bullet/convert.h"
#include "backends/contact/joint_limit.h"

namespace crossgait::bullet {
namespace {

// The robot collides with the terrain and with nothing else.
constexpr int kTerrainGroup = 1;
constexpr int kRobotGroup = 2;
constexpr double kFieldDepth = 0.1;  // m

// Bullet's own sizes are for 4096 pairs that touch, 6 MB a world. For more pairs than these it asks the
// allocator.
btDefaultCollisionConstructionInfo room_for(const WorldSpec& spec) {
  btDefaultCollisionConstructionInfo sizes;
  const auto pairs = contact_features(*spec.robot, spec.fixed_base).size() + spec.robot->bodies.size();
  sizes.m_defaultMaxPersistentManifoldPoolSize = static_cast<int>(pairs);
  sizes.m_defaultMaxCollisionAlgorithmPoolSize =
      static_cast<int>(2 * pairs);  // of a body, and of each feature
  return sizes;
}

}  // namespace

CollisionWorld::CollisionWorld(const WorldSpec& spec, const ContactFactors& factors, MultibodyModel& model,
                               ConstraintSolver& solver)
    : spec_(spec),
      factors_(factors),
      model_(model),
      solver_(solver),
      configuration_(room_for(spec)),
      terrain_collision_(spec.terrain),
      dispatcher_(&configuration_),
      world_(&dispatcher_, &broadphase_, &solver, &configuration_) {
  world_.setGravity(vector(spec.gravity));
  world_.setForceUpdateAllAabbs(false);
  world_.getDispatchInfo().m_deterministicOverlappingPairs = true;
  // Bullet 3.24 drops every multibody constraint without islands.
  world_.getSimulationIslandManager()->setSplitIslands(true);
  btContactSolverInfo& info = world_.getSolverInfo();
  info.m_numIterations = spec.solver.iterations;
  info.m_leastSquaresResidualThreshold = spec.solver.tolerance * spec.solver.tolerance;
  info.m_globalCfm = 0;                   // ConstraintSolver adds the world's
  info.m_erp2 = spec.contact.erp;         // of contacts
  info.m_erp = contact::kLimitReduction;  // of limits, where impulses are not split
  info.m_splitImpulse = 0;                // has no effect on multibodies
  // No warm starting and no random order, which would make a restored run differ; both friction directions.
  info.m_solverMode = SOLVER_SIMD | SOLVER_USE_2_FRICTION_DIRECTIONS;
  add_terrain();
  add_robot();
}

CollisionWorld::~CollisionWorld() {
  for (const auto& collider : colliders_) world_.removeCollisionObject(collider.get());
  world_.removeCollisionObject(&terrain_);
  world_.removeMultiBody(&model_.body());
}

void CollisionWorld::add_terrain() {
  btTransform pose = btTransform::getIdentity();
  if (const HeightField* field = spec_.terrain.field()) {
    heights_.assign(field->heights().begin(), field->heights().end());
    // Bullet recentres heights about the middle of [low, high], and looks for contact between the two only:
    // as deep as MuJoCo takes the ground to be, and as high.
    const double low = field->min() - kFieldDepth, high = field->max() + kFieldDepth;
    auto shape =
        std::make_unique<btHeightfieldTerrainShape>(field->columns(), field->rows(), heights_.data(), 1.0,
                                                    low, high, 2, PHY_DOUBLE, /*flipQuadEdges=*/true);
    shape->setLocalScaling(btVector3(field->cell_x(), field->cell_y(), 1));
    shape->setMargin(0);
    pose.setOrigin(btVector3(0, 0, (low + high) / 2));
    shapes_.push_back(std::move(shape));
  } else {
    shapes_.push_back(std::make_unique<btStaticPlaneShape>(btVector3(0, 0, 1), 0));
  }
  terrain_collision_.install(dispatcher_);
  terrain_.setCollisionShape(shapes_.back().get());
  terrain_.setWorldTransform(pose);
  terrain_.setFriction(1);  // Bullet multiplies coefficients: the robot's alone counts
  terrain_.setRestitution(0);
  world_.addCollisionObject(&terrain_, kTerrainGroup, kRobotGroup);
}

void CollisionWorld::add_robot() {
  world_.addMultiBody(&model_.body());
  // Unless Bullet finds contacts the solver does: Bullet has nothing to collide.
  if (factors_.narrowphase) features_ = model_.contact_features();
  for (int link = -1; link < model_.body().getNumLinks(); ++link) {
    std::unique_ptr<btCompoundShape> shape = make_link_shape(features_, link, shapes_);
    if (shape->getNumChildShapes() == 0) continue;
    auto collider = std::make_unique<btMultiBodyLinkCollider>(&model_.body(), link);
    collider->setCollisionShape(shape.get());
    collider->setFriction(spec_.contact.friction);
    collider->setRollingFriction(0);
    collider->setSpinningFriction(0);
    collider->setRestitution(0);
    collider->setActivationState(DISABLE_DEACTIVATION);
    if (link < 0) {
      model_.body().setBaseCollider(collider.get());
    } else {
      model_.body().getLink(link).m_collider = collider.get();
    }
    world_.addCollisionObject(collider.get(), kRobotGroup, kTerrainGroup);
    shapes_.push_back(std::move(shape));
    colliders_.push_back(std::move(collider));
  }
  robot_moved();
}

void CollisionWorld::robot_moved() {
  btMultiBody& body = model_.body();
  body.clearForcesAndTorques();
  body.forwardKinematics(scratch_rotations_, scratch_origins_);
  body.updateCollisionObjectWorldTransforms(scratch_rotations_, scratch_origins_);
  world_.updateAabbs();
  solver_.reset();
}

void CollisionWorld::step() {
  for (int i = 0; i < dispatcher_.getNumManifolds(); ++i) {
    dispatcher_.getManifoldByIndexInternal(i)->clearManifold();
  }
  const double h = spec_.physics_dt;
  world_.stepSimulation(h, 0, h);
}

double CollisionWorld::terrain_height(double x, double y) const {
  const double top = spec_.terrain.field() != nullptr ? spec_.terrain.field()->max() + 1 : 1;
  const double bottom = spec_.terrain.field() != nullptr ? spec_.terrain.field()->min() - 1 : -1;
  const btVector3 from(x, y, top), to(x, y, bottom);
  btCollisionWorld::ClosestRayResultCallback hit(from, to);
  btCollisionWorld::rayTestSingle(btTransform(btQuaternion::getIdentity(), from),
                                  btTransform(btQuaternion::getIdentity(), to),
                                  const_cast<btCollisionObject*>(&terrain_), terrain_.getCollisionShape(),
                                  terrain_.getWorldTransform(), hit);
  if (!hit.hasHit()) return std::numeric_limits<double>::quiet_NaN();
  return top + (bottom - top) * hit.m_closestHitFraction;
}

}  // namespace crossgait::bullet
