// What a URDF's links say of contact to PyBullet.
#pragma once

#include <vector>

#include "physics/robot_files/contact_of_file.h"
#include "physics/robot_files/parsed_robot.h"
#include "physics/robot_files/urdf/urdf_elements.h"

namespace crossgait {

/// Reads the first `<contact>` of a link, words of PyBullet's UrdfParser.cpp: `lateral_friction` is Coulomb's
/// coefficient (against a ground of 1: Bullet multiplies the two), `spinning_friction` and `rolling_friction`
/// (m) those against turning and rolling, which count where they are above 0, with Bullet's 0.5 against
/// sliding where the file says none. What no contact here has of it
/// joins `unused`, and what no file has is counted.
/// @returns what nothing is stated in, if the link has no `<contact>`
/// @throws ConfigError naming the line and the element where a value is no number from 0 on
ContactNumbers read_urdf_contact(const TiXmlElement& link, const UrdfErrors& errors, ReaderWarnings& warnings,
                                 std::vector<UnusedQuantity>& unused);

}  // namespace crossgait
