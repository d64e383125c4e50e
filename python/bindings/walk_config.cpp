#include "python/bindings/walk_config.h"

#include <functional>
#include <utility>

#include <fmt/format.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include "gait/scale.h"
#include "physics/core/error.h"
#include "physics/robot_files/data_path.h"
#include "python/bindings/inputs.h"
#include "python/bindings/number.h"
#include "study/notes.h"

namespace crossgait::python {
namespace {

namespace nb = nanobind;

using Velocity = std::optional<std::array<double, 3>>;
using Settings = std::map<std::string, WalkArguments::Setting>;
using GivenSettings = std::map<std::string, std::variant<WrittenNumber, std::string>>;

std::vector<std::string> assignments(const Settings& settings) {
  std::vector<std::string> texts;
  for (const auto& [name, value] : settings) {
    texts.push_back(std::visit([&](const auto& v) { return fmt::format("{}={}", name, v); }, value));
  }
  return texts;
}

WalkConfig make(const WalkArguments& a) {
  WalkConfig config;
  config.robot = a.robot;
  config.terrain = a.terrain;
  config.terrain_seed = a.seed;
  if (!a.contact.empty()) config.contact = parse_contact_settings(a.contact, "Walk");
  if (a.friction) config.contact.set("friction", std::vector{*a.friction}, "Walk", "friction");
  config.physics_dt = a.physics_dt;
  const std::optional<VelocityCommand> command =
      a.command ? std::optional(VelocityCommand{(*a.command)[0], (*a.command)[1], (*a.command)[2]})
                : std::nullopt;
  config.gait =
      choose_gait(a.gait, assignments(a.parameters), command, gait_scale(load_robot(find_robot(a.robot))));
  config.compensation = a.compensation;
  config.heading_hold = a.heading_hold;
  config.timing = {a.seconds, a.control_dt, a.settle};
  config.terminations = OutcomeSet::of_names(a.terminations);
  return config;
}

// Calls `take(name, member)` for every keyword.
template <typename Take>
void for_each_keyword(const Take& take) {
  take("command", &WalkArguments::command);
  take("parameters", &WalkArguments::parameters);
  take("robot", &WalkArguments::robot);
  take("terrain", &WalkArguments::terrain);
  take("seed", &WalkArguments::seed);
  take("friction", &WalkArguments::friction);
  take("contact", &WalkArguments::contact);
  take("seconds", &WalkArguments::seconds);
  take("physics_dt", &WalkArguments::physics_dt);
  take("control_dt", &WalkArguments::control_dt);
  take("settle", &WalkArguments::settle);
  take("compensation", &WalkArguments::compensation);
  take("heading_hold", &WalkArguments::heading_hold);
  take("terminations", &WalkArguments::terminations);
}

nb::dict to_dict(const WalkArguments& said) {
  nb::dict keywords;
  keywords["gait"] = said.gait;
  for_each_keyword([&](const char* name, auto member) {
    if (said.*member != WalkArguments().*member) keywords[name] = said.*member;
  });
  return keywords;
}

std::string repr(const WalkArguments& said) {
  std::string text = fmt::format("Walk({}", nb::repr(nb::str(said.gait.c_str())).c_str());
  for_each_keyword([&](const char* name, auto member) {
    if (said.*member != WalkArguments().*member)
      text += fmt::format(", {}={}", name, nb::repr(nb::cast(said.*member)).c_str());
  });
  return text + ")";
}

std::optional<double> number_said(const ContactSettings& contact, std::string_view name) {
  const std::vector<double>* numbers = contact.find(name);
  return numbers == nullptr ? std::nullopt : std::optional(numbers->front());
}

std::string contact_text(const ContactSettings& contact) {
  std::string text;
  for (const ContactSetting& setting : contact_settings()) {
    const std::vector<double>* numbers = contact.find(setting.name);
    if (numbers == nullptr || setting.name == "friction") continue;
    text += fmt::format("{}{}={}", text.empty() ? "" : ",", setting.name,
                        contact_setting_text(setting, *numbers));
  }
  return text;
}

nb::dict parameters_of(const WalkConfig& config) {
  nb::dict parameters;
  for (const ParameterRow& row : gait_parameters())
    parameters[row.name.data()] = config.gait.parameters.*row.member;
  return parameters;
}

Velocity command_of(const WalkConfig& config) {
  const std::optional<VelocityCommand>& c = config.gait.command;
  return c ? Velocity({c->vx, c->vy, c->yaw_rate}) : std::nullopt;
}

constexpr const char* kWalkConstructor =
    "def __init__(self, gait: str = 'trot', *, command: collections.abc.Sequence[float] | "
    "collections.abc.Mapping[str, float] | None = None, "
    "parameters: collections.abc.Mapping[str, float | str] = {}, robot: str | os.PathLike[str] | Robot = "
    "'scara_quadruped', terrain: str | os.PathLike[str] | Terrain = 'flat', seed: int = 0, friction: float | "
    "None = None, contact: str | collections.abc.Mapping[str, typing.Any] = '', seconds: float = 5.0, "
    "physics_dt: float = 0.001, control_dt: float = "
    "0.002, settle: float = 0.5, compensation: bool = True, heading_hold: bool = True, terminations: "
    "collections.abc.Sequence[str] = ['left_terrain']) -> None";

// Three numbers, or a mapping as environments have it.
Velocity velocity_of(nb::handle command) {
  if (command.is_none()) return std::nullopt;
  const nb::object made =
      nb::module_::import_("crossgait.studies.choices").attr("velocity_of")(command, "Walk");
  return nb::cast<std::array<double, 3>>(made);
}

void make_walk(PythonWalk* self, const std::string& gait, const nb::object& command,
               const GivenSettings& parameters, const nb::object& robot, const nb::object& terrain,
               std::uint64_t seed, std::optional<WrittenNumber> friction, const ContactLike& contact,
               WrittenNumber seconds, WrittenNumber physics_dt, WrittenNumber control_dt,
               WrittenNumber settle, bool compensation, bool heading_hold,
               const std::vector<std::string>& terminations) {
  Settings set;
  for (const auto& [name, value] : parameters)
    std::visit([&setting = set[name]](const auto& v) { setting = v; }, value);
  new (self) PythonWalk(WalkArguments{
      gait, velocity_of(command), set, robot_text(robot, "Walk"), terrain_text(terrain, "Walk"), seed,
      friction ? std::optional(friction->value) : std::nullopt, contact_text_of(contact, "Walk"), seconds,
      physics_dt, control_dt, settle, compensation, heading_hold, terminations});
}

void bind_reading(nb::class_<PythonWalk>& c) {
  c.def_prop_ro("robot", [](const PythonWalk& w) { return w.robot; })
      .def_prop_ro("terrain", [](const PythonWalk& w) { return w.terrain; })
      .def_prop_ro("gait", [](const PythonWalk& c) { return c.gait.name(); })
      .def_prop_ro("command", [](const PythonWalk& w) { return command_of(w); })
      .def_prop_ro("seed", [](const PythonWalk& w) { return w.terrain_seed; })
      .def_prop_ro("friction", [](const PythonWalk& c) { return number_said(c.contact, "friction"); })
      .def_prop_ro("contact", [](const PythonWalk& c) { return contact_text(c.contact); })
      .def_prop_ro("seconds", [](const PythonWalk& c) { return c.timing.seconds; })
      .def_prop_ro("physics_dt", [](const PythonWalk& w) { return w.physics_dt; })
      .def_prop_ro("control_dt", [](const PythonWalk& c) { return c.timing.control_dt; })
      .def_prop_ro("settle", [](const PythonWalk& c) { return c.timing.settle_seconds; })
      .def_prop_ro("compensation", [](const PythonWalk& w) { return w.compensation; })
      .def_prop_ro("heading_hold", [](const PythonWalk& w) { return w.heading_hold; })
      .def_prop_ro("terminations", [](const PythonWalk& c) { return outcome_names(c.terminations); })
      .def_prop_ro(
          "parameters", [](const PythonWalk& w) { return parameters_of(w); },
          nb::sig("def parameters(self) -> dict[str, float]"), "Parameters of the gait, all of them.")
      .def_prop_ro(
          "notes", [](const PythonWalk& w) { return notes_on(LoadedWalk(w), w.said.gait); },
          "What is limited or doubtful in it, a sentence each: `walk`, `compare` and `verdict` warn of "
          "it by `crossgait.Note`.")
      .def(
          "environment", [](const PythonWalk& w) { return w.environment(); },
          "The environment in which the zero policy walks like this. Raises ConfigError for what an "
          "environment cannot do.")
      .def(
          "to_dict", [](const PythonWalk& w) { return to_dict(w.said); },
          nb::sig("def to_dict(self) -> dict[str, typing.Any]"),
          "The gait, and the keywords that are not as by default: `Walk(**walk.to_dict())` is the same.");
}

void bind_copying(nb::class_<PythonWalk>& c) {
  c.def("__repr__", [](const PythonWalk& w) { return repr(w.said); })
      .def(
          "__eq__", [](const PythonWalk& a, const PythonWalk& b) { return a.said == b.said; },
          nb::is_operator(), nb::sig("def __eq__(self, other: object, /) -> bool"))
      .def("__hash__", [](const PythonWalk& w) { return std::hash<std::string>()(repr(w.said)); })
      .def("__reduce__", [](nb::handle self) {
        const nb::object partial = nb::module_::import_("functools").attr("partial");
        return nb::make_tuple(partial(self.type(), **to_dict(nb::cast<const PythonWalk&>(self).said)),
                              nb::tuple());
      });
}

}  // namespace

PythonWalk::PythonWalk(WalkArguments arguments) : WalkConfig(make(arguments)), said(std::move(arguments)) {}

PythonWalk walk_of(nb::handle value, const std::string& source) {
  if (nb::isinstance<PythonWalk>(value)) return nb::cast<const PythonWalk&>(value);
  if (!nb::isinstance<nb::str>(value))
    throw ConfigError(source, "walk", "a Walk or the name of a gait", type_called(value));
  WalkArguments named;
  named.gait = text_of(value, source, "gait");
  return PythonWalk(std::move(named));
}

void bind_walk_config(nb::module_& m) {
  nb::class_<PythonWalk> walk(
      m, "Walk", "What to walk, before any engine is chosen: the options of `crossgait walk`. Immutable.");
  walk.def(
      "__init__", &make_walk, nb::arg("gait") = "trot", nb::kw_only(), nb::arg("command") = nb::none(),
      nb::arg("parameters") = GivenSettings(), nb::arg("robot") = "scara_quadruped",
      nb::arg("terrain") = "flat", nb::arg("seed") = 0, nb::arg("friction") = nb::none(),
      nb::arg("contact") = "", nb::arg("seconds") = 5.0, nb::arg("physics_dt") = 1e-3,
      nb::arg("control_dt") = 2e-3, nb::arg("settle") = 0.5, nb::arg("compensation") = true,
      nb::arg("heading_hold") = true, nb::arg("terminations") = std::vector<std::string>{"left_terrain"},
      nb::sig(kWalkConstructor),
      "`gait` by name, or auto with a `command` (forward m/s, left m/s, yaw rate rad/s); `parameters` "
      "change the gait's own, by name (`swing` is bezier or matched); `robot` and `terrain` by name, by file "
      "or as objects; `seed` is of a random terrain; `terminations` are outcomes that end the walk, beside "
      "divergence; `friction` is the robot file's or 0.6 unless it is given, `contact` says other settings "
      "as `--contact` does, e.g. impratio=100. Raises ConfigError.");
  bind_reading(walk);
  bind_copying(walk);
}

}  // namespace crossgait::python
