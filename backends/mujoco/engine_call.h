// A call into MuJoCo for one world: what is particular to Crossgait holds for its length and in its thread
// only.
#pragma once

#include <array>
#include <cstddef>
#include <stdexcept>
#include <type_traits>

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include "backends/mujoco/version.h"

namespace crossgait::mujoco {

class TerrainCollision;

/// Names the world that MuJoCo is called for.
struct CalledFor {
  const mjModel* model;
  TerrainCollision* collision;  ///< of the model with its terrain
};

/// Holds what MuJoCo said went wrong, zero-terminated.
using ErrorText = std::array<char, 256>;

/// Runs call(data), which calls MuJoCo. Where MuJoCo reports an error (mju_error: a stack too small, a size
/// that does not fit, ...) the call ends there, and mjData is in no state to be used before mj_resetData.
/// Warnings are kept in mjData::warning only. Handlers that others installed are not touched: MuJoCo has
/// others for each thread, which are set for the length of the call. Allocates nothing.
/// @param call  skipped by a jump on an error: nothing in it may need a destructor
/// @returns whether MuJoCo reported no error; if it did, `error` (if given) says which
bool run_in_mujoco(const CalledFor& who, void (*call)(void* data), void* data, ErrorText* error) noexcept;

/// Calls a function object without arguments in the same way.
template <typename Call>
bool try_in_mujoco(const CalledFor& who, Call call, ErrorText* error = nullptr) noexcept {
  static_assert(std::is_trivially_destructible_v<Call>);
  return run_in_mujoco(
      who, [](void* data) { (*static_cast<Call*>(data))(); }, &call, error);
}

/// Calls it likewise, and throws what MuJoCo said. @throws std::runtime_error with MuJoCo's words
template <typename Call>
void in_mujoco(const CalledFor& who, Call call) {
  ErrorText error{};
  if (!try_in_mujoco(who, call, &error)) throw std::runtime_error(fmt::format("MuJoCo: {}", error.data()));
}

/// Throws, while one lives, an error of MuJoCo in this thread as std::runtime_error: for those functions that
/// are written in C++ and hold what has to be released (mj_loadXML, its lock).
class ThrowMujocoErrors {
 public:
  ThrowMujocoErrors() noexcept;
  ~ThrowMujocoErrors();
  ThrowMujocoErrors(const ThrowMujocoErrors&) = delete;
  ThrowMujocoErrors& operator=(const ThrowMujocoErrors&) = delete;

 private:
  ThreadHandlers before_;
};

/// Returns the finder of `model`'s contacts, if this thread is within a call for that model; otherwise none.
TerrainCollision* collision_of(const mjModel* model) noexcept;

}  // namespace crossgait::mujoco
