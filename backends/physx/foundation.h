// The one PhysX of a process.
#pragma once

#include <utility>

#include <PxPhysicsAPI.h>

namespace crossgait::physx {

namespace px = ::physx;

/// Makes PhysX at the first call; there is one of it in a process, which stays to the end. SAPIEN's library,
/// of which it is a part, may have made it before for others. May be called from several threads at once.
/// @throws std::runtime_error if it cannot be made, ConfigError in a fork of the process that made it
px::PxPhysics& the_physics();

/// Tells whether this is a fork of the process that made PhysX. Locks that its threads held stay so there, so
/// nothing is asked of it.
bool is_fork() noexcept;
/// @throws ConfigError if it is
void refuse_fork();

/// Takes a cache of an articulation out of a stock of those that worlds have given back: the function that
/// frees one is not in the library.
class CacheOfStock {
 public:
  explicit CacheOfStock(px::PxArticulationReducedCoordinate& articulation);
  ~CacheOfStock();
  CacheOfStock(const CacheOfStock&) = delete;
  CacheOfStock& operator=(const CacheOfStock&) = delete;

  px::PxArticulationCache* operator->() const noexcept { return cache_; }
  px::PxArticulationCache& operator*() const noexcept { return *cache_; }

 private:
  std::pair<px::PxU32, px::PxU32> size_;  ///< dofs and links
  px::PxArticulationCache* cache_;
};

/// Runs PhysX's tasks where they are handed in: a world is one thread.
class InlineDispatcher final : public px::PxCpuDispatcher {
 public:
  void submitTask(px::PxBaseTask& task) override {
    task.run();
    task.release();
  }
  uint32_t getWorkerCount() const override { return 0; }
};

/// Gives back what PhysX hands out.
struct Release {
  template <typename T>
  void operator()(T* object) const {
    object->release();
  }
};

}  // namespace crossgait::physx
