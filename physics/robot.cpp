#include "crossgait/physics/robot.h"

#include "crossgait/physics/robot_check.h"

namespace crossgait {

std::vector<int> RobotDescription::actuated_joints() const {
  std::vector<int> joints;
  for (int i = 0; i < joint_count(); ++i) {
    if (joint(i).actuated) joints.push_back(i);
  }
  return joints;
}

double RobotDescription::total_mass() const {
  double mass = 0;
  for (const Body& body : bodies) mass += body.inertia.mass;
  return mass;
}

void RobotDescription::validate() const {
  check_structure(*this);
  check_home(*this);
}

}  // namespace crossgait
