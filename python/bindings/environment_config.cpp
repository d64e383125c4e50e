// Configurations of environments: the keys of their YAML as keywords, attributes and a dict.
#include <filesystem>
#include <string>

#include <fmt/format.h>
#include <nanobind/nanobind.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "backends/registry.h"
#include "env/env_config_json.h"
#include "env/env_model.h"
#include "python/bindings/bindings.h"
#include "python/bindings/inputs.h"
#include "python/bindings/json.h"
#include "python/bindings/number.h"
#include "python/bindings/robot.h"
#include "python/bindings/shown.h"
#include "python/bindings/terms.h"
#include "study/notes.h"

namespace crossgait::python {
namespace {

constexpr int kMostLevels = 32;  // as files of environments have

std::string json_text(nb::handle value, int level = 0);

// A list may hold another many times, and that one a third.
std::string bounded(std::string text) {
  constexpr std::size_t kMost = std::size_t{4} << 20U;  // bytes, of 100,000 values at most
  if (text.size() > kMost)
    throw ConfigError("environment", "keys", fmt::format("at most {} bytes as text", kMost), "more");
  return text;
}

// Python's have as many digits as they like.
std::string whole_number(nb::handle value) {
  constexpr std::size_t kMostBits = 1024;  // of double's largest
  const auto bits = nb::cast<std::size_t>(value.attr("bit_length")());
  if (bits > kMostBits)
    throw ConfigError("environment", "keys", "numbers below 1.8e308",
                      fmt::format("a whole one of {} bits", bits));
  return nb::str(value).c_str();
}

// What stands for a ground or a robot is looked at first: the core would take a number for a name.
std::string value_text(const std::string& name, nb::handle value, int level) {
  if (name == "terrain" && !value.is_none()) return nlohmann::json(terrain_text(value, "environment")).dump();
  if (name == "robot" && !value.is_none()) return nlohmann::json(robot_text(value, "environment")).dump();
  const bool is_name = name == "engine" || name == "gait" || name == "action" || name == "preset";
  if (is_name && !value.is_none() && !nb::isinstance<nb::str>(value) && !nb::isinstance<EngineListing>(value))
    throw ConfigError("environment", name, "a name", type_called(value));
  return json_text(value, level);
}

std::string mapping_text(nb::handle mapping, int level) {
  std::string text;
  const auto keys = nb::borrow<nb::dict>(nb::module_::import_("builtins").attr("dict")(mapping));
  for (const auto& [key, value] : keys) {
    text += text.empty() ? "" : ", ";
    const std::string name = text_of(nb::str(key), "environment", "key");
    text += nlohmann::json(name).dump() + ": " + value_text(name, value, level);
    text = bounded(std::move(text));
  }
  return "{" + text + "}";
}

std::string list_text(nb::handle list, int level) {
  std::string text;
  for (const nb::handle item : list) {
    text += (text.empty() ? "" : ", ") + json_text(item, level);
    text = bounded(std::move(text));
  }
  return "[" + text + "]";
}

// Python's own values, NumPy's, paths, robots, terrains and engines, as the text that the core reads. @throws
// ConfigError for others
std::string json_text(nb::handle value, int level) {
  if (level > kMostLevels)
    throw ConfigError("environment", "keys", fmt::format("at most {} levels", kMostLevels), "more");
  if (value.is_none()) return "null";
  if (nb::isinstance<nb::bool_>(value)) return nb::cast<bool>(value) ? "true" : "false";
  if (nb::isinstance<nb::float_>(value)) return fmt::format("{}", nb::cast<double>(value));
  if (nb::isinstance<nb::int_>(value)) return whole_number(value);
  if (nb::isinstance<nb::str>(value)) return nlohmann::json(text_of(value, "environment", "text")).dump();
  if (nb::isinstance<nb::list>(value) || nb::isinstance<nb::tuple>(value)) return list_text(value, level + 1);
  if (nb::hasattr(value, "keys")) return mapping_text(value, level + 1);
  if (nb::isinstance<Terrain>(value)) return nlohmann::json(terrain_text(value, "terrain")).dump();
  if (nb::isinstance<Robot>(value)) return nlohmann::json(robot_text(value, "robot")).dump();
  if (nb::isinstance<EngineListing>(value))
    return nlohmann::json(engine_name_of(value, "environment")).dump();
  if (nb::hasattr(value, "tolist")) return json_text(as_written(value).attr("tolist")(), level + 1);
  if (nb::hasattr(value, "__fspath__")) return json_text(value.attr("__fspath__")(), level + 1);
  throw ConfigError("config", shown(value), "numbers, text, lists and mappings", type_called(value));
}

// Keywords that say something: None leaves a key as it is.
nb::dict given(const nb::kwargs& keys) {
  nb::dict said;
  for (const auto& [key, value] : keys) {
    if (!value.is_none()) said[key] = value;
  }
  return said;
}

// What `read` makes of keys and values: they are on no line, whatever the reader of files says.
template <typename Read>
EnvConfig of_keys(nb::handle keys, const Read& read) {
  const std::string text = json_text(keys);
  try {
    return read(text);
  } catch (const ConfigError& error) {
    constexpr std::string_view kLine = "line 1, ";
    const std::string& element = error.element();
    throw ConfigError(error.source(), element.substr(element.starts_with(kLine) ? kLine.size() : 0),
                      error.expected(), error.found());
  }
}

EnvConfig parsed(nb::handle keys, const std::string& source) {
  if (nb::isinstance<nb::str>(keys)) return parse_env_config(text_of(keys, source, "text"), source);
  return of_keys(keys, [&](const std::string& text) { return parse_env_config(text, source); });
}

EnvConfig updated(const EnvConfig& config, nb::handle changes, const std::string& source,
                  const nb::kwargs& keys) {
  const auto change = [&source](const EnvConfig& of, nb::handle changed) {
    return of_keys(changed, [&](const std::string& text) { return override_env_config(of, text, source); });
  };
  EnvConfig result = config;
  if (!nb::isinstance<nb::str>(changes)) {
    result = change(config, changes);
  } else if (const auto text = text_of(changes, source, "text"); !text.empty()) {
    result = override_env_config(config, text, source);
  }
  const nb::dict said = given(keys);
  return said.size() == 0 ? result : change(result, said);
}

/// A key as an attribute, but for robot and terrain. What the configuration does not say is the JSON text
/// `otherwise`; `action` is the one that it belongs to, "" for a key of both: None where actions are of the
/// other kind.
struct Key {
  const char *name, *signature, *help, *otherwise, *action;
};

constexpr Key kKeys[] = {
    {"engine", "def engine(self) -> str", "Its name; see `crossgait.engines()`.", "", ""},
    {"terrain_seed", "def terrain_seed(self) -> int", "Of a random terrain.", "", ""},
    {"friction", "def friction(self) -> float | None",
     "Between robot and ground; None: the robot file's, or 0.6.", "null", ""},
    {"contact", "def contact(self) -> dict[str, float | str | list[float]]",
     "Other settings of contact (impratio, solref, condim, ...), those that are said.", "{}", ""},
    {"servos", "def servos(self) -> dict[str, float | dict[str, float]]",
     "By setting (kp, kd, ...), one number for all servos or numbers by joint, in the place of the robot's.",
     "{}", ""},
    {"action", "def action(self) -> str", "gait or joints.", "", ""},
    {"joints", "def joints(self) -> dict[str, typing.Any] | None",
     "What actions that command joints mean: order, home, scale, limit, delay. None with action gait.", "",
     "joints"},
    {"gait", "def gait(self) -> str | None", "Its name. None with action joints, as what follows.", "",
     "gait"},
    {"parameters", "def parameters(self) -> dict[str, float | str] | None",
     "Of the gait at the start of an episode, those that are not as it prefers.", "{}", "gait"},
    {"adapt", "def adapt(self) -> list[str] | None", "Names of parameters that the action changes.", "",
     "gait"},
    {"ranges", "def ranges(self) -> dict[str, list[float]] | None",
     "[min, max] of adapted parameters, in the place of the table's.", "{}", "gait"},
    {"delta_scales", "def delta_scales(self) -> dict[str, float] | None",
     "Largest change of adapted parameters in a step, in the place of the table's.", "{}", "gait"},
    {"residual_scale", "def residual_scale(self) -> float | None",
     "Largest foot residual, m; None: by the robot's size.", "null", "gait"},
    {"heading_hold", "def heading_hold(self) -> bool | None",
     "Whether the gait steers to the heading that its command leads to.", "", "gait"},
    {"command", "def command(self) -> dict[str, float] | None",
     "Velocity: vx and vy, m/s, yaw_rate, rad/s. None: steps of step_length.", "null", ""},
    {"observation", "def observation(self) -> list[str | dict[str, typing.Any]]",
     "Blocks: a name, or a dict with block, scale, clip, noise, delay, history.", "", ""},
    {"reward", "def reward(self) -> dict[str, float]", "Weights of the terms that count.", "", ""},
    {"physics_dt", "def physics_dt(self) -> float", "s.", "", ""},
    {"control_dt", "def control_dt(self) -> float", "s.", "", ""},
    {"policy_dt", "def policy_dt(self) -> float", "s.", "", ""},
    {"episode_seconds", "def episode_seconds(self) -> float", "s.", "", ""},
    {"settle_seconds", "def settle_seconds(self) -> float", "Standing before the first observation, s.", "",
     ""},
    {"tilt_limit_deg", "def tilt_limit_deg(self) -> float", "Roll or pitch beyond it is a fall.", "", ""},
    {"terminations", "def terminations(self) -> list[str]",
     "Outcomes that end an episode; divergence always does.", "", ""},
    {"randomisation", "def randomisation(self) -> dict[str, list[float]]",
     "[min, max] of what differs from episode to episode.", "{}", ""},
};

nb::object attribute(const EnvConfig& config, const Key& key) {
  const nlohmann::ordered_json json = to_json(config);
  if (const auto found = json.find(key.name); found != json.end()) return to_python(*found);
  if (*key.action != '\0' && name(config.action) != key.action) return nb::none();
  return to_python(nlohmann::ordered_json::parse(key.otherwise));
}

// The keywords, as type checkers see them: of both, and of one. A configuration's action stays as it is.
const std::string kKeywords =
    "engine: str | Engine | None = None, robot: str | os.PathLike[str] | Robot | None = None, terrain: "
    "str | os.PathLike[str] | Terrain | None = None, terrain_seed: int | None = None, friction: float | "
    "None = None, contact: collections.abc.Mapping[str, typing.Any] | None = None, servos: "
    "collections.abc.Mapping[str, typing.Any] | None = None, joints: collections.abc.Mapping[str, "
    "typing.Any] | None = None, gait: str | None = None, parameters: collections.abc.Mapping[str, float "
    "| str] | None = None, adapt: collections.abc.Sequence[str] | None = None, ranges: "
    "collections.abc.Mapping[str, collections.abc.Sequence[float]] | None = None, delta_scales: "
    "collections.abc.Mapping[str, float] | None = None, residual_scale: float | None = None, "
    "heading_hold: bool | None = None, command: collections.abc.Mapping[str, float] | None = None, "
    "observation: collections.abc.Sequence[typing.Any] | None = None, reward: "
    "collections.abc.Mapping[str, float] | None = None, physics_dt: float | None = None, control_dt: "
    "float | None = None, policy_dt: float | None = None, episode_seconds: float | None = None, "
    "settle_seconds: float | None = None, tilt_limit_deg: float | None = None, terminations: "
    "collections.abc.Sequence[str] | None = None, randomisation: collections.abc.Mapping[str, "
    "collections.abc.Sequence[float]] | None = None";

const std::string kConstructor =
    "def __init__(self, of: str | os.PathLike[str] | collections.abc.Mapping[str, typing.Any] | Walk | "
    "EnvironmentConfig | None = None, /, *, preset: str | None = None, action: str | None = None, " +
    kKeywords + ") -> None";
const std::string kUpdated =
    "def updated(self, changes: str | collections.abc.Mapping[str, typing.Any] = '', source: str = "
    "'environment', *, " +
    kKeywords + ") -> EnvironmentConfig";

void bind_making(nb::class_<EnvConfig>& c) {
  c.def(
       "__init__",
       [](EnvConfig* self, const nb::object& of, const nb::kwargs& keys) {
         if (of.is_none()) {
           new (self) EnvConfig(parsed(given(keys), "EnvironmentConfig"));
         } else {
           const nb::object taken =
               nb::module_::import_("crossgait.inputs").attr("as_environment")(of, "EnvironmentConfig");
           new (self)
               EnvConfig(updated(nb::cast<const EnvConfig&>(taken), nb::str(""), "EnvironmentConfig", keys));
         }
       },
       nb::arg("of").none() = nb::none(), nb::arg("keys"), nb::sig(kConstructor.c_str()),
       "Of keywords, each a key; without any the default. None leaves a key as it is. `of` is what they "
       "change: a YAML file, a mapping of keys, a walk or a configuration. `action=\"joints\"` "
       "begins "
       "with what policies that command joints use, `preset=\"guide\"` with the guide's environment. Raises "
       "ConfigError.")
      .def_static(
          "load", [](const std::filesystem::path& path) { return load_env_config(path.string()); },
          nb::arg("path"), "Of a YAML file. Raises ConfigError.")
      .def_static(
          "parse", [](nb::handle keys, const std::string& source) { return parsed(keys, source); },
          nb::arg("text"), nb::arg("source") = "environment",
          nb::sig("def parse(text: str | collections.abc.Mapping[str, typing.Any], source: str = "
                  "'environment') -> EnvironmentConfig"),
          "Of YAML, JSON or a mapping; `source` stands for the file in messages. Raises ConfigError.")
      .def_static(
          "from_dict", [](nb::handle keys, const std::string& source) { return parsed(keys, source); },
          nb::arg("keys"), nb::arg("source") = "environment",
          nb::sig("def from_dict(keys: collections.abc.Mapping[str, typing.Any], source: str = "
                  "'environment') -> EnvironmentConfig"),
          "Of a mapping of its keys: of text, numbers (NumPy's as well), paths, lists and mappings. Raises "
          "ConfigError.")
      .def("updated", &updated, nb::arg("changes") = "", nb::arg("source") = "environment", nb::arg("keys"),
           nb::sig(kUpdated.c_str()),
           "With what `changes` (YAML, JSON or a mapping) and keywords say in the place of its own, key by "
           "key. Raises ConfigError.");
}

void bind_saying(nb::class_<EnvConfig>& c) {
  c.def_ro("robot", &EnvConfig::robot, "A bundled robot or a file.");
  c.def_ro("terrain", &EnvConfig::terrain, "As `crossgait.Terrain` takes it.");
  for (const Key& key : kKeys) {
    c.def_prop_ro(
        key.name, [&key](const EnvConfig& config) { return attribute(config, key); }, nb::sig(key.signature),
        key.help);
  }
  c.def(
       "to_dict", [](const EnvConfig& config) { return to_python(to_json(config)); },
       nb::sig("def to_dict(self) -> dict[str, typing.Any]"),
       "What is set, keys as in YAML; `from_dict` reads it back.")
      .def(
          "to_yaml", [](const EnvConfig& config) { return to_yaml(config); }, "What is set.")
      .def(
          "resolved", [](const EnvConfig& config) { return EnvModel::make(config)->resolved(); },
          "The same with everything set that follows from the robot. Raises ConfigError.")
      .def_prop_ro(
          "notes", [](const EnvConfig& config) { return notes_on(config); },
          "What is limited or doubtful in it, a sentence each: whatever makes or runs it warns of it by "
          "`crossgait.Note`.")
      .def("__repr__",
           [](const EnvConfig& config) {
             return fmt::format("EnvironmentConfig.from_dict({})",
                                nb::repr(to_python(to_json(config))).c_str());
           })
      .def(
          "__eq__",
          [](const EnvConfig& a, const EnvConfig& b) {
            return a.extension == b.extension && to_yaml(a) == to_yaml(b);
          },
          nb::is_operator(), nb::sig("def __eq__(self, other: object, /) -> bool"))
      .def("__hash__", [](const EnvConfig& config) { return std::hash<std::string>()(to_yaml(config)); })
      .def("__copy__", [](const EnvConfig& config) { return config; })
      .def("__deepcopy__", [](const EnvConfig& config, nb::handle) { return config; })
      .def("__getstate__",
           [](const EnvConfig& config) {
             if (config.extension != nullptr)
               throw ConfigError("environment", "terms",
                                 "a configuration without: they are functions of the program, and in no file",
                                 "one with terms");
             return to_yaml(config);
           })
      .def("__setstate__", [](EnvConfig& config, const std::string& text) {
        new (&config) EnvConfig(parse_env_config(text, "environment"));
      });
}

}  // namespace

void bind_environment_config(nb::module_& m) {
  nb::class_<EnvConfig> config(
      m, "EnvironmentConfig",
      "Everything that makes an environment: keys of docs/environment.md as keywords, attributes and a dict. "
      "Immutable.");
  bind_making(config);
  bind_saying(config);
  bind_terms(config);
}

}  // namespace crossgait::python
