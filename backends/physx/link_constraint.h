// A constraint of ours between two links, solved by PhysX along with contacts.
#pragma once

#include <type_traits>

#include <PxPhysicsAPI.h>

namespace crossgait::physx {

namespace px = ::physx;

/// Stands between PhysX and rows that a derived class writes: `Prepare` reads `Data`, which does not move.
// NOLINTNEXTLINE(cppcoreguidelines-virtual-class-destructor): virtual in its base, and nobody deletes by it
class LinkConstraint : private px::PxConstraintConnector {
 public:
  /// Type of the functions that write rows.
  using Prepare = std::remove_pointer_t<px::PxConstraintSolverPrep>;

  LinkConstraint(const LinkConstraint&) = delete;
  LinkConstraint& operator=(const LinkConstraint&) = delete;

 protected:
  LinkConstraint() = default;
  ~LinkConstraint() override;

  /// Makes it, once, when the data is there.
  /// @param data  that `prepare` gets a copy of; outlives this
  /// @param flags  of the whole constraint
  /// @throws std::runtime_error if PhysX refuses it
  void make(px::PxPhysics& physics, px::PxArticulationLink& a, px::PxArticulationLink& b,
            px::PxConstraintSolverPrep prepare, void* data, px::PxU32 size, px::PxConstraintFlags flags = {});

  /// Tells PhysX that the data has changed.
  void changed() { constraint_->markDirty(); }

 private:
  void* prepareData() override { return data_; }
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
  px::PxConstraintSolverPrep getPrep() const override { return prepare_; }
  const void* getConstantBlock() const override { return data_; }

  px::PxConstraintSolverPrep prepare_ = nullptr;
  void* data_ = nullptr;
  px::PxConstraint* constraint_ = nullptr;
};

}  // namespace crossgait::physx
