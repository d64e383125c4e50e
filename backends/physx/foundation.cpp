#include "backends/physx/foundation.h"

#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>
#include <sapien/physx/physx_engine.h>
#include <unistd.h>

#include "physics/core/error.h"

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

std::atomic<pid_t> maker = 0;  // the process that made PhysX

}  // namespace

bool is_fork() noexcept {
  const pid_t made_by = maker.load(std::memory_order_relaxed);
  return made_by != 0 && made_by != getpid();
}

void refuse_fork() {
  if (is_fork())
    throw ConfigError(
        "physx", "process",
        fmt::format("process {}, which made PhysX: there is one of it in a process", maker.load()),
        fmt::format("a fork of it, {}: start processes by spawn instead of fork, or make the first "
                    "world after it",
                    getpid()));
}

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
  refuse_fork();
  // Never given back: worlds of other threads may outlast whatever runs at the end of the process.
  static px::PxPhysics* physics = [] {
    const px::PxTolerancesScale scale;  // PhysX's own: metres and metres per second
    static const auto* engine = new std::shared_ptr<sapien::physx::PhysxEngine>(
        sapien::physx::PhysxEngine::Get(scale.length, scale.speed));
    maker = getpid();
    return (*engine)->getPxPhysics();
  }();
  if (physics == nullptr) throw std::runtime_error("PhysX could not be started");
  return *physics;
}

}  // namespace crossgait::physx
