#include "backends/physx/foundation.h"

#include <map>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <vector>

#include <sapien/physx/physx_engine.h>

namespace crossgait::physx {
namespace {

using Caches = std::vector<px::PxArticulationCache*>;

// Never given back, as PhysX itself.
std::mutex& stock_mutex() {
  static auto* mutex = new std::mutex;
  return *mutex;
}
std::map<std::pair<px::PxU32, px::PxU32>, Caches>& stock() {
  static auto* caches = new std::map<std::pair<px::PxU32, px::PxU32>, Caches>;
  return *caches;
}

}  // namespace

CacheOfStock::CacheOfStock(px::PxArticulationReducedCoordinate& articulation)
    : size_(articulation.getDofs(), articulation.getNbLinks()), cache_(nullptr) {
  const std::lock_guard lock(stock_mutex());
  Caches& caches = stock()[size_];
  if (caches.empty()) {
    cache_ = articulation.createCache();
  } else {
    cache_ = caches.back();
    caches.pop_back();
    articulation.zeroCache(*cache_);
  }
  if (cache_ == nullptr) throw std::runtime_error("PhysX refused a cache of an articulation");
}

CacheOfStock::~CacheOfStock() {
  const std::lock_guard lock(stock_mutex());
  stock()[size_].push_back(cache_);
}

px::PxPhysics& the_physics() {
  // Never given back: worlds of other threads may outlast whatever runs at the end of the process.
  static px::PxPhysics* physics = [] {
    const px::PxTolerancesScale scale;  // PhysX's own: metres and metres per second
    static const auto* engine = new std::shared_ptr<sapien::physx::PhysxEngine>(
        sapien::physx::PhysxEngine::Get(scale.length, scale.speed));
    return (*engine)->getPxPhysics();
  }();
  if (physics == nullptr) throw std::runtime_error("PhysX could not be started");
  return *physics;
}

}  // namespace crossgait::physx
