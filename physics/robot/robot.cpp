#include "physics/robot/robot.h"

#include <algorithm>
#include <array>

#include "physics/robot/robot_check.h"

namespace crossgait {
namespace {

constexpr std::array<LegRole, 5> kFiveBarRoles{{{"tilt", -1, true},
                                                {"shoulder_left", 0, true},
                                                {"shoulder_right", 0, true},
                                                {"elbow_left", 1, false},
                                                {"elbow_right", 2, false}}};
constexpr std::array<LegRole, 3> kSerialRoles{{{"abduction", -1, true}, {"hip", 0, true}, {"knee", 1, true}}};
constexpr std::array<LegRole, 3> kHipFirstRoles{
    {{"hip", -1, true}, {"abduction", 0, true}, {"knee", 1, true}}};
constexpr std::array<LegRole, 2> kHipKneeRoles{{{"hip", -1, true}, {"knee", 0, true}}};

}  // namespace

std::span<const LegRole> LegModel::roles() const noexcept {
  if (linkage == LegLinkage::kFiveBar) return kFiveBarRoles;
  if (linkage == LegLinkage::kHipFirst) return kHipFirstRoles;
  return servos.size() == kHipKneeRoles.size() ? std::span<const LegRole>(kHipKneeRoles) : kSerialRoles;
}

std::vector<int> LegModel::joints() const {
  std::vector<int> all = servos;
  all.insert(all.end(), passive.begin(), passive.end());
  return all;
}

int LegModel::joint(std::string_view role) const noexcept {
  const std::span<const LegRole> known = roles();
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (known[i].name != role) continue;
    if (i < servos.size()) return servos[i];
    return i - servos.size() < passive.size() ? passive[i - servos.size()] : -1;
  }
  return -1;
}

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

bool RobotDescription::has_joint_friction() const noexcept {
  return std::any_of(bodies.begin(), bodies.end(), [](const Body& body) { return body.joint.friction > 0; });
}

bool RobotDescription::has_joint_limits() const noexcept {
  return std::any_of(bodies.begin(), bodies.end(), [](const Body& body) { return body.joint.limited; });
}

void RobotDescription::validate() const {
  check_structure(*this);
  check_home(*this);
  check_finite(*this);
}

}  // namespace crossgait
