#include "python/bindings/walk_config.h"

#include <optional>

#include <fmt/format.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include "gait/scale.h"
#include "physics/robot_files/data_path.h"

namespace crossgait::python {
namespace {

namespace nb = nanobind;

using Setting = std::variant<double, std::string>;  // of a gait parameter; its swing curve goes by name
using Settings = std::map<std::string, Setting>;
using Velocity = std::optional<std::array<double, 3>>;

std::vector<std::string> assignments(const Settings& settings) {
  std::vector<std::string> texts;
  for (const auto& [name, value] : settings) {
    texts.push_back(std::visit([&](const auto& v) { return fmt::format("{}={}", name, v); }, value));
  }
  return texts;
}

struct Arguments {
  std::string robot, terrain;
  std::uint64_t seed;
  std::optional<double> friction;
  std::string contact;
  double physics_dt;
  std::string gait;
  Settings parameters;
  Velocity command;
  WalkTiming timing;
  bool compensation, heading_hold;
  std::vector<std::string> terminations;
};

WalkConfig make(const Arguments& a) {
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
  config.timing = a.timing;
  config.terminations = OutcomeSet::of_names(a.terminations);
  return config;
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

}  // namespace

void bind_walk_config(nb::module_& m) {
  nb::class_<WalkConfig>(m, "Walk",
                         "What to walk, before any engine is chosen: the options of `crossgait walk`.")
      .def(
          "__init__",
          [](WalkConfig* self, const std::string& gait, const Velocity& command, const Settings& parameters,
             const std::string& robot, const std::string& terrain, std::uint64_t seed,
             std::optional<double> friction, const std::string& contact, double seconds, double physics_dt,
             double control_dt, double settle, bool compensation, bool heading_hold,
             const std::vector<std::string>& terminations) {
            new (self) WalkConfig(make({robot,
                                        terrain,
                                        seed,
                                        friction,
                                        contact,
                                        physics_dt,
                                        gait,
                                        parameters,
                                        command,
                                        {seconds, control_dt, settle},
                                        compensation,
                                        heading_hold,
                                        terminations}));
          },
          nb::arg("gait") = "trot", nb::kw_only(), nb::arg("command") = nb::none(),
          nb::arg("parameters") = Settings(), nb::arg("robot") = "scara_quadruped",
          nb::arg("terrain") = "flat", nb::arg("seed") = 0, nb::arg("friction") = nb::none(),
          nb::arg("contact") = "", nb::arg("seconds") = 5.0, nb::arg("physics_dt") = 1e-3,
          nb::arg("control_dt") = 2e-3, nb::arg("settle") = 0.5, nb::arg("compensation") = true,
          nb::arg("heading_hold") = true, nb::arg("terminations") = std::vector<std::string>{"left_terrain"},
          "`gait` by name, or auto with a `command` (forward m/s, left m/s, yaw rate rad/s); `parameters` "
          "change the "
          "gait's own, by name (`swing` is bezier or matched); `seed` is of a random terrain; `terminations` "
          "are outcomes that end the walk, beside divergence; `friction` is the robot file's or 0.6 unless "
          "it "
          "is given, `contact` says other settings as `--contact` does, e.g. impratio=100. Raises "
          "ConfigError.")
      .def_ro("robot", &WalkConfig::robot)
      .def_ro("terrain", &WalkConfig::terrain)
      .def_prop_ro("gait", [](const WalkConfig& c) { return c.gait.name(); })
      .def_prop_ro("command", &command_of)
      .def_ro("seed", &WalkConfig::terrain_seed)
      .def_prop_ro("friction", [](const WalkConfig& c) { return number_said(c.contact, "friction"); })
      .def_prop_ro("contact", [](const WalkConfig& c) { return contact_text(c.contact); })
      .def_prop_ro("seconds", [](const WalkConfig& c) { return c.timing.seconds; })
      .def_ro("physics_dt", &WalkConfig::physics_dt)
      .def_prop_ro("control_dt", [](const WalkConfig& c) { return c.timing.control_dt; })
      .def_prop_ro("settle", [](const WalkConfig& c) { return c.timing.settle_seconds; })
      .def_ro("compensation", &WalkConfig::compensation)
      .def_ro("heading_hold", &WalkConfig::heading_hold)
      .def_prop_ro("terminations", [](const WalkConfig& c) { return outcome_names(c.terminations); })
      .def_prop_ro("parameters", &parameters_of, nb::sig("def parameters(self) -> dict[str, float]"),
                   "Parameters of the gait, all of them.")
      .def("environment", &WalkConfig::environment,
           "The environment in which the zero policy walks like this. Raises ConfigError for what an "
           "environment cannot "
           "do.");
}

}  // namespace crossgait::python
