#include "crossgait/backends/mujoco/engine_call.h"

#include <csetjmp>
#include <cstring>

// MuJoCo's handlers of one thread, which come before those of the process (mju_user_error, mju_user_warning).
// The library exports them for its Python bindings; no public header declares them.
extern "C" {
using MujocoHandler = void (*)(const char* message);
MJAPI MujocoHandler _mjPRIVATE__get_tls_error_fn();        // NOLINT(bugprone-reserved-identifier)
MJAPI void _mjPRIVATE__set_tls_error_fn(MujocoHandler);    // NOLINT(bugprone-reserved-identifier)
MJAPI MujocoHandler _mjPRIVATE__get_tls_warning_fn();      // NOLINT(bugprone-reserved-identifier)
MJAPI void _mjPRIVATE__set_tls_warning_fn(MujocoHandler);  // NOLINT(bugprone-reserved-identifier)
}

namespace crossgait::mujoco {
namespace {

// A call in progress.
struct Call {
  CalledFor who;
  ErrorText* error;
  Call* outer;  // a callback may make a call within a call
  MujocoHandler outer_error, outer_warning;
  std::jmp_buf way_out;
};

// The innermost one of this thread. In the thread's own block from its beginning, so that the first step in a
// thread allocates nothing for it.
[[gnu::tls_model("initial-exec")]] thread_local Call* current = nullptr;

// An exception would have to pass through MuJoCo's C code and what may be noexcept above it.
void leave_call(const char* message) {
  Call& call = *current;
  if (call.error != nullptr) {
    std::strncpy(call.error->data(), message, call.error->size() - 1);
    call.error->back() = '\0';
  }
  std::longjmp(call.way_out, 1);  // over C alone
}

void throw_error(const char* message) { throw std::runtime_error(fmt::format("MuJoCo: {}", message)); }

// MuJoCo's default prints, and writes a log file into the working directory.
void ignore_warning(const char* /*message*/) {}

}  // namespace

bool run_in_mujoco(const CalledFor& who, void (*call)(void* data), void* data, ErrorText* error) noexcept {
  Call here{who, error, current, _mjPRIVATE__get_tls_error_fn(), _mjPRIVATE__get_tls_warning_fn(), {}};
  current = &here;
  _mjPRIVATE__set_tls_error_fn(leave_call);
  _mjPRIVATE__set_tls_warning_fn(ignore_warning);
  volatile bool finished = false;
  if (setjmp(here.way_out) == 0) {
    call(data);
    finished = true;
  }
  _mjPRIVATE__set_tls_error_fn(here.outer_error);
  _mjPRIVATE__set_tls_warning_fn(here.outer_warning);
  current = here.outer;
  return finished;
}

ThrowMujocoErrors::ThrowMujocoErrors() noexcept
    : error_(_mjPRIVATE__get_tls_error_fn()), warning_(_mjPRIVATE__get_tls_warning_fn()) {
  _mjPRIVATE__set_tls_error_fn(throw_error);
  _mjPRIVATE__set_tls_warning_fn(ignore_warning);
}

ThrowMujocoErrors::~ThrowMujocoErrors() {
  _mjPRIVATE__set_tls_error_fn(error_);
  _mjPRIVATE__set_tls_warning_fn(warning_);
}

TerrainCollision* collision_of(const mjModel* model) noexcept {
  return current != nullptr && current->who.model == model ? current->who.collision : nullptr;
}

}  // namespace crossgait::mujoco
