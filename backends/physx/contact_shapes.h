// Collision shapes and the ground as geometries of PhysX.
#pragma once

#include <memory>
#include <vector>

#include <PxPhysicsAPI.h>

#include "backends/contact/contact_points.h"
#include "physics/engine/world_spec.h"

namespace crossgait::physx {

namespace px = ::physx;

/// Gives PhysX what it needs of custom geometry and nothing here asks for: rays, overlaps, sweeps, masses.
class ContactGeometry : public px::PxCustomGeometry::Callbacks {
 public:
  /// Returns none: types are for users alone, and what would number them is not in the library.
  px::PxCustomGeometry::Type getCustomType() const override { return px::PxCustomGeometry::Type::INVALID(); }
  px::PxU32 raycast(const px::PxVec3& /*origin*/, const px::PxVec3& /*direction*/,
                    const px::PxGeometry& /*geometry*/, const px::PxTransform& /*pose*/, px::PxReal /*most*/,
                    px::PxHitFlags /*flags*/, px::PxU32 /*max_hits*/, px::PxGeomRaycastHit* /*hits*/,
                    px::PxU32 /*stride*/, px::PxRaycastThreadContext* /*context*/) const override {
    return 0;
  }
  bool overlap(const px::PxGeometry& /*a*/, const px::PxTransform& /*pose_a*/, const px::PxGeometry& /*b*/,
               const px::PxTransform& /*pose_b*/, px::PxOverlapThreadContext* /*context*/) const override {
    return false;
  }
  bool sweep(const px::PxVec3& /*direction*/, px::PxReal /*most*/, const px::PxGeometry& /*a*/,
             const px::PxTransform& /*pose_a*/, const px::PxGeometry& /*b*/,
             const px::PxTransform& /*pose_b*/, px::PxGeomSweepHit& /*hit*/, px::PxHitFlags /*flags*/,
             px::PxReal /*inflation*/, px::PxSweepThreadContext* /*context*/) const override {
    return false;
  }
  void visualize(const px::PxGeometry& /*geometry*/, px::PxRenderOutput& /*out*/,
                 const px::PxTransform& /*pose*/, const px::PxBounds3& /*box*/) const override {}
  void computeMassProperties(const px::PxGeometry& /*geometry*/,
                             px::PxMassProperties& properties) const override {
    properties = px::PxMassProperties();
  }
  bool usePersistentContactManifold(const px::PxGeometry& /*geometry*/,
                                    px::PxReal& /*threshold*/) const override {
    return false;
  }
};

/// Touches the ground where contact_features.h says.
class FeatureGeometry final : public ContactGeometry {
 public:
  /// @param margin  how far above the ground points count, m
  /// @param origin  PhysX's in W, which may move
  FeatureGeometry(const RobotDescription& robot, int body, int shape, const Terrain& terrain, double margin,
                  const Vector3& origin);

  /// Finds contacts of the shape in this pose from PhysX's origin, and hands them over from there.
  bool touch(const px::PxTransform& X_WG, bool ground_first, px::PxContactBuffer& contacts) const;
  /// Returns what `touch` found since `forget`, in W.
  const contact::ContactPoints& points() const noexcept { return points_; }
  void forget() noexcept { points_.clear(); }

  px::PxBounds3 getLocalBounds(const px::PxGeometry& /*geometry*/) const override { return bounds_; }
  bool generateContacts(const px::PxGeometry& geom0, const px::PxGeometry& geom1,
                        const px::PxTransform& pose0, const px::PxTransform& pose1, px::PxReal distance,
                        px::PxReal margin, px::PxReal length, px::PxContactBuffer& contacts) const override;

 private:
  const Vector3* origin_;
  mutable Pose X_WG_ = Pose::Identity();
  contact::BodyKinematics kinematics_;
  contact::ContactFinder finder_;
  px::PxBounds3 bounds_;
  mutable contact::ContactPoints points_;
};

/// Is a height field that asks the shapes.
class FieldGeometry final : public ContactGeometry {
 public:
  explicit FieldGeometry(const Terrain& terrain);

  px::PxBounds3 getLocalBounds(const px::PxGeometry& /*geometry*/) const override { return bounds_; }
  bool generateContacts(const px::PxGeometry& geom0, const px::PxGeometry& geom1,
                        const px::PxTransform& pose0, const px::PxTransform& pose1, px::PxReal distance,
                        px::PxReal margin, px::PxReal length, px::PxContactBuffer& contacts) const override;

 private:
  px::PxBounds3 bounds_;
};

}  // namespace crossgait::physx
