// Gaits: the tables, and foot targets over time.
#include <optional>

#include <fmt/format.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>

#include "gait/scale.h"
#include "ik/leg_kinematics.h"
#include "motion/walk.h"
#include "physics/core/error.h"
#include "physics/robot_files/data_path.h"
#include "python/bindings/arrays.h"
#include "python/bindings/bindings.h"
#include "python/bindings/walk_config.h"

namespace crossgait::python {
namespace {

nb::dict gait_table() {
  nb::dict table;
  for (const Gait& gait : gaits()) {
    nb::dict offsets;
    for (const Leg leg : kLegs) offsets[name(leg).data()] = gait.offset[leg];
    nb::dict row;
    row["summary"] = std::string(gait.summary);
    row["offsets"] = offsets;
    row["duty_factor"] = gait.preferred.duty_factor;
    row["cycle_time"] = gait.preferred.cycle_time;
    table[std::string(gait.name).c_str()] = row;
  }
  return table;
}

nb::dict parameter_table() {
  nb::dict table;
  for (const ParameterRow& row : gait_parameters()) {
    nb::dict entry;
    entry["unit"] = std::string(row.unit);
    entry["help"] = std::string(row.help);
    entry["default"] = row.default_value();
    entry["min"] = row.min;
    entry["max"] = row.max;
    entry["delta_scale"] = row.delta_scale;
    table[std::string(row.name).c_str()] = entry;
  }
  return table;
}

/// The foot targets of a walk's gait, without robot dynamics or kinematics.
class FootTargets {
 public:
  explicit FootTargets(const WalkLike& walk) : generator_(make(walk_of(walk, "gait"))) {}

  nb::tuple update(double dt) {
    if (!(dt > 0 && dt <= WalkTiming::kMaxSeconds))
      throw ConfigError("gait", "dt", "a time in (0, 1e6] s", fmt::format("{}", dt));
    const LegArray<FootTarget>& targets = generator_.update(dt);
    const NewArray<double> feet(kLegCount, 3), progress(kLegCount);
    const NewArray<bool> swing(kLegCount);
    for (const Leg leg : kLegs) {
      std::copy_n(targets[leg].position.data(), 3, feet.data + 3 * index(leg));
      swing.data[index(leg)] = targets[leg].swing;
      progress.data[index(leg)] = targets[leg].progress;
    }
    return nb::make_tuple(feet.array, swing.array, progress.array);
  }
  void set_command(double vx, double vy, double yaw_rate) {
    if (!generator_.set_command({vx, vy, yaw_rate}))
      throw ConfigError("gait", "command", "finite numbers", "others");
  }
  void reset(bool standing) {
    generator_.reset(standing ? GaitGenerator::Start::kStanding : GaitGenerator::Start::kWalking);
  }
  const GaitGenerator& generator() const { return generator_; }

 private:
  static GaitGenerator make(const WalkConfig& walk) {
    if (!walk.gait.gait) throw ConfigError("gait", "name", "one gait", walk.gait.name());
    const RobotDescription robot = load_robot(find_robot(walk.robot));
    GaitGenerator generator(*walk.gait.gait, walk.gait.parameters, leg_origins(robot),
                            scaled(StepLimits(), gait_scale(robot)));
    if (walk.gait.command && !generator.set_command(*walk.gait.command))
      throw ConfigError("gait", "command", "finite numbers", "others");
    generator.reset();
    return generator;
  }

  GaitGenerator generator_;
};

}  // namespace

void bind_gait(nb::module_& m) {
  m.def("gaits", &gait_table, nb::sig("def gaits() -> dict[str, dict[str, typing.Any]]"),
        "The gaits by name: summary, offsets (phase at which each leg lifts off), duty_factor, cycle_time "
        "(s).");
  m.def("gait_parameters", &parameter_table,
        nb::sig("def gait_parameters() -> dict[str, dict[str, typing.Any]]"),
        "The parameters of gaits by name: unit, help, default, min and max (the range for adaptation), "
        "delta_scale.");
  nb::class_<FootTargets>(
      m, "GaitGenerator",
      "Foot targets of one gait over time, continuous through every change. It begins in full stride.")
      .def(
          nb::init<const WalkLike&>(), nb::arg("walk") = "trot",
          "The gait, parameters, command and robot of a `Walk`, or a gait by name. Raises ConfigError for an "
          "automatic gait.")
      .def("update", &FootTargets::update, nb::arg("dt"),
           nb::sig("def update(self, dt: float) -> tuple[numpy.typing.NDArray[numpy.float64], "
                   "numpy.typing.NDArray[numpy.bool_], numpy.typing.NDArray[numpy.float64]]"),
           "After dt more seconds: feet (4 x 3, FL, FR, RL, RR, in the leg frames: x forward, y left, z up, "
           "m), which are "
           "in the air, and how far each is through its swing or stance, 0 to 1. New arrays.")
      .def("set_command", &FootTargets::set_command, nb::arg("vx"), nb::arg("vy") = 0,
           nb::arg("yaw_rate") = 0, "Steps for this velocity of the body, m/s and rad/s, from now on.")
      .def("reset", &FootTargets::reset, nb::kw_only(), nb::arg("standing") = false,
           "Back to phase 0, in full stride or standing.")
      .def_prop_ro(
          "phase", [](const FootTargets& t) { return t.generator().phase(); }, "Phase of the clock, 0 to 1.")
      .def_prop_ro("phase_name",
                   [](const FootTargets& t) { return std::string(t.generator().current_phase_name()); })
      .def_prop_ro(
          "limit_factor", [](const FootTargets& t) { return t.generator().limit_factor(); },
          "Share of the command that the steps can follow.")
      .def("__repr__", [](const FootTargets& t) {
        return fmt::format("<crossgait.GaitGenerator at phase {:.3f}>", t.generator().phase());
      });
}

}  // namespace crossgait::python
