// What moves: a walk of Crossgait's own gaits, or whatever a function in Python wants.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <variant>

#include <nanobind/nanobind.h>

#include "python/bindings/walk_config.h"

namespace crossgait::python {

namespace nb = nanobind;

/// Holds a Python object that any thread may hold and let go of.
class SharedObject {
 public:
  explicit SharedObject(nb::object object);
  /// Returns the object; call it with the interpreter's lock held.
  const nb::object& get() const { return *object_; }

 private:
  std::shared_ptr<const nb::object> object_;
};

/// The collector has to see what a class with a member `make` holds: functions of a module hold whatever is
/// in it.
template <typename Holder>
inline PyType_Slot kHolderSlots[] = {
    {Py_tp_traverse, reinterpret_cast<void*>(+[](PyObject* self, visitproc visit, void* arg) -> int {
       Py_VISIT(Py_TYPE(self));
       if (nb::inst_ready(self)) Py_VISIT(nb::inst_ptr<Holder>(self)->make.get().ptr());
       return 0;
     })},
    {Py_tp_clear, reinterpret_cast<void*>(+[](PyObject* self) -> int {
       nb::inst_ptr<Holder>(self)->make = SharedObject(nb::none());
       return 0;
     })},
    {0, nullptr}};

enum class Targets { kJoints, kFeet };

/// Runs a controller in Python, in the world and with the timing of `walk`, whose gait is not used.
struct PythonController {
  PythonWalk walk;
  std::string name;
  Targets targets = Targets::kJoints;
  SharedObject make;  ///< returns a fresh function of a State, which returns targets

  /// Makes a setup whose runs call into the interpreter from whatever thread they are on.
  WalkSetup setup() const;
};

using Subject = std::variant<PythonWalk, PythonController>;

const WalkConfig& config_of(const Subject& subject);
WalkSetup setup_of(const Subject& subject);

void bind_behaviour(nb::module_& m);

}  // namespace crossgait::python
