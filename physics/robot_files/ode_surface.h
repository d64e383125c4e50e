// How Gazebo's files say that shapes touch, in the terms of ODE, its first engine: the same in an SDF's
// <surface> and in a URDF's <gazebo>.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "physics/robot_files/contact_of_file.h"
#include "physics/robot_files/reader_warnings.h"

namespace crossgait {

/// Holds what a file says of one surface, where it says it.
struct OdeSurface {
  std::optional<double> mu, mu2, max_vel;  ///< Coulomb's coefficients in two directions, m/s
  std::map<std::string, double> spring;    ///< numbers of ODE's spring, as SDF calls them: "kp", "min_depth"
};

/// Puts a surface in the terms of contact here: `mu` is Coulomb's coefficient in both directions, `max_vel`
/// the speed of depenetration, each as far as there is one (kMostFriction, kMostDepenetrationVelocity). What
/// has no counterpart is counted, and kept in `numbers.not_simulated`.
/// @param place  of the surface, for warnings
void take_ode_surface(const OdeSurface& surface, const std::string& place, ContactNumbers& numbers,
                      ReaderWarnings& warnings);

}  // namespace crossgait
