#include "python/bindings/terms.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include <fmt/format.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "env/env_model.h"
#include "env/quadruped_env.h"
#include "physics/core/error.h"
#include "python/bindings/arrays.h"
#include "python/bindings/batch.h"
#include "python/bindings/environment.h"

namespace crossgait::python {
namespace {

// An object of Python's that C++ holds: in a dict of Python's, where the collector and the end of the process
// find it. Functions of a module hold whatever is in it, configurations and environments too.
class Held {
 public:
  /// The interpreter's lock is held.
  explicit Held(const nb::object& object) { dict()[key()] = object; }
  ~Held() {
    if (!nb::is_alive()) return;
    const nb::gil_scoped_acquire acquire;
    if (const nb::object held = find_dict(); held.is_valid()) held.attr("pop")(key(), nb::none());
  }
  Held(const Held&) = delete;
  Held& operator=(const Held&) = delete;

  nb::object get() const { return nb::borrow(dict()[key()]); }
  /// As `get`, but not valid where the process ends and Python's dict is gone: for destructors.
  nb::object find() const noexcept {
    const nb::object held = find_dict();
    return held.is_valid() ? nb::object(held.attr("get")(key())) : held;
  }

 private:
  static constexpr const char* kModule = "crossgait.terms.running";
  static nb::object find_dict() noexcept {
    nb::object module = nb::steal(PyImport_GetModule(nb::str(kModule).ptr()));
    if (!module.is_valid()) PyErr_Clear();
    return module.is_valid() ? nb::object(module.attr("held")) : module;
  }
  static nb::object dict() { return nb::module_::import_(kModule).attr("held"); }
  nb::object key() const { return nb::cast(reinterpret_cast<std::uintptr_t>(this)); }
};

// The terms of one environment, in the hands of `crossgait.terms.EpisodeTerms`, which sees it as a batch of
// one.
class PythonExtension final : public EnvExtension {
 public:
  PythonExtension(std::shared_ptr<const Held> make, std::size_t reward_terms)
      : make_(std::move(make)), values_(reward_terms, 0.0) {}

  // What Python still holds of the batch finds it empty.
  ~PythonExtension() override {
    if (batch_ == nullptr || !nb::is_alive()) return;
    const nb::gil_scoped_acquire acquire;
    if (const nb::object batch = batch_->find(); batch.is_valid() && !batch.is_none())
      nb::inst_ptr<Batch>(batch)->single = nullptr;
  }

  void end(QuadrupedEnv&) override {
    if (terms_ == nullptr) return;  // the engine diverged before the episode began
    const nb::gil_scoped_acquire acquire;
    ++revision_;
    terms_->get().attr("end")();
  }

  void begin(QuadrupedEnv& env, std::uint64_t seed) override {
    const nb::gil_scoped_acquire acquire;
    ++revision_;
    if (batch_ == nullptr)
      batch_ = std::make_unique<Held>(nb::cast(Batch{this, &revision_, nullptr, &env, &revision_}));
    if (terms_ == nullptr) {  // which Python may have interrupted
      terms_ = std::make_unique<Held>(make_->get()(batch_->get()));
    }
    std::fill(values_.begin(), values_.end(), 0.0);
    terms_->get().attr("begin")(seed);
  }

  Step step(QuadrupedEnv&) override {
    const nb::gil_scoped_acquire acquire;
    ++revision_;
    const auto [reward, terminated, truncated, values] =
        nb::cast<std::tuple<double, bool, bool, std::vector<double>>>(terms_->get().attr("step")());
    values_ = values;
    return {reward, terminated, truncated};
  }

  void change(QuadrupedEnv&) override {
    const nb::gil_scoped_acquire acquire;
    ++revision_;
    terms_->get().attr("change")();
  }

  void observe(const QuadrupedEnv&, std::span<double> out) override {
    std::fill(out.begin(), out.end(), 0.0);
    if (out.empty() || terms_ == nullptr) return;  // null: the engine diverged before the episode began
    const nb::gil_scoped_acquire acquire;
    ++revision_;
    const auto numbers = numbers_of(terms_->get().attr("observe")());
    if (numbers.size() != out.size())
      throw ConfigError("terms", "observations", fmt::format("{} numbers", out.size()),
                        fmt::format("{}", numbers.size()));
    std::copy_n(numbers.data(), out.size(), out.begin());
  }

  std::span<const double> reward_terms() const noexcept override { return values_; }
  nb::object at_work() const { return terms_ == nullptr ? nb::none() : terms_->get(); }

  std::shared_ptr<const void> save() const override {
    const nb::gil_scoped_acquire acquire;
    return std::make_shared<const Held>(terms_->get().attr("save")());
  }

  void restore(const std::shared_ptr<const void>& saved) override {
    const nb::gil_scoped_acquire acquire;
    ++revision_;
    if (terms_ == nullptr) throw ConfigError("terms", "restore", "a reset before it", "none");
    terms_->get().attr("restore")(static_cast<const Held*>(saved.get())->get());
  }

 private:
  std::shared_ptr<const Held> make_;
  std::vector<double> values_;
  std::uint64_t revision_ = 0;
  std::unique_ptr<const Held> batch_, terms_;
};

using Entries = std::vector<std::tuple<std::string, std::string, double, double>>;

EnvConfig with_terms(const EnvConfig& config, const nb::object& terms, const nb::callable& make,
                     const std::vector<std::string>& names, const std::vector<std::string>& rewards,
                     const Entries& entries) {
  auto model = std::make_shared<EnvExtensionModel>();
  model->terms = names;
  model->reward_terms = rewards;
  for (const auto& [name, unit, least, most] : entries)
    model->observation.entries.push_back({name, unit, least, most});
  const std::size_t count = rewards.size();
  model->make = [make = std::make_shared<const Held>(make), count] {
    return std::make_unique<PythonExtension>(make, count);
  };
  model->source = std::make_shared<const Held>(terms);
  EnvConfig made = config;
  made.extension = std::move(model);
  return made;
}

}  // namespace

nb::object terms_at_work(const EnvExtension& extension) {
  return dynamic_cast<const PythonExtension&>(extension).at_work();
}

void bind_terms(nb::class_<EnvConfig>& config) {
  config
      .def("_with_terms", &with_terms, nb::arg("terms"), nb::arg("make"), nb::arg("names"),
           nb::arg("rewards"), nb::arg("entries"), "What `crossgait.with_terms` makes.")
      .def("_without_terms",
           [](EnvConfig config) {
             config.extension = nullptr;
             return config;
           })
      .def_prop_ro(
          "terms",
          [](const EnvConfig& config) -> nb::object {
            if (config.extension == nullptr) return nb::none();
            return nb::object(static_cast<const Held*>(config.extension->source.get())->get());
          },
          nb::sig("def terms(self) -> typing.Any"),
          "The `crossgait.Terms` that `crossgait.with_terms` added; None without.")
      .def(
          "_layouts",
          [](const EnvConfig& config) {
            const auto model = EnvModel::make(config);
            return nb::make_tuple(layout(model->interface.observation), layout(model->interface.action),
                                  model->layout);
          },
          "Layouts of observation and action, and their hash.");
}

}  // namespace crossgait::python
