#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include "backends/registry.h"
#include "env/vector_env.h"
#include "physics/core/error.h"
#include "python/bindings/arrays.h"
#include "python/bindings/batch.h"
#include "python/bindings/bindings.h"
#include "python/bindings/busy.h"
#include "python/bindings/environment.h"
#include "python/bindings/step_info.h"

namespace crossgait::python {
namespace {

/// N environments; the arrays that it returns are its caller's, and new in every step.
struct VectorEnvironment {
  std::unique_ptr<VectorEnv> envs;
  AutoReset auto_reset;
  ObservationBounds bounds;
  std::vector<double> actions = {};  // of float32
  // Of the last step: numbers out of bounds, and what it did where it ended an episode that has begun anew.
  std::vector<std::vector<std::size_t>> outside = {}, final_outside = {};
  std::vector<StepInfo> final_infos = {};
  std::vector<std::uint8_t> ended = {};

  void find_outside(const double* observations, std::vector<std::vector<std::size_t>>& found) const {
    const std::size_t width = envs->observation_size();
    for (std::size_t i = 0; i < found.size(); ++i) bounds.find({observations + i * width, width}, found[i]);
  }
  void note_ended(const bool* terminated, const bool* truncated, const double* observations) {
    const std::size_t width = envs->observation_size();
    for (std::size_t i = 0; i < ended.size(); ++i) {
      ended[i] = terminated[i] || truncated[i] ? 1 : 0;
      if (ended[i] != 0) bounds.find({observations + i * width, width}, final_outside[i]);
    }
  }
  const RewardTerms& weights() const { return envs->environment(0).config().reward; }
};

const void* identity_of(const VectorEnvironment& v) noexcept { return v.envs.get(); }

AutoReset auto_reset_of(const std::string& name) {
  if (name == "next_step") return AutoReset::kNextStep;
  if (name == "same_step") return AutoReset::kSameStep;
  if (name == "disabled") return AutoReset::kDisabled;
  throw ConfigError("vector environment", "auto_reset", "next_step, same_step or disabled", name);
}

VectorEnvironment make(const EnvConfig& config, std::size_t environments, const std::string& engine,
                       std::size_t workers, const std::string& auto_reset) {
  const auto listen_to_signals = [](double) {
    const nb::gil_scoped_acquire acquire;
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
  };
  const VectorEnvOptions options{environments, workers, auto_reset_of(auto_reset), listen_to_signals};
  const nb::gil_scoped_release release;
  const Interruption interruption;
  const Engine made_in = find_engine(engine.empty() ? config.engine : engine);
  auto envs = std::make_unique<VectorEnv>(config, made_in, options);
  const Layout& observation = envs->environment(0).observation_layout();
  VectorEnvironment made{std::move(envs), options.auto_reset, ObservationBounds(observation)};
  made.outside.resize(environments);
  made.final_outside.resize(environments);
  made.ended.resize(environments);
  if (made.auto_reset == AutoReset::kSameStep) made.final_infos.resize(environments);
  return made;
}

// One from which every environment's follows, or each its own.
using Seeds = std::variant<std::uint64_t, std::vector<std::uint64_t>>;

nb::object reset(VectorEnvironment& self, const Seeds& seeds) {
  const std::size_t size = self.envs->size() * self.envs->observation_size();
  const NewArray<double> observations(self.envs->size(), self.envs->observation_size());
  work_at(identity_of(self), [&](Interruption&) {
    std::visit([&](const auto& s) { self.envs->reset(s, {observations.data, size}); }, seeds);
    self.find_outside(observations.data, self.outside);
    std::fill(self.ended.begin(), self.ended.end(), 0);
  });
  return observations.array;
}

nb::tuple step(VectorEnvironment& self, const AnyArray& actions) {
  const std::size_t count = self.envs->size(), width = self.envs->observation_size();
  const auto numbers = doubles(actions, std::array{count, self.envs->action_size()}, "actions", self.actions);
  const bool keeps_final = self.auto_reset == AutoReset::kSameStep;
  const NewArray<double> observations(count, width), rewards(count), last(keeps_final ? count : 0, width);
  const NewArray<bool> terminated(count), truncated(count);
  std::fill_n(last.data, keeps_final ? count * width : 0, 0.0);  // of those whose episode goes on
  static_assert(sizeof(bool) == sizeof(std::uint8_t));           // and the core writes 0 or 1
  const auto flags = [count](const NewArray<bool>& array) {
    return std::span(reinterpret_cast<std::uint8_t*>(array.data), count);
  };
  work_at(identity_of(self), [&](Interruption&) {
    self.envs->step(numbers, {{observations.data, count * width},
                              {rewards.data, count},
                              flags(terminated),
                              flags(truncated),
                              {last.data, keeps_final ? count * width : 0},
                              self.final_infos});
    self.find_outside(observations.data, self.outside);
    if (keeps_final) self.note_ended(terminated.data, truncated.data, last.data);
  });
  return nb::make_tuple(observations.array, rewards.array, terminated.array, truncated.array,
                        keeps_final ? last.array : nb::none());
}

using Observations = nb::ndarray<double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

// The rows of the caller's array, which are written where `which` says.
std::span<double> rows_of(const VectorEnvironment& self, const AnyArray& which, const Observations& array) {
  const std::size_t count = self.envs->size(), width = self.envs->observation_size();
  if (which.ndim() != 1 || which.size() != count || which.dtype() != nb::dtype<bool>())
    throw ConfigError("vector environment", "which", "bool of shape (" + std::to_string(count) + ",)",
                      "another array");
  if (array.shape(0) != count || array.shape(1) != width)
    throw ConfigError("vector environment", "observations", "shape " + shape_text(std::array{count, width}),
                      "shape " + shape_text(std::array{array.shape(0), array.shape(1)}));
  return {array.data(), count * width};
}

void reset_some(VectorEnvironment& self, const AnyArray& which, const Observations& observations,
                const std::optional<Seeds>& seeds) {
  const std::span<double> rows = rows_of(self, which, observations);
  const std::span flags(static_cast<const std::uint8_t*>(which.data()), which.size());
  work_at(identity_of(self), [&](Interruption&) {
    if (seeds) {
      std::visit([&](const auto& s) { self.envs->reset_some(flags, s, rows); }, *seeds);
    } else {
      self.envs->reset_some(flags, rows);
    }
    self.find_outside(rows.data(), self.outside);
  });
}

void observe_start(VectorEnvironment& self, const AnyArray& which, const Observations& observations) {
  const std::span<double> rows = rows_of(self, which, observations);
  const std::size_t width = self.envs->observation_size();
  for (std::size_t i = 0; i < self.envs->size(); ++i) {
    if (static_cast<const bool*>(which.data())[i])
      self.envs->edit(i).observe_start(rows.subspan(i * width, width));
  }
  self.find_outside(rows.data(), self.outside);
}

nb::dict infos_of(const VectorEnvironment& self) {
  return infos(
      self.envs->size(), self.weights(), [&](std::size_t i) { return &self.envs->environment(i).info(); },
      [&](std::size_t i) { return self.bounds.names(self.outside[i]); });
}

nb::dict final_infos_of(const VectorEnvironment& self) {
  return infos(
      self.envs->size(), self.weights(),
      [&](std::size_t i) { return self.ended[i] != 0 ? &self.final_infos[i] : nullptr; },
      [&](std::size_t i) { return self.bounds.names(self.final_outside[i]); });
}

void check_index(const VectorEnvironment& self, std::size_t i) {
  if (i >= self.envs->size())
    throw nb::index_error(
        fmt::format("index: expected one from 0 to {}, found {}", self.envs->size() - 1, i).c_str());
}

nb::dict info_of(const VectorEnvironment& self, std::size_t i) {
  check_index(self, i);
  return info(self.envs->environment(i).info(), self.weights(), self.bounds.names(self.outside[i]));
}

nb::object final_info_of(const VectorEnvironment& self, std::size_t i) {
  check_index(self, i);
  if (self.ended[i] == 0) return nb::none();
  return info(self.final_infos[i], self.weights(), self.bounds.names(self.final_outside[i]));
}

EnvironmentView environment_of(VectorEnvironment& self, std::size_t i) {
  check_index(self, i);
  return {self.envs.get(), i};
}

}  // namespace

void bind_vector_environment(nb::module_& m) {
  nb::class_<VectorEnvironment>(
      m, "VectorEnvironment",
      "Many environments of one configuration, stepped on several threads. Results are the "
      "same, bit for bit, for any number of workers. For one thread at a time: while one steps them, "
      "another's "
      "call raises RuntimeError.")
      .def(nb::new_(&make), nb::arg("config"), nb::arg("environments"), nb::kw_only(), nb::arg("engine") = "",
           nb::arg("workers") = 1, nb::arg("auto_reset") = "next_step",
           "`auto_reset` is next_step, same_step or disabled, as Gymnasium's AutoresetMode. Raises "
           "ConfigError.")
      .def_prop_ro("size", guarded([](const VectorEnvironment& v) { return v.envs->size(); }))
      .def_prop_ro("workers", guarded([](const VectorEnvironment& v) { return v.envs->workers(); }))
      .def_prop_ro("config",
                   guarded([](const VectorEnvironment& v) { return v.envs->environment(0).config(); }))
      .def_prop_ro("engine",
                   guarded([](const VectorEnvironment& v) { return v.envs->environment(0).engine().name(); }))
      .def_prop_ro(
          "observation_layout", guarded([](const VectorEnvironment& v) {
            return layout(v.envs->environment(0).observation_layout());
          }),
          nb::sig("def observation_layout(self) -> list[tuple[str, str, float, float, float, float]]"))
      .def_prop_ro("action_layout", guarded([](const VectorEnvironment& v) {
                     return layout(v.envs->environment(0).action_layout());
                   }),
                   nb::sig("def action_layout(self) -> list[tuple[str, str, float, float, float, float]]"))
      .def("reset", guarded(&reset), nb::arg("seed"),
           nb::sig("def reset(self, seed: int | collections.abc.Sequence[int]) -> "
                   "numpy.typing.NDArray[numpy.float64]"),
           "Begins an episode everywhere, of one seed from which each follows, or of one each, with which a "
           "single environment begins the same; observations are a new array, one row per environment.")
      .def("step", guarded(&step), nb::arg("actions"),
           nb::sig("def step(self, actions: numpy.typing.NDArray[typing.Any]) -> "
                   "tuple[numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64], "
                   "numpy.typing.NDArray[numpy.bool_], numpy.typing.NDArray[numpy.bool_], "
                   "numpy.typing.NDArray[numpy.float64] | None]"),
           "One policy step everywhere: (observations, rewards, terminated, truncated, final_observations). "
           "All are new "
           "arrays, the caller's to keep. With same_step rows of `final_observations` are set where an "
           "episode ended in "
           "this step, and mean nothing elsewhere; with next_step it is None. Raises ConfigError.")
      .def("reset_some", guarded(&reset_some), nb::arg("which"), nb::arg("observations").noconvert(),
           nb::arg("seed") = nb::none(),
           nb::sig("def reset_some(self, which: numpy.typing.NDArray[numpy.bool_], observations: "
                   "numpy.typing.NDArray[numpy.float64], seed: int | collections.abc.Sequence[int] | None = "
                   "None) -> None"),
           "Begins the next episode of those, or that of a seed as `reset` does, and writes their rows of "
           "`observations`, the caller's float64 array. Raises ConfigError.")
      .def("observe_start", guarded(&observe_start), nb::arg("which"), nb::arg("observations").noconvert(),
           nb::sig("def observe_start(self, which: numpy.typing.NDArray[numpy.bool_], observations: "
                   "numpy.typing.NDArray[numpy.float64]) -> None"),
           "Writes the first observations of those anew, of what was set since their episode began. Raises "
           "ConfigError "
           "after a step of it.")
      .def("batch", guarded([](VectorEnvironment& v) {
             return Batch{identity_of(v), &v.envs->revision(), v.envs.get(), nullptr, nullptr};
           }),
           nb::keep_alive<0, 1>(), "All as arrays, and what changes them between steps.")
      .def("environment", guarded(&environment_of), nb::arg("index"), nb::keep_alive<0, 1>(),
           "One of them, to look at. Raises IndexError.")
      .def("infos", guarded(&infos_of), nb::sig("def infos(self) -> dict[str, typing.Any]"),
           "What is known of the last step, as Gymnasium's vector environments have it: an array for every "
           "key, and a mask "
           "for its name with an underscore.")
      .def("final_infos", guarded(&final_infos_of), nb::sig("def final_infos(self) -> dict[str, typing.Any]"),
           "With same_step, of the episodes that the last step ended.")
      .def("info", guarded(&info_of), nb::arg("index"),
           nb::sig("def info(self, index: int) -> dict[str, typing.Any]"),
           "What is known of one environment's last step.")
      .def("final_info", guarded(&final_info_of), nb::arg("index"),
           nb::sig("def final_info(self, index: int) -> dict[str, typing.Any] | None"),
           "With same_step, of one environment's episode if the last step ended it.")
      .def_prop_ro("diverged", guarded([](const VectorEnvironment& v) { return v.envs->diverged(); }),
                   "Episodes that ended because the engine diverged.")
      .def_prop_ro("episodes", guarded([](const VectorEnvironment& v) { return v.envs->episodes(); }),
                   "Episodes begun so far.")
      .def("__repr__", [](const VectorEnvironment& v) {
        const QuadrupedEnv& first = v.envs->environment(0);
        return fmt::format("<crossgait.VectorEnvironment: {} of {} in {}>", v.envs->size(),
                           first.config().robot, first.engine().name());
      });
}

}  // namespace crossgait::python
