#include "python/bindings/environment.h"

#include <fmt/format.h>
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "backends/registry.h"
#include "parity/report.h"
#include "python/bindings/arrays.h"
#include "python/bindings/batch.h"
#include "python/bindings/bindings.h"
#include "python/bindings/busy.h"
#include "python/bindings/json.h"
#include "python/bindings/not_made.h"
#include "python/bindings/robot.h"
#include "python/bindings/step_info.h"
#include "python/bindings/terms.h"

namespace crossgait::python {

nb::object layout(const Layout& layout) {
  nb::list entries;
  for (const LayoutEntry& e : layout.entries)
    entries.append(nb::make_tuple(e.name, e.unit, e.min, e.max, e.low(), e.high()));
  return entries;
}

namespace {

Environment make_environment(const EnvConfig& config, const std::string& engine) {
  const nb::gil_scoped_release release;
  const Interruption interruption;
  auto model = EnvModel::make(config);
  auto env = std::make_unique<QuadrupedEnv>(model, find_engine(engine.empty() ? config.engine : engine));
  const Layout& observation = model->interface.observation;
  return {model, std::move(env), ObservationBounds(observation)};
}

nb::object reset(Environment& self, std::uint64_t seed) {
  const NewArray<double> observation(self.env->observation_size());
  ++self.revision;
  work_at(&self, [&](Interruption&) {
    self.env->reset(seed, {observation.data, self.env->observation_size()});
    self.bounds.find({observation.data, self.env->observation_size()}, self.outside);
  });
  return observation.array;
}

nb::tuple step(Environment& self, const AnyArray& action) {
  const auto numbers = doubles(action, std::array{self.env->action_size()}, "action", self.action);
  const NewArray<double> observation(self.env->observation_size());
  StepResult result;
  ++self.revision;
  work_at(&self, [&](Interruption&) {
    result = self.env->step(numbers, {observation.data, self.env->observation_size()});
    self.bounds.find({observation.data, self.env->observation_size()}, self.outside);
  });
  return nb::make_tuple(observation.array, result.reward, result.terminated, result.truncated);
}

nb::object observe_start(Environment& self) {
  const NewArray<double> observation(self.env->observation_size());
  self.env->observe_start({observation.data, self.env->observation_size()});
  self.bounds.find({observation.data, self.env->observation_size()}, self.outside);
  return observation.array;
}

nb::dict info_of(const Environment& self) {
  nb::dict made = info(self.env->info(), self.env->config().reward, self.bounds.names(self.outside));
  if (const EnvExtension* own = self.env->extension(); own != nullptr) {
    const std::span<const double> values = own->reward_terms();
    for (std::size_t i = 0; i < values.size(); ++i)
      made["reward_terms"][self.env->config().extension->reward_terms[i].c_str()] = values[i];
  }
  return made;
}

nb::object parameters_of(const QuadrupedEnv& env) {
  if (!env.info().parameters) return nb::none();
  nb::dict parameters;
  for (const ParameterRow& row : gait_parameters())
    parameters[row.name.data()] = (*env.info().parameters).*row.member;
  return parameters;
}

// What there is to see of an environment, whoever steps it.
template <typename T>
void bind_reading(nb::class_<T>& c) {
  c.def_prop_ro("config", guarded([](const T& e) { return e.get().config(); }))
      .def_prop_ro("engine", guarded([](const T& e) { return e.get().engine().name(); }))
      .def_prop_ro("layout_hash", guarded([](const T& e) { return e.get().model().layout; }),
                   "What a policy is trained for.")
      .def_prop_ro(
          "observation_layout", guarded([](const T& e) { return layout(e.get().observation_layout()); }),
          nb::sig("def observation_layout(self) -> list[tuple[str, str, float, float, float, float]]"),
          "(name, unit, min, max, low, high) of every number: min and max are infinite where nothing "
          "bounds it, low and high never. Numbers of an observation beyond low and high are "
          "`out_of_bounds` of `info`.")
      .def_prop_ro("action_layout", guarded([](const T& e) { return layout(e.get().action_layout()); }),
                   nb::sig("def action_layout(self) -> list[tuple[str, str, float, float, float, float]]"))
      .def_prop_ro("parameters", guarded([](const T& e) { return parameters_of(e.get()); }),
                   nb::sig("def parameters(self) -> dict[str, float] | None"),
                   "Parameters of the gait as adapted so far; None where actions command joints.")
      .def_prop_ro("state", guarded([](const T& e) { return RobotState(e.get().world().state()); }),
                   "State of the robot, as the engine has it.")
      .def_prop_ro("robot", guarded([](const T& e) {
                     return Robot{e.get().config().robot, e.get().model().world.robot, {}};
                   }),
                   "Nominal, with the environment's servos.")
      .def_prop_ro("terrain", guarded([](const T& e) { return e.get().world().spec().terrain; }),
                   "Terrain of this episode.")
      .def_prop_ro("foot_contacts", guarded([](const T& e) {
                     const LegArray<FootContact>& feet = e.get().info().contacts;
                     return std::vector<FootContact>(feet.begin(), feet.end());
                   }))
      .def("__repr__",
           [](nb::handle self) {
             const QuadrupedEnv& env = nb::cast<const T&>(self).get();
             return fmt::format("<crossgait.{}: {} in {}>", nb::str(self.type().attr("__name__")).c_str(),
                                env.config().robot, env.engine().name());
           })
      .def("summary", guarded([](const T& e) { return to_python(to_json(e.get().summary())); }),
           nb::sig("def summary(self) -> dict[str, typing.Any]"),
           "The episode so far, with the keys of `crossgait walk --json`.");
}

void bind_view(nb::module_& m) {
  nb::class_<EnvironmentView> view(m, "EnvironmentView",
                                   "One of the environments of a VectorEnvironment, which alone steps it.");
  bind_reading(view);
  view.def_prop_ro("episode_seed",
                   guarded([](const EnvironmentView& v) { return v.envs->episode_seed(v.index); }),
                   "What `Environment.reset` takes to repeat its episode.")
      .def("set_command", guarded([](EnvironmentView& v, double vx, double vy, double yaw_rate) {
             v.envs->set_command(v.index, {vx, vy, yaw_rate});
           }),
           nb::arg("vx"), nb::arg("vy") = 0, nb::arg("yaw_rate") = 0,
           "Asks for another velocity until its episode ends, m/s and rad/s.")
      .def("save", guarded([](const EnvironmentView& v) {
             return std::const_pointer_cast<QuadrupedEnv::Saved>(v.get().save());
           }),
           "Everything that the rest of its episode depends on. Raises ConfigError before the first reset.")
      .def("restore", guarded([](EnvironmentView& v, const QuadrupedEnv::Saved& saved) {
             v.envs->restore(v.index, saved);
           }),
           nb::arg("saved"),
           "Continues there, bit for bit; its later episodes are those that they were. Raises ConfigError.");
}

}  // namespace

void bind_environment(nb::module_& m) {
  m.def("derived_seed", &derived_seed, nb::arg("seed"), nb::arg("index"),
        "Seed of the index-th thing that hangs on `seed`: an environment of a vector, an episode of a "
        "rollout.");
  m.def(
      "reward_terms",
      [] {
        nb::dict all;
        for (const RewardTerm& term : reward_terms())
          all[std::string(term.name).c_str()] = std::string(term.help);
        return all;
      },
      nb::sig("def reward_terms() -> dict[str, str]"), "What the names of the table of rewards mean.");
  nb::class_<QuadrupedEnv::Saved>(m, "SavedEpisode",
                                  "An instant of an episode: restoring it continues bit for bit.")
      .def("__init__", not_made<QuadrupedEnv::Saved>("a SavedEpisode is what an environment's save makes"),
           nb::sig(kNotMade))
      .def("__repr__", [](const QuadrupedEnv::Saved& s) {
        return fmt::format("<crossgait.SavedEpisode at {:g} s>", s.physics.state.time);
      });
  bind_view(m);
  nb::class_<Environment> environment(
      m, "Environment",
      "The reinforcement-learning environment itself; crossgait.envs has it as Gymnasium's. For one "
      "thread at a time: while one steps it, another's call raises RuntimeError.");
  bind_reading(environment);
  environment
      .def(nb::new_(&make_environment), nb::arg("config"), nb::arg("engine") = "",
           "`engine` \"\" is the one that the configuration names. Raises ConfigError.")
      .def("reset", guarded(&reset), nb::arg("seed"),
           nb::sig("def reset(self, seed: int) -> numpy.typing.NDArray[numpy.float64]"),
           "Begins an episode and returns its first observation, in an array of its own.")
      .def("step", guarded(&step), nb::arg("action"),
           nb::sig("def step(self, action: numpy.typing.NDArray[typing.Any]) -> "
                   "tuple[numpy.typing.NDArray[numpy.float64], float, bool, bool]"),
           "One policy step: (observation, reward, terminated, truncated). Entries of the action are clipped "
           "to their "
           "bounds; not finite counts as zero. The observation is an array of its own. Raises ConfigError.")
      .def_prop_ro("info", guarded(&info_of), nb::sig("def info(self) -> dict[str, typing.Any]"),
                   "What is known of the last step; of the start after `reset`.")
      .def_prop_ro("_terms", guarded([](const Environment& e) {
                     const EnvExtension* own = e.env->extension();
                     return own == nullptr ? nb::none() : terms_at_work(*own);
                   }),
                   nb::sig("def _terms(self) -> typing.Any"),
                   "Terms of Python's at work; None without, and before the first `reset`.")
      .def("set_command", guarded([](Environment& e, double vx, double vy, double yaw_rate) {
             ++e.revision;
             e.env->set_command({vx, vy, yaw_rate});
           }),
           nb::arg("vx"), nb::arg("vy") = 0, nb::arg("yaw_rate") = 0,
           "Asks for another velocity from the next step on, m/s and rad/s.")
      .def("save", guarded([](const Environment& e) {
             return std::const_pointer_cast<QuadrupedEnv::Saved>(e.env->save());
           }),
           "Everything that the rest of the episode depends on. Raises ConfigError before the first reset.")
      .def("restore", guarded([](Environment& e, const QuadrupedEnv::Saved& saved) {
             ++e.revision;
             e.env->restore(saved);
           }),
           nb::arg("saved"), "Raises ConfigError if it is of another configuration or engine.")
      .def("observe_start", guarded(&observe_start),
           nb::sig("def observe_start(self) -> numpy.typing.NDArray[numpy.float64]"),
           "The first observation anew, of what was set since `reset`. Raises ConfigError after a step.")
      .def("batch", guarded([](Environment& e) {
             return Batch{&e, &e.revision, nullptr, e.env.get(), &e.revision};
           }),
           nb::keep_alive<0, 1>(), "It as arrays of one row, and what changes it between steps.");
}

}  // namespace crossgait::python
