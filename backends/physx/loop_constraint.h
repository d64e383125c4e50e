// Loop closures as constraints of PhysX.
#pragma once

#include <memory>

#include <PxPhysicsAPI.h>

#include "physics/core/math.h"

namespace crossgait::physx {

namespace px = ::physx;

/// Holds a point of one link at a point of another: three rows without bounds, solved along with contacts.
class LoopConstraint final : private px::PxConstraintConnector {
 public:
  /// @param p_A,p_B  the point in the links' frames of their centres of mass, m
  LoopConstraint(px::PxPhysics& physics, px::PxArticulationLink& a, const Vector3& p_A,
                 px::PxArticulationLink& b, const Vector3& p_B);
  ~LoopConstraint() override;
  LoopConstraint(const LoopConstraint&) = delete;
  LoopConstraint& operator=(const LoopConstraint&) = delete;

 private:
  struct Points {
    px::PxVec3 a, b;
  };

  static px::PxU32 prepare(px::Px1DConstraint* rows, px::PxVec3p& offset, px::PxU32 most,
                           px::PxConstraintInvMassScale& scale, const void* data, const px::PxTransform& A,
                           const px::PxTransform& B, bool extended_limits, px::PxVec3p& at_A,
                           px::PxVec3p& at_B);

  void* prepareData() override { return &points_; }
  bool updatePvdProperties(px::pvdsdk::PvdDataStream& /*stream*/, const px::PxConstraint* /*constraint*/,
                           px::PxPvdUpdateType::Enum /*type*/) const override {
    return false;
  }
  void updateOmniPvdProperties() const override {}
  void onConstraintRelease() override {}
  void onComShift(px::PxU32 /*actor*/) override {}
  void onOriginShift(const px::PxVec3& /*shift*/) override {}
  void* getExternalReference(px::PxU32& type) override;
  px::PxBase* getSerializable() override { return nullptr; }
  px::PxConstraintSolverPrep getPrep() const override { return prepare; }
  const void* getConstantBlock() const override { return &points_; }

  Points points_;
  px::PxConstraint* constraint_ = nullptr;
};

}  // namespace crossgait::physx
