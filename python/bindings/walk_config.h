// What to walk, said in Python's terms.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <nanobind/nanobind.h>

#include "study/walk_config.h"

namespace crossgait::python {

/// Holds what a walk was asked for with: the keywords of `Walk`.
struct WalkArguments {
  using Setting = std::variant<double, std::string>;  ///< of a gait parameter; its swing curve goes by name

  std::string gait = "trot";
  std::optional<std::array<double, 3>> command;  ///< vx, vy, m/s, yaw rate, rad/s
  std::map<std::string, Setting> parameters;
  std::string robot = "scara_quadruped", terrain = "flat";
  std::uint64_t seed = 0;
  std::optional<double> friction;
  std::string contact;
  double seconds = 5, physics_dt = 1e-3, control_dt = 2e-3, settle = 0.5;
  bool compensation = true, heading_hold = true;
  std::vector<std::string> terminations = {"left_terrain"};

  bool operator==(const WalkArguments&) const = default;
};

/// Holds a walk that knows how to be made again.
struct PythonWalk : WalkConfig {
  PythonWalk() = default;
  /// @throws ConfigError
  explicit PythonWalk(WalkArguments arguments);

  WalkArguments said;
};

/// Takes anything, so that what is no walk is refused in words of its own; what it says in signatures.
class WalkLike : public nanobind::object {
  NB_OBJECT_DEFAULT(WalkLike, nanobind::object, "Walk | str", [](const PyObject*) { return true; })
};
/// Returns a walk, or that of a gait's name. @throws ConfigError naming `source` for anything else
PythonWalk walk_of(nanobind::handle value, const std::string& source);

void bind_walk_config(nanobind::module_& m);

}  // namespace crossgait::python
