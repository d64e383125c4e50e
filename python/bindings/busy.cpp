#include "python/bindings/busy.h"

#include <set>
#include <stdexcept>

namespace crossgait::python {
namespace {

// Under the interpreter's lock. In a fork, whose other threads are gone, what they worked at stays marked: it
// is half done for ever.
std::set<const void*>& worked_at() {
  static std::set<const void*> objects;
  return objects;
}

}  // namespace

void check_idle(const void* object) {
  if (worked_at().contains(object))
    throw std::runtime_error(
        "another thread is at work in this object: one thread at a time, or an object each");
}

Working::Working(const void* object) : object_(object) {
  check_idle(object);
  worked_at().insert(object);
  release_.emplace();
}

Working::~Working() {
  release_.reset();  // the interpreter's lock is held again
  worked_at().erase(object_);
}

}  // namespace crossgait::python
