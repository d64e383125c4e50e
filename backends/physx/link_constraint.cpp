#include "backends/physx/link_constraint.h"

#include <stdexcept>

namespace crossgait::physx {
namespace {

void show_nothing(px::PxConstraintVisualizer& /*visualizer*/, const void* /*data*/,
                  const px::PxTransform& /*A*/, const px::PxTransform& /*B*/, px::PxU32 /*flags*/) {}

}  // namespace

void LinkConstraint::make(px::PxPhysics& physics, px::PxArticulationLink& a, px::PxArticulationLink& b,
                          px::PxConstraintSolverPrep prepare, void* data, px::PxU32 size,
                          px::PxConstraintFlags flags) {
  prepare_ = prepare;
  data_ = data;
  const px::PxConstraintShaderTable shaders = {prepare, show_nothing, px::PxConstraintFlag::Enum(0)};
  constraint_ = physics.createConstraint(&a, &b, *this, shaders, size);
  if (constraint_ == nullptr) throw std::runtime_error("PhysX refused a constraint of two links");
  constraint_->setFlags(flags);
}

LinkConstraint::~LinkConstraint() {
  if (constraint_ != nullptr) constraint_->release();
}

void* LinkConstraint::getExternalReference(px::PxU32& type) {
  type = px::PxConcreteType::eFIRST_USER_EXTENSION;
  return this;
}

}  // namespace crossgait::physx
