#include "physics/core/interruption.h"

#include <utility>

namespace crossgait {
namespace {

thread_local Interruptible* interruptible_here = nullptr;
thread_local const std::function<void()>* have_owner_ask = nullptr;

}  // namespace

Interruptible::Interruptible(std::function<bool()> asked)
    : asked_(std::move(asked)), outer_(std::exchange(interruptible_here, this)) {}

Interruptible::~Interruptible() { interruptible_here = outer_; }

Interruptible* Interruptible::current() noexcept { return interruptible_here; }

bool Interruptible::came() {
  if (!came_ && std::this_thread::get_id() == thread_ && asked_()) came_ = true;
  return came_;
}

WorkingFor::WorkingFor(Interruptible* other, const std::function<void()>& have_it_ask) noexcept {
  interruptible_here = other;
  have_owner_ask = &have_it_ask;
}

WorkingFor::~WorkingFor() {
  interruptible_here = nullptr;
  have_owner_ask = nullptr;
}

bool interruption_came() {
  if (interruption_is_asked) return true;
  if (interruptible_here == nullptr) return false;
  if (have_owner_ask != nullptr) (*have_owner_ask)();
  return interruptible_here->came();
}

}  // namespace crossgait
