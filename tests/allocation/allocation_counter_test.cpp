#include "tests/support/allocation_counter.h"

#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "physics/core/worker_pool.h"

namespace crossgait {
namespace {

/// Makes the compiler believe that `pointer` is used, or it may leave out an allocation and its release.
void keep(const void* pointer) { asm volatile("" : : "r"(pointer) : "memory"); }

/// Allocations made by `action`.
template <typename Action>
std::size_t allocations_in(Action action) {
  const AllocationScope scope;
  action();
  return scope.count();
}

TEST(AllocationCounter, CountsNothingWhereNothingIsAllocated) {
  EXPECT_EQ(allocations_in([] {
              Eigen::Matrix4d m = Eigen::Matrix4d::Random();
              m = (m * m.transpose()).eval();
              keep(m.data());
            }),
            0U);
}

TEST(AllocationCounter, CountsNew) {
  EXPECT_EQ(allocations_in([] { keep(std::make_unique<int>(1).get()); }), 1U);
  EXPECT_EQ(allocations_in([] { keep(std::vector<double>(10).data()); }), 1U);
  EXPECT_EQ(allocations_in([] { keep(std::string(100, 'x').data()); }), 1U);
}

TEST(AllocationCounter, CountsOverAlignedNew) {
  struct alignas(64) Line {
    double values[8];
  };
  EXPECT_EQ(allocations_in([] { keep(std::make_unique<Line>().get()); }), 1U);
}

TEST(AllocationCounter, CountsEigen) {
  EXPECT_EQ(allocations_in([] { keep(Eigen::VectorXd::Zero(100).eval().data()); }), 1U);
}

TEST(AllocationCounter, CountsMallocCallocAndRealloc) {
  EXPECT_EQ(allocations_in([] {
              void* memory = std::malloc(8);
              keep(memory);
              memory = std::realloc(memory, 100000);
              keep(memory);
              std::free(memory);
            }),
            2U);
  EXPECT_EQ(allocations_in([] {
              void* memory = std::calloc(4, 8);
              keep(memory);
              std::free(memory);
            }),
            1U);
}

TEST(AllocationCounter, CountsAlignedAllocations) {
#ifdef __SANITIZE_THREAD__
  GTEST_SKIP() << "the thread sanitizer's hooks do not see aligned_alloc and posix_memalign";
#endif
  EXPECT_EQ(allocations_in([] {
              void* memory = std::aligned_alloc(64, 128);
              keep(memory);
              EXPECT_EQ(reinterpret_cast<std::uintptr_t>(memory) % 64, 0U);
              std::free(memory);
            }),
            1U);
  EXPECT_EQ(allocations_in([] {
              void* memory = nullptr;
              EXPECT_EQ(posix_memalign(&memory, 64, 128), 0);
              keep(memory);
              EXPECT_EQ(reinterpret_cast<std::uintptr_t>(memory) % 64, 0U);
              std::free(memory);
            }),
            1U);
}

TEST(AllocationCounter, PauseCountsNothingAndNests) {
  EXPECT_EQ(allocations_in([] {
              const AllocationPause outer;
              { const AllocationPause inner; }
              keep(std::make_unique<int>(1).get());
            }),
            0U);
  EXPECT_EQ(allocations_in([] { keep(std::make_unique<int>(1).get()); }), 1U);
}

TEST(AllocationCounter, ScopesNest) {
  const AllocationScope outer;
  keep(std::make_unique<int>(1).get());
  const AllocationScope inner;
  keep(std::make_unique<int>(2).get());
  EXPECT_EQ(inner.count(), 1U);
  EXPECT_EQ(outer.count(), 2U);
}

TEST(AllocationCounter, CountsThisThreadOnly) {
  std::size_t counted_there = 0;
  const AllocationScope scope;
  std::size_t made_by_thread_start = 0;
  {
    std::thread other([&] {
      counted_there = allocations_in([] {
        for (int i = 0; i < 1000; ++i) keep(std::make_unique<int>(i).get());
      });
    });
    made_by_thread_start = scope.count();
    other.join();
  }
  EXPECT_EQ(counted_there, 1000U);
  EXPECT_EQ(scope.count(), made_by_thread_start);
}

TEST(AllocationCounter, OfTheProcessCountsEveryThread) {
  WorkerPool pool(2);
  // Both workers have to be at it: each waits for the other.
  std::atomic<int> waiting = 0;
  const auto meet = [&waiting](std::size_t) {
    ++waiting;
    while (waiting < 2) std::this_thread::yield();
  };
  pool.run(2, meet);  // a thread's first breath allocates, too
  waiting = 0;
  const ProcessAllocationScope all;
  const AllocationScope here;
  pool.run(2, [&](std::size_t worker) {
    meet(worker);
    for (int i = 0; i < 100; ++i) keep(std::make_unique<int>(i).get());
  });
  EXPECT_EQ(here.count(), 100U);
  EXPECT_EQ(all.count(), 200U);
}

}  // namespace
}  // namespace crossgait
