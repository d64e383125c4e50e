// How a robot's file wants it to touch the ground: what feet say of it becomes a setting of contact
// (robot_contact.h), and whoever shows a robot holds the file against the world (WorldSpec).
#pragma once

#include <array>
#include <map>
#include <optional>
#include <set>
#include <string>

namespace crossgait {

/// Holds one contact, in MuJoCo's terms and units (MuJoCo manual, "Contact" and "Solver parameters").
struct ContactNumbers {
  std::array<double, 3> friction{1, 0.005, 0.0001};  ///< sliding, torsional (m), rolling (m)
  std::array<double, 2> solref{0.02, 1};             ///< time constant (s), damping ratio; or negative ones
  std::array<double, 5> solimp{0.9, 0.95, 0.001, 0.5, 2};  ///< impedances, width (m), midpoint, power
  double condim = 3, margin = 0, gap = 0;                  ///< -, m, m
  std::optional<double> max_depenetration_velocity;        ///< of hard contact, m/s: MJCF has none
  std::set<std::string> stated;  ///< names of those that the file says; the others are MuJoCo's defaults
  /// Holds a number that the file says beside them, and that no contact here has.
  struct Unused {
    double number;
    std::string why;  ///< it is not simulated

    bool operator==(const Unused&) const = default;
  };
  std::map<std::string, Unused> not_simulated;

  /// Tells whether the file says nothing.
  bool is_empty() const { return stated.empty() && not_simulated.empty(); }
};

/// Holds what a file says of contact and of the steps of time, where it says it.
struct ContactOfFile {
  std::optional<double> timestep, impratio;  ///< s, -
  std::optional<double> noslip_iterations;
  std::optional<std::array<double, 3>> gravity;  ///< m/s^2
  std::optional<std::string> cone, integrator;
  bool has_explicit_dampers = false;  ///< of an MJCF that says `eulerdamp="disable"`
  /// Contacts of each collision shape with the file's ground, by the shape's name; two rules of one file that
  /// meet are combined as MuJoCo does.
  std::map<std::string, ContactNumbers> shapes;
  std::string ground;  ///< what stood for the ground, for people
  /// What a shape's numbers do not state is MuJoCo's default, as in an MJCF; of other files it is nothing.
  bool has_mujoco_defaults = false;
};

}  // namespace crossgait
