// Counts the allocations of a thread or of all, to prove that a step makes none.
#pragma once

#include <cstddef>

namespace crossgait {

/// Counts, while it lives, every allocation that this thread makes through malloc and its kin: operator new,
/// the standard library, Eigen and the engines all end there. Scopes may nest; each counts on its own.
/// Linked in as the object library crossgait_allocation_counter, which replaces malloc for the whole program,
/// or hooks the sanitizer's where there is one.
class AllocationScope {
 public:
  AllocationScope() noexcept;
  ~AllocationScope() = default;
  AllocationScope(const AllocationScope&) = delete;
  AllocationScope& operator=(const AllocationScope&) = delete;

  /// Counts allocations since construction; reallocations count as one each.
  std::size_t count() const noexcept;

 private:
  std::size_t before_;
};

/// Counts the same for every thread of the process: for what shares its work out to threads of its own.
class ProcessAllocationScope {
 public:
  ProcessAllocationScope() noexcept;
  ~ProcessAllocationScope() = default;
  ProcessAllocationScope(const ProcessAllocationScope&) = delete;
  ProcessAllocationScope& operator=(const ProcessAllocationScope&) = delete;

  std::size_t count() const noexcept;

 private:
  std::size_t before_;
};

/// Stops counting on this thread while it lives: for calls into an engine, whose allocations are its own.
class AllocationPause {
 public:
  AllocationPause() noexcept;
  ~AllocationPause();
  AllocationPause(const AllocationPause&) = delete;
  AllocationPause& operator=(const AllocationPause&) = delete;
};

}  // namespace crossgait
