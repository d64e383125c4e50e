#include "backends/mujoco/engine_call.h"

#include <algorithm>
#include <csetjmp>
#include <cstring>

namespace crossgait::mujoco {
namespace {

// A call in progress.
struct Call {
  CalledFor who;
  ErrorText* error;
  Call* outer;  // a callback may make a call within a call
  ThreadHandlers outer_handlers;
  std::jmp_buf way_out;
};

// The innermost one of this thread. In the thread's own block from its beginning, so that the first step in a
// thread allocates nothing for it.
[[gnu::tls_model("initial-exec")]] thread_local Call* current = nullptr;

// An exception would have to pass through MuJoCo's C code and what may be noexcept above it.
void leave_call(const char* message) {
  Call& call = *current;
  if (call.error != nullptr) {
    const std::size_t length = std::min(std::strlen(message), call.error->size() - 1);
    std::memcpy(call.error->data(), message, length);
    (*call.error)[length] = '\0';
  }
  std::longjmp(call.way_out, 1);  // over C alone
}

void throw_error(const char* message) { throw std::runtime_error(fmt::format("MuJoCo: {}", message)); }

}  // namespace

bool run_in_mujoco(const CalledFor& who, void (*call)(void* data), void* data, ErrorText* error) noexcept {
  Call here{who, error, current, take_errors<leave_call>(), {}};
  current = &here;
  volatile bool finished = false;
  if (setjmp(here.way_out) == 0) {
    call(data);
    finished = true;
  }
  give_back(here.outer_handlers);
  current = here.outer;
  return finished;
}

ThrowMujocoErrors::ThrowMujocoErrors() noexcept : before_(take_errors<throw_error>()) {}

ThrowMujocoErrors::~ThrowMujocoErrors() { give_back(before_); }

TerrainCollision* collision_of(const mjModel* model) noexcept {
  return current != nullptr && current->who.model == model ? current->who.collision : nullptr;
}

}  // namespace crossgait::mujoco
