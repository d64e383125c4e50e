// How an SDF's shapes touch.
#pragma once

#include <optional>
#include <string>

#include "physics/robot_files/contact_of_file.h"
#include "physics/robot_files/reader_warnings.h"
#include "physics/robot_files/sdf/sdf_document.h"

namespace crossgait {

/// Reads the `<surface>` of a collision: `mu` is Coulomb's coefficient in both directions, and a torsional
/// coefficient with a patch of fixed radius a length (Gazebo, "Torsional friction": the torque is
/// 3 pi / 16 times coefficient, radius and load). Stiffness and damping of contacts, bounces and friction of
/// other kinds are not of this contact law, and counted. Empty if it says nothing of them.
/// @throws ConfigError naming the element
std::optional<ContactNumbers> read_contact(const SdfElement& collision, const std::string& main_file,
                                           ReaderWarnings& warnings);

/// Reads what a world says of steps and gravity.
ContactOfFile read_world(const SdfElement& world);

}  // namespace crossgait
