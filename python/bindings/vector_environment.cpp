#include <nanobind/stl/string.h>

#include "crossgait/backends/registry.h"
#include "crossgait/env/vector_env.h"
#include "crossgait/physics/error.h"
#include "crossgait/python/bindings/arrays.h"
#include "crossgait/python/bindings/bindings.h"
#include "crossgait/python/bindings/environment.h"

namespace crossgait::python {
namespace {

/// N environments; the arrays that it returns are its caller's, and new in every step.
struct VectorEnvironment {
  std::unique_ptr<VectorEnv> envs;
  AutoReset auto_reset;
  std::vector<double> actions;  // of float32
};

AutoReset auto_reset_of(const std::string& name) {
  if (name == "next_step") return AutoReset::kNextStep;
  if (name == "same_step") return AutoReset::kSameStep;
  throw ConfigError("vector environment", "auto_reset", "next_step or same_step", name);
}

VectorEnvironment make(const EnvConfig& config, std::size_t environments, const std::string& engine,
                       std::size_t workers, const std::string& auto_reset) {
  const VectorEnvOptions options{environments, workers, auto_reset_of(auto_reset)};
  const nb::gil_scoped_release release;
  const Engine made_in = find_engine(engine.empty() ? config.engine : engine);
  return {std::make_unique<VectorEnv>(config, made_in, options), options.auto_reset, {}};
}

nb::object reset(VectorEnvironment& self, std::uint64_t seed) {
  const std::size_t size = self.envs->size() * self.envs->observation_size();
  const NewArray<double> observations({self.envs->size(), self.envs->observation_size()});
  {
    const nb::gil_scoped_release release;
    self.envs->reset(seed, {observations.data, size});
  }
  return nb::cast(observations.array);
}

nb::tuple step(VectorEnvironment& self, const AnyArray& actions) {
  const std::size_t count = self.envs->size(), width = self.envs->observation_size();
  const auto numbers = doubles(actions, count * self.envs->action_size(), "actions", self.actions);
  const bool keeps_final = self.auto_reset == AutoReset::kSameStep;
  const NewArray<double> observations({count, width}), rewards({count}),
      last({keeps_final ? count : 0, width});
  const NewArray<bool> terminated({count}), truncated({count});
  static_assert(sizeof(bool) == sizeof(std::uint8_t));  // and the core writes 0 or 1
  const auto flags = [count](const NewArray<bool>& array) {
    return std::span(reinterpret_cast<std::uint8_t*>(array.data), count);
  };
  {
    const nb::gil_scoped_release release;
    self.envs->step(numbers, {{observations.data, count * width},
                              {rewards.data, count},
                              flags(terminated),
                              flags(truncated),
                              {last.data, keeps_final ? count * width : 0}});
  }
  return nb::make_tuple(nb::cast(observations.array), nb::cast(rewards.array), nb::cast(terminated.array),
                        nb::cast(truncated.array), keeps_final ? nb::cast(last.array) : nb::none());
}

}  // namespace

void bind_vector_environment(nb::module_& m) {
  nb::class_<VectorEnvironment>(
      m, "VectorEnvironment",
      "Many environments of one configuration, stepped on several threads. Results are the "
      "same, bit for bit, for any number of workers.")
      .def(nb::new_(&make), nb::arg("config"), nb::arg("environments"), nb::kw_only(), nb::arg("engine") = "",
           nb::arg("workers") = 1, nb::arg("auto_reset") = "next_step",
           "`auto_reset` is next_step or same_step, as Gymnasium's AutoresetMode. Raises ConfigError.")
      .def_prop_ro("size", [](const VectorEnvironment& v) { return v.envs->size(); })
      .def_prop_ro("workers", [](const VectorEnvironment& v) { return v.envs->workers(); })
      .def_prop_ro("config", [](const VectorEnvironment& v) { return v.envs->environment(0).config(); })
      .def_prop_ro("engine",
                   [](const VectorEnvironment& v) { return v.envs->environment(0).engine().name(); })
      .def_prop_ro(
          "observation_layout",
          [](const VectorEnvironment& v) { return layout(v.envs->environment(0).observation_layout()); },
          nb::sig("def observation_layout(self) -> list[tuple[str, str, float, float]]"))
      .def_prop_ro(
          "action_layout",
          [](const VectorEnvironment& v) { return layout(v.envs->environment(0).action_layout()); },
          nb::sig("def action_layout(self) -> list[tuple[str, str, float, float]]"))
      .def("reset", &reset, nb::arg("seed"),
           nb::sig("def reset(self, seed: int) -> numpy.typing.NDArray[numpy.float64]"),
           "Begins an episode everywhere; observations are a new array, one row per environment.")
      .def("step", &step, nb::arg("actions"),
           nb::sig("def step(self, actions: numpy.typing.NDArray[typing.Any]) -> "
                   "tuple[numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64], "
                   "numpy.typing.NDArray[numpy.bool_], numpy.typing.NDArray[numpy.bool_], "
                   "numpy.typing.NDArray[numpy.float64] | None]"),
           "One policy step everywhere: (observations, rewards, terminated, truncated, final_observations). "
           "All are new "
           "arrays, the caller's to keep. With same_step rows of `final_observations` are set where an "
           "episode ended in "
           "this step, and mean nothing elsewhere; with next_step it is None. Raises ConfigError.")
      .def(
          "info", [](const VectorEnvironment& v, std::size_t i) { return info(v.envs->environment(i)); },
          nb::arg("environment"), nb::sig("def info(self, environment: int) -> dict[str, typing.Any]"),
          "Of one environment's last step.")
      .def(
          "state",
          [](const VectorEnvironment& v, std::size_t i) {
            return RobotState(v.envs->environment(i).backend().state());
          },
          nb::arg("environment"), "Of one environment's robot.")
      .def_prop_ro(
          "diverged", [](const VectorEnvironment& v) { return v.envs->diverged(); },
          "Episodes that ended because the engine diverged.")
      .def_prop_ro(
          "episodes", [](const VectorEnvironment& v) { return v.envs->episodes(); },
          "Episodes begun so far.");
}

}  // namespace crossgait::python
