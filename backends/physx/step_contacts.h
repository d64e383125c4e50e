// The robot's shapes in a scene, and what they touched in a step.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include <PxPhysicsAPI.h>
#include <geomutils/PxContactBuffer.h>

#include "backends/physx/articulation_model.h"
#include "backends/physx/contact_shapes.h"

namespace crossgait::physx {

/// Gives the links their shapes and the scene its ground, and lists contacts of a step: places and normal
/// impulses as PhysX has them. Of friction PhysX 5.3 says nothing: its force is what a body's change of
/// momentum has beside gravity, joints and normal forces, shared out by the latter.
class StepContacts final : public px::PxSimulationEventCallback {
 public:
  StepContacts(const WorldSpec& spec, const Settings& settings);

  /// Adds ground and shapes. @throws std::runtime_error if PhysX refuses one
  void build(px::PxScene& scene, const ArticulationModel& model);
  /// Forgets the contacts of the last step.
  void forget() noexcept;
  /// Makes every step find its contacts anew: PhysX keeps where a patch stuck and would hold it there, no
  /// part of a state that can be saved. Puts the ground where PhysX's origin leaves it.
  void begin_step(px::PxScene& scene, const ArticulationModel& model);
  /// Reads contacts of the step that was taken.
  void read(const ArticulationModel& model, const Vector3& push, ContactList& contacts) const noexcept;

  void onContact(const px::PxContactPairHeader& header, const px::PxContactPair* pairs,
                 px::PxU32 count) override;
  void onConstraintBreak(px::PxConstraintInfo* /*constraints*/, px::PxU32 /*count*/) override {}
  void onWake(px::PxActor** /*actors*/, px::PxU32 /*count*/) override {}
  void onSleep(px::PxActor** /*actors*/, px::PxU32 /*count*/) override {}
  void onTrigger(px::PxTriggerPair* /*pairs*/, px::PxU32 /*count*/) override {}
  void onAdvance(const px::PxRigidBody* const* /*bodies*/, const px::PxTransform* /*poses*/,
                 px::PxU32 /*count*/) override {}

 private:
  struct Shape {
    int body = -1, leg = -1;
    std::unique_ptr<FeatureGeometry> features;  ///< null: a geometry of PhysX's
    px::PxU32 count = 0;                        ///< contacts that PhysX solved
    std::array<px::PxContactPairPoint, px::PxContactBuffer::MAX_CONTACTS> points;
  };

  void add_shape(px::PxArticulationLink& link, const ArticulationModel& model, int body, int index);
  void list(const Shape& shape, const Vector3& origin, ContactList& contacts) const noexcept;
  void add_friction(const ArticulationModel& model, const Vector3& push,
                    ContactList& contacts) const noexcept;

  const WorldSpec& spec_;
  std::vector<double> margins_;  ///< by body: how far above the ground points count, m
  std::unique_ptr<px::PxMaterial, Release> material_;
  std::unique_ptr<FieldGeometry> field_;
  std::unique_ptr<px::PxRigidStatic, Release> ground_;
  std::vector<std::unique_ptr<Shape>> shapes_;
  mutable std::vector<Vector3> forces_;  ///< by group of bodies, N
  mutable std::vector<double> loads_;    ///< by group: sum of normal forces, N
};

/// Lets only the ground be touched.
px::PxFilterFlags only_ground(px::PxFilterObjectAttributes a, px::PxFilterData data_a,
                              px::PxFilterObjectAttributes b, px::PxFilterData data_b, px::PxPairFlags& flags,
                              const void* block, px::PxU32 size);

}  // namespace crossgait::physx
