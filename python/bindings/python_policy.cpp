#include "python/bindings/python_policy.h"

#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <nanobind/stl/string.h>

#include "policy/mlp_policy.h"
#include "python/bindings/arrays.h"
#include "python/bindings/inputs.h"
#include "python/bindings/shown.h"

namespace crossgait::python {
namespace {

class FunctionPolicy final : public Policy {
 public:
  FunctionPolicy(const PythonPolicy& policy, const PolicyInterface& interface,
                 std::shared_ptr<FirstFailure> failure)
      : Policy(policy.name, interface), make_(policy.make), failure_(std::move(failure)) {}

  bool has_failed() const noexcept override { return failure_->noted(); }

 private:
  template <typename Call>
  void guarded(const Call& call) noexcept {
    if (failure_->noted()) return;
    const nb::gil_scoped_acquire acquire;
    try {
      call();
    } catch (...) {
      failure_->note(std::current_exception());
    }
  }

  void do_reset(std::uint64_t) noexcept override {
    guarded([this] {
      act_.emplace(make_.get()());
      if (PyCallable_Check(act_->get().ptr()) == 0)
        throw ConfigError(name(), "make", "a function that returns a function", type_called(act_->get()));
    });
  }

  void do_act(std::span<const double> observation, std::span<double> action) noexcept override {
    std::fill(action.begin(), action.end(), 0.0);
    guarded([&] {
      const NewArray<double> seen(observation.size());
      std::copy(observation.begin(), observation.end(), seen.data);
      const nb::object returned = act_->get()(seen.array);
      const auto numbers = numbers_of(returned);
      if (numbers.ndim() != 1 || numbers.size() != action.size())
        throw ConfigError(name(), "action", fmt::format("{} numbers", action.size()), shown(returned));
      std::copy_n(numbers.data(), action.size(), action.begin());
    });
  }

  SharedObject make_;
  std::optional<SharedObject> act_;
  std::shared_ptr<FirstFailure> failure_;
};

}  // namespace

NamedPolicy PythonPolicy::named(const std::shared_ptr<FirstFailure>& failure) const {
  return {name, [*this, failure](const PolicyInterface& interface) {
            return std::make_unique<FunctionPolicy>(*this, interface, failure);
          }};
}

NamedPolicy named(const PolicyChoice& choice, const std::shared_ptr<FirstFailure>& failure) {
  if (const auto* text = std::get_if<std::string>(&choice)) return find_policy(*text);
  if (const auto* function = std::get_if<PythonPolicy>(&choice)) return function->named(failure);
  const auto shared = std::make_shared<const BundlePolicy>(std::get<BundlePolicy>(choice));
  return {shared->name, [shared](const PolicyInterface& interface) {
            return std::make_unique<MlpPolicy>(shared->bundle, shared->name, interface);
          }};
}

std::string name_of(const PolicyChoice& choice) {
  if (const auto* text = std::get_if<std::string>(&choice)) return *text;
  if (const auto* function = std::get_if<PythonPolicy>(&choice)) return function->name;
  return std::get<BundlePolicy>(choice).name;
}

StageProgress until(const std::shared_ptr<FirstFailure>& failure, const StageProgress& progress) {
  return [failure, progress](const std::string& stage, double share) {
    if (failure->noted()) throw Interrupted();
    progress(stage, share);
  };
}

void bind_python_policy(nb::module_& m) {
  nb::class_<PythonPolicy>(m, "FunctionPolicy", nb::type_slots(kHolderSlots<PythonPolicy>),
                           "A policy of your own: what studies take beside names, files and `Policy`.")
      .def(
          "__init__",
          [](PythonPolicy* self, const nb::callable& make, const std::string& name) {
            check_maker(make, "FunctionPolicy", "an observation");
            new (self) PythonPolicy{name, SharedObject(make)};
          },
          nb::arg("make"), nb::arg("name") = "function",
          nb::sig("def __init__(self, make: collections.abc.Callable[[], collections.abc.Callable[["
                  "numpy.typing.NDArray[numpy.float64]], numpy.typing.ArrayLike]], name: str = 'function') "
                  "-> None"),
          "`make` returns a fresh function for every episode, so that what it remembers (a recurrent "
          "network's state) is "
          "its own: of an observation (float64, as the environment gives it) it returns an action. Entries "
          "are clipped "
          "to their bounds; what is not finite counts as zero.")
      .def_ro("name", &PythonPolicy::name)
      .def("__repr__",
           [](const PythonPolicy& p) { return fmt::format("<crossgait.FunctionPolicy {}>", quoted(p.name)); })
      .def("__reduce__", [](nb::handle self) {
        const auto& policy = nb::cast<const PythonPolicy&>(self);
        return nb::make_tuple(self.type(), nb::make_tuple(policy.make.get(), policy.name));
      });
  nb::class_<BundlePolicy>(m, "_BundlePolicy", "A network in memory, as studies take it.")
      .def(nb::new_([](const PolicyBundle& bundle, const std::string& name) {
             return BundlePolicy{bundle, name};
           }),
           nb::arg("bundle"), nb::arg("name"));
}

}  // namespace crossgait::python
