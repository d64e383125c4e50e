#include "physics/robot/robot.h"

#include <algorithm>
#include <array>

#include "physics/robot/followed_joint.h"
#include "physics/robot/robot_check.h"

namespace crossgait {
namespace {

constexpr std::array<LegRole, 5> kFiveBarRoles{{{"tilt", -1, true},
                                                {"shoulder_left", 0, true},
                                                {"shoulder_right", 0, true},
                                                {"elbow_left", 1, false},
                                                {"elbow_right", 2, false}}};
constexpr std::array<LegRole, 4> kPlanarFiveBarRoles{{{"shoulder_left", -1, true},
                                                      {"shoulder_right", -1, true},
                                                      {"elbow_left", 0, false},
                                                      {"elbow_right", 1, false}}};
// The ankle is there where a leg has one that follows.
constexpr std::array<LegRole, 4> kSerialRoles{
    {{"abduction", -1, true}, {"hip", 0, true}, {"knee", 1, true}, {"ankle", 2, false}}};
constexpr std::array<LegRole, 4> kHipFirstRoles{
    {{"hip", -1, true}, {"abduction", 0, true}, {"knee", 1, true}, {"ankle", 2, false}}};
constexpr std::array<LegRole, 3> kHipKneeRoles{{{"hip", -1, true}, {"knee", 0, true}, {"ankle", 1, false}}};
constexpr std::array<LegRole, 4> kKneeFollowsRoles{
    {{"abduction", -1, true}, {"hip", 0, true}, {"knee", 1, false}, {"ankle", 2, false}}};

}  // namespace

double JointCoupling::follower_at(double angle) const noexcept {
  double value = 0;
  for (auto c = coefficients.rbegin(); c != coefficients.rend(); ++c) value = value * angle + *c;
  return value;
}

double JointCoupling::slope_at(double angle) const noexcept {
  double value = 0;
  for (std::size_t power = coefficients.size() - 1; power > 0; --power)
    value = value * angle + static_cast<double>(power) * coefficients[power];
  return value;
}

bool JointCoupling::is_linear() const noexcept {
  return std::all_of(coefficients.begin() + 2, coefficients.end(), [](double c) { return c == 0; });
}

std::span<const LegRole> LegModel::roles() const noexcept {
  if (linkage == LegLinkage::kFiveBar && servos.size() == 2) return kPlanarFiveBarRoles;
  if (linkage == LegLinkage::kFiveBar) return kFiveBarRoles;
  if (linkage == LegLinkage::kKneeFollows)
    return std::span(kKneeFollowsRoles).first(passive.size() > 1 ? 4 : 3);
  const std::size_t ankles = passive.empty() ? 0 : 1;
  if (linkage == LegLinkage::kHipFirst) return std::span(kHipFirstRoles).first(3 + ankles);
  if (servos.size() == 2) return std::span(kHipKneeRoles).first(2 + ankles);
  return std::span(kSerialRoles).first(3 + ankles);
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

const JointCoupling* RobotDescription::coupling_of(int follower) const noexcept {
  const auto found = std::find_if(couplings.begin(), couplings.end(),
                                  [follower](const JointCoupling& c) { return c.follower == follower; });
  return found == couplings.end() ? nullptr : &*found;
}

FollowedJoint follow_couplings(const RobotDescription& robot, int joint, std::span<const int> ends) {
  FollowedJoint followed{.joint = joint};
  for (std::size_t step = 0; step <= robot.couplings.size(); ++step) {
    followed.is_one_of_them = std::find(ends.begin(), ends.end(), followed.joint) != ends.end();
    const JointCoupling* coupling = robot.coupling_of(followed.joint);
    if (followed.is_one_of_them || coupling == nullptr) return followed;
    if (followed.not_linear == nullptr && !coupling->is_linear()) followed.not_linear = coupling;
    // multiplier (c1 leader + c0) + offset
    followed.offset += followed.multiplier * coupling->coefficients[0];
    followed.multiplier *= coupling->coefficients[1];
    followed.joint = coupling->leader;
  }
  followed.in_a_circle = true;
  return followed;
}

void RobotDescription::place_followers(JointVector& q) const noexcept {
  // In a chain of n the last one is right after n rounds, in whichever order they are.
  for (std::size_t round = 0; round < couplings.size(); ++round) {
    for (const JointCoupling& coupling : couplings)
      if (!joint(coupling.follower).actuated) q[coupling.follower] = coupling.follower_at(q[coupling.leader]);
  }
}

void RobotDescription::validate() const {
  check_structure(*this);
  check_home(*this);
  check_finite(*this);
}

}  // namespace crossgait
