// Loop closures as constraints of PhysX.
#pragma once

#include <optional>

#include "backends/physx/link_constraint.h"
#include "physics/core/math.h"
#include "physics/engine/soft_law.h"

namespace crossgait::physx {

/// Holds a point of one link at a point of another: three rows without bounds, solved along with contacts.
class LoopConstraint final : public LinkConstraint {
 public:
  /// MuJoCo's law in the place of a hard row.
  struct Soft {
    SoftLaw law;
    double inverse_weight;  ///< of both bodies together, 1/kg
    double step;            ///< s
  };

  /// @param p_A,p_B  the point in the links' frames of their centres of mass, m
  LoopConstraint(px::PxPhysics& physics, px::PxArticulationLink& a, const Vector3& p_A,
                 px::PxArticulationLink& b, const Vector3& p_B, const std::optional<Soft>& soft);

  /// Begins a step of a soft loop. @param a,b  velocities of the links' centres of mass, in W
  void begin_step(const px::PxSpatialVelocity& a, const px::PxSpatialVelocity& b);

 private:
  struct Rows {
    px::PxVec3 a, b;
    px::PxVec3 target = px::PxVec3(0);  ///< velocities that the rows ask for, m/s
    px::PxReal damping = 0;             ///< N s/m: what they give way by; of hard rows 0
  };

  static Prepare prepare;

  px::PxArticulationLink &a_, &b_;
  std::optional<Soft> soft_;
  Rows rows_;
};

}  // namespace crossgait::physx
