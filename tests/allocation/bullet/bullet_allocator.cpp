// Bullet allocates inside its own narrowphase and solver, through its own allocator: what goes through that
// is the engine's and not counted.
#include <cstdlib>

#include <LinearMath/btAlignedAllocator.h>

#include "crossgait/tests/support/allocation_counter.h"

namespace crossgait {
namespace {

void* allocate(std::size_t size) {
  const AllocationPause pause;
  return std::malloc(size);
}

[[maybe_unused]] const bool kInstalled = [] {
  btAlignedAllocSetCustom(allocate, std::free);
  return true;
}();

}  // namespace
}  // namespace crossgait
