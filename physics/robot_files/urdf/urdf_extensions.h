// What a URDF says to Gazebo, PyBullet and ros_control beside what every reader of it takes.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "physics/robot_files/contact_of_file.h"
#include "physics/robot_files/parsed_robot.h"
#include "physics/robot_files/urdf/urdf_elements.h"

namespace crossgait {

/// Holds a spring beside a joint's servo.
struct UrdfSpring {
  double stiffness = 0, reference = 0;  ///< N m/rad, rad
};

struct UrdfExtensions {
  std::map<std::string, ContactNumbers> surfaces;  ///< by link
  std::map<std::string, UrdfSpring> springs;       ///< by joint
  std::vector<UnusedQuantity> unused;
  std::string ground;  ///< that the surfaces meet, for people
};

/// Reads the elements of `robot` that are neither links nor joints, and the links' `<contact>`
/// (urdf_contact.h):
///  - `<gazebo reference>`: `mu1`, `mu2`, `maxVel` and ODE's spring of a link's shapes (ode_surface.h),
///    `springStiffness` and `springReference` of a joint. What has no counterpart here is listed as unused;
///    of several that say one thing the last counts. Plug-ins are listed, not run; looks are passed over.
///  - `<transmission>`: reductions and hardware interfaces of joints, listed as unused.
///  - Any other is counted, as are attributes of `robot` that no URDF has.
/// @throws ConfigError naming the line and the element where a number is none, or below 0 where it must not
/// be
UrdfExtensions read_urdf_extensions(const TiXmlElement& robot, const UrdfErrors& errors,
                                    ReaderWarnings& warnings);

}  // namespace crossgait
