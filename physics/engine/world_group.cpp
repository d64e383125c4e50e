#include "physics/engine/world_group.h"

#include "physics/core/worker_pool.h"

namespace crossgait {

WorldGroup::WorldGroup(std::size_t threads) : threads_(threads), worker_(&WorkerPool::worker) {}

std::size_t WorldGroup::thread() const noexcept {
  const std::size_t worker = worker_();
  return worker < threads_ ? worker : 0;
}

}  // namespace crossgait
