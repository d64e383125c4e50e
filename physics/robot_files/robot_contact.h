// What the files of a robot ask of contacts, as settings of contact.
#pragma once

#include "physics/core/yaml_reader.h"
#include "physics/robot_files/robot_report.h"

namespace crossgait {

/// Returns the file's numbers of a foot's shape; of a foot that was made, those of the shape that it stands
/// for. Null where the file says nothing of it.
const ContactNumbers* contact_of_foot(const RobotDescription& robot, const RobotReport& report, Leg leg);

/// Returns what the file asks of the contact of its feet: a world has one contact, and the feet are what
/// stands. Adds a warning where feet are not alike, and takes the first then. MuJoCo's defaults are part of
/// what an MJCF says. Nothing of a file that knows no contact.
ContactSettings contact_of_feet(const RobotDescription& robot, RobotReport& report);

/// Reads a mapping from settings to numbers, lists of them, or words. @throws ConfigError
ContactSettings read_contact_settings(const YamlValue& mapping);
/// Writes settings as YAML in one line: "{impratio: 100, solref: [0.005, 1]}".
std::string yaml_of(const ContactSettings& contact);

}  // namespace crossgait
