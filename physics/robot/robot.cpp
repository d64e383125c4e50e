#include "physics/robot/robot.h"

#include <algorithm>
#include <array>

#include "physics/core/across_axis.h"
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

constexpr std::array<std::string_view, 4> kCranks{"crank", "crank_2", "crank_3", "crank_4"};
constexpr std::array<std::string_view, 8> kRods{"rod",   "rod_2", "rod_3", "rod_4",
                                                "rod_5", "rod_6", "rod_7", "rod_8"};

LegRoles closed_chain_roles(const LegModel& leg) noexcept {
  LegRoles roles;
  std::size_t cranks = 0, rods = 0;
  for (std::size_t i = 0; i < std::min(leg.parts.size(), kMaxLegJoints); ++i) {
    const bool has_servo = i < leg.servos.size();
    std::string_view role = name(leg.parts[i]);
    if (leg.parts[i] == LegPart::kBar)
      role = has_servo ? kCranks[std::min(cranks++, kCranks.size() - 1)]
                       : kRods[std::min(rods++, kRods.size() - 1)];
    roles.push_back({role, LegRole::kAnyParent, has_servo});
  }
  return roles;
}

}  // namespace

std::string_view name(LegPart part) noexcept {
  constexpr std::array<std::string_view, 5> kNames{"abduction", "hip", "knee", "ankle", "bar"};
  return kNames[static_cast<std::size_t>(part)];
}

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

LegRoles LegModel::roles() const noexcept {
  if (linkage == LegLinkage::kClosedChain) return closed_chain_roles(*this);
  if (linkage == LegLinkage::kFiveBar)
    return servos.size() == 2 ? LegRoles(kPlanarFiveBarRoles) : LegRoles(kFiveBarRoles);
  if (linkage == LegLinkage::kKneeFollows)
    return LegRoles(std::span(kKneeFollowsRoles).first(passive.size() > 1 ? 4 : 3));
  const std::size_t ankles = passive.empty() ? 0 : 1;
  if (linkage == LegLinkage::kHipFirst) return LegRoles(std::span(kHipFirstRoles).first(3 + ankles));
  if (servos.size() == 2) return LegRoles(std::span(kHipKneeRoles).first(2 + ankles));
  return LegRoles(std::span(kSerialRoles).first(3 + ankles));
}

std::vector<int> LegModel::joints() const {
  std::vector<int> all = servos;
  all.insert(all.end(), passive.begin(), passive.end());
  return all;
}

int LegModel::place(std::string_view role) const noexcept {
  const LegRoles known = roles();
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (known[i].name == role) return static_cast<int>(i);
  }
  return -1;
}

int LegModel::joint(std::string_view role) const noexcept {
  const int found = place(role);
  if (found < 0) return -1;
  const auto i = static_cast<std::size_t>(found);
  if (i < servos.size()) return servos[i];
  return i - servos.size() < passive.size() ? passive[i - servos.size()] : -1;
}

int LegModel::last_joint() const noexcept {
  const int ankle = joint("ankle");
  return ankle >= 0 ? ankle : joint("knee");
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

int leg_of_shape(const RobotDescription& robot, int body, int shape) noexcept {
  constexpr double kAsFar = 0.85;
  if (!robot.legs) return -1;
  const Body& of = robot.bodies[static_cast<std::size_t>(body)];
  const CollisionShape& s = of.shapes[static_cast<std::size_t>(shape)];
  const Vector3& p = s.X_BG.translation();
  for (const Leg leg : kLegs) {
    const LegModel& model = (*robot.legs)[leg];
    if (model.foot_body != body || s.type != ShapeType::kSphere) continue;
    const auto away = [&of](const Vector3& v) { return across(v, of.joint.axis).norm(); };
    if (p.isApprox(model.p_BF, 1e-9) || away(p) >= kAsFar * away(model.p_BF)) return static_cast<int>(leg);
  }
  return -1;
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
