#include "tests/support/allocation_counter.h"

#include <atomic>
#include <cerrno>
#include <cstdlib>

namespace crossgait {
namespace {

// Plain thread-local integers: no constructor, so that counting works before main and never allocates by
// itself.
thread_local std::size_t allocations = 0;
thread_local int pauses = 0;
std::atomic<std::size_t> allocations_of_all{0};

void count_allocation() noexcept {
  if (pauses != 0) return;
  ++allocations;
  allocations_of_all.fetch_add(1, std::memory_order_relaxed);
}

}  // namespace

AllocationScope::AllocationScope() noexcept : before_(allocations) {}
std::size_t AllocationScope::count() const noexcept { return allocations - before_; }

ProcessAllocationScope::ProcessAllocationScope() noexcept : before_(allocations_of_all) {}
std::size_t ProcessAllocationScope::count() const noexcept { return allocations_of_all - before_; }

AllocationPause::AllocationPause() noexcept { ++pauses; }
AllocationPause::~AllocationPause() { --pauses; }

}  // namespace crossgait

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)

// Declared in <sanitizer/allocator_interface.h>, which g++ does not ship.
// NOLINTNEXTLINE(bugprone-reserved-identifier)
extern "C" int __sanitizer_install_malloc_and_free_hooks(void (*on_malloc)(const volatile void*, std::size_t),
                                                         void (*on_free)(const volatile void*));

namespace {

// The sanitizers own malloc and call back on every allocation.
[[maybe_unused]] const int hooked = __sanitizer_install_malloc_and_free_hooks(
    [](const volatile void*, std::size_t) { crossgait::count_allocation(); }, [](const volatile void*) {});

}  // namespace

#else

// glibc's own allocator under the names it keeps for programs that replace malloc. free stays glibc's: all of
// these hand out its memory.
// NOLINTBEGIN(bugprone-reserved-identifier,readability-inconsistent-declaration-parameter-name): glibc's
// names
extern "C" {

void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

void* malloc(std::size_t size) {
  crossgait::count_allocation();
  return __libc_malloc(size);
}

void* calloc(std::size_t count, std::size_t size) {
  crossgait::count_allocation();
  return __libc_calloc(count, size);
}

void* realloc(void* memory, std::size_t size) {
  crossgait::count_allocation();
  return __libc_realloc(memory, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) {
  crossgait::count_allocation();
  return __libc_memalign(alignment, size);
}

void* memalign(std::size_t alignment, std::size_t size) { return aligned_alloc(alignment, size); }

int posix_memalign(void** memory, std::size_t alignment, std::size_t size) {
  void* block = aligned_alloc(alignment, size);
  if (block == nullptr) return ENOMEM;
  *memory = block;
  return 0;
}

}  // extern "C"
   // NOLINTEND(bugprone-reserved-identifier,readability-inconsistent-declaration-parameter-name)

#endif
