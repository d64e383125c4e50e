#include "crossgait/python/bindings/environment.h"

#include <nanobind/eigen/dense.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "crossgait/backends/registry.h"
#include "crossgait/parity/report.h"
#include "crossgait/python/bindings/arrays.h"
#include "crossgait/python/bindings/bindings.h"
#include "crossgait/python/bindings/json.h"
#include "crossgait/python/bindings/robot.h"

namespace crossgait::python {

nb::object layout(const Layout& layout) {
  nb::list entries;
  for (const LayoutEntry& e : layout.entries) entries.append(nb::make_tuple(e.name, e.unit, e.min, e.max));
  return entries;
}

nb::dict info(const QuadrupedEnv& env) {
  const StepInfo& step = env.info();
  nb::dict result;
  result["time"] = step.time;
  result["distance"] = step.distance;
  result["lateral"] = step.lateral;
  result["power"] = step.power;
  result["limit_factor"] = step.limit_factor;
  result["ik_clamped"] = step.ik_clamped;
  result["invalid_actions"] = step.invalid_actions;
  result["outcome"] = name(step.outcome).data();
  return result;
}

namespace {

Environment make_environment(const EnvConfig& config, const std::string& engine) {
  const nb::gil_scoped_release release;
  auto model = EnvModel::make(config);
  auto env = std::make_unique<QuadrupedEnv>(model, find_engine(engine.empty() ? config.engine : engine));
  return {std::move(model), std::move(env), {}};
}

nb::object reset(Environment& self, std::uint64_t seed) {
  const NewArray<double> observation({self.env->observation_size()});
  {
    const nb::gil_scoped_release release;
    self.env->reset(seed, {observation.data, self.env->observation_size()});
  }
  return nb::cast(observation.array);
}

nb::tuple step(Environment& self, const AnyArray& action) {
  const auto numbers = doubles(action, self.env->action_size(), "action", self.action);
  const NewArray<double> observation({self.env->observation_size()});
  StepResult result;
  {
    const nb::gil_scoped_release release;
    result = self.env->step(numbers, {observation.data, self.env->observation_size()});
  }
  return nb::make_tuple(nb::cast(observation.array), result.reward, result.terminated, result.truncated);
}

nb::dict reward_terms_of(const Environment& self) {
  nb::dict terms;
  for (std::size_t i = 0; i < kRewardTerms; ++i) {
    if (self.env->config().reward[i] != 0)
      terms[reward_terms()[i].name.data()] = self.env->info().reward_terms[i];
  }
  return terms;
}

nb::object parameters_of(const Environment& self) {
  if (!self.env->info().parameters) return nb::none();
  nb::dict parameters;
  for (const ParameterRow& row : gait_parameters())
    parameters[row.name.data()] = (*self.env->info().parameters).*row.member;
  return parameters;
}

void bind_config(nb::module_& m) {
  nb::class_<EnvConfig>(
      m, "EnvironmentConfig",
      "Everything that makes an environment; docs/environment.md shows it as YAML. Immutable.")
      .def_static("load", &load_env_config, nb::arg("path"), "Of a YAML file. Raises ConfigError.")
      .def_static("parse", &parse_env_config, nb::arg("text"), nb::arg("source") = "environment",
                  "Of YAML or JSON; `source` stands for the file in messages. Raises ConfigError.")
      .def_static("guide", &guide_environment, "The guide's environment.")
      .def_static("joints", &joint_environment, "One for policies that command joints.")
      .def(
          "to_yaml", [](const EnvConfig& c) { return to_yaml(c); }, "What is set.")
      .def(
          "stated", [](const EnvConfig& c) { return EnvModel::make(c)->stated(); },
          "With everything stated that follows from the robot. Raises ConfigError.")
      .def_ro("engine", &EnvConfig::engine)
      .def_ro("robot", &EnvConfig::robot)
      .def_ro("terrain", &EnvConfig::terrain)
      .def_ro("policy_dt", &EnvConfig::policy_dt, "s.")
      .def_ro("control_dt", &EnvConfig::control_dt, "s.")
      .def_ro("physics_dt", &EnvConfig::physics_dt, "s.")
      .def_ro("episode_seconds", &EnvConfig::episode_seconds, "s.")
      .def_prop_ro(
          "action", [](const EnvConfig& c) { return std::string(name(c.action)); }, "gait or joints.")
      .def("__getstate__", [](const EnvConfig& c) { return to_yaml(c); })
      .def("__setstate__", [](EnvConfig& c, const std::string& text) {
        new (&c) EnvConfig(parse_env_config(text, "environment"));
      });
}

}  // namespace

void bind_environment(nb::module_& m) {
  bind_config(m);
  nb::class_<QuadrupedEnv::Saved>(m, "SavedEpisode",
                                  "An instant of an episode: restoring it continues bit for bit.");
  nb::class_<Environment>(
      m, "Environment",
      "The reinforcement-learning environment itself; crossgait.envs has it as Gymnasium's. Not for "
      "two threads at once.")
      .def(nb::new_(&make_environment), nb::arg("config"), nb::arg("engine") = "",
           "`engine` \"\" is the one that the configuration names. Raises ConfigError.")
      .def_prop_ro("config", [](const Environment& e) { return e.env->config(); })
      .def_prop_ro("engine", [](const Environment& e) { return e.env->engine().name(); })
      .def_prop_ro(
          "layout_hash", [](const Environment& e) { return e.model->layout; },
          "What a policy is trained for.")
      .def_prop_ro(
          "observation_layout", [](const Environment& e) { return layout(e.env->observation_layout()); },
          nb::sig("def observation_layout(self) -> list[tuple[str, str, float, float]]"),
          "(name, unit, min, max) of every number; infinite where nothing bounds it.")
      .def_prop_ro(
          "action_layout", [](const Environment& e) { return layout(e.env->action_layout()); },
          nb::sig("def action_layout(self) -> list[tuple[str, str, float, float]]"))
      .def("reset", &reset, nb::arg("seed"),
           nb::sig("def reset(self, seed: int) -> numpy.typing.NDArray[numpy.float64]"),
           "Begins an episode and returns its first observation, in an array of its own.")
      .def("step", &step, nb::arg("action"),
           nb::sig("def step(self, action: numpy.typing.NDArray[typing.Any]) -> "
                   "tuple[numpy.typing.NDArray[numpy.float64], float, bool, bool]"),
           "One policy step: (observation, reward, terminated, truncated). Entries of the action are clipped "
           "to their "
           "bounds; not finite counts as zero. The observation is an array of its own. Raises ConfigError.")
      .def_prop_ro(
          "info", [](const Environment& e) { return info(*e.env); },
          nb::sig("def info(self) -> dict[str, typing.Any]"), "Of the last step.")
      .def_prop_ro("reward_terms", &reward_terms_of, nb::sig("def reward_terms(self) -> dict[str, float]"),
                   "Of the last step, weighted; those that have a weight.")
      .def_prop_ro("parameters", &parameters_of, nb::sig("def parameters(self) -> dict[str, float] | None"),
                   "Of the gait as adapted so far; None where actions command joints.")
      .def_prop_ro(
          "state", [](const Environment& e) { return RobotState(e.env->backend().state()); },
          "Of the robot, as the engine has it.")
      .def_prop_ro(
          "robot",
          [](const Environment& e) {
            return Robot{e.env->config().robot, e.model->world.robot, {}};
          },
          "Nominal, with the environment's servos.")
      .def_prop_ro(
          "terrain", [](const Environment& e) { return e.env->backend().spec().terrain; }, "Of this episode.")
      .def_prop_ro("foot_contacts",
                   [](const Environment& e) {
                     return std::vector<FootContact>(e.env->info().contacts.begin(),
                                                     e.env->info().contacts.end());
                   })
      .def(
          "summary", [](const Environment& e) { return to_python(to_json(e.env->summary())); },
          nb::sig("def summary(self) -> dict[str, typing.Any]"),
          "The episode so far, with the keys of `crossgait walk --json`.")
      .def(
          "set_command",
          [](Environment& e, double vx, double vy, double yaw_rate) {
            e.env->set_command({vx, vy, yaw_rate});
          },
          nb::arg("vx"), nb::arg("vy") = 0, nb::arg("yaw_rate") = 0,
          "Asks for another velocity from the next step on, m/s and rad/s.")
      .def(
          "save",
          [](const Environment& e) { return std::const_pointer_cast<QuadrupedEnv::Saved>(e.env->save()); },
          "Everything that the rest of the episode depends on. Raises ConfigError before the first reset.")
      .def(
          "restore", [](Environment& e, const QuadrupedEnv::Saved& saved) { e.env->restore(saved); },
          nb::arg("saved"), "Raises ConfigError if it is of another configuration or engine.");
}

}  // namespace crossgait::python
