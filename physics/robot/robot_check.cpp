#include "physics/robot/robot_check.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/robot/followed_joint.h"
#include "physics/robot/joint_numbers.h"
#include "physics/robot/loop_closing.h"
#include "physics/robot/multibody.h"
#include "physics/robot/robot_members.h"

namespace crossgait {
namespace {

/// Rounding allowed in unit axes, rotations and inertias (entries of order one, or relative).
constexpr double kRounding = 1e-9;

std::string to_text(const Vector3& v) { return fmt::format("({}, {}, {})", v.x(), v.y(), v.z()); }

/// Throws for one element of one source.
class Reporter {
 public:
  Reporter(std::string_view source, std::string element) : source_(source), element_(std::move(element)) {}

  void require(bool ok, std::string_view expected, std::string_view found) const {
    if (!ok) throw ConfigError(source_, element_, expected, found);
  }
  void positive(double value, std::string_view what, double most) const {
    require(std::isfinite(value) && value > 0, fmt::format("{} > 0", what), fmt::format("{}", value));
    at_most(value, what, most);
  }
  void not_negative(double value, std::string_view what, double most) const {
    require(std::isfinite(value) && value >= 0, fmt::format("{} >= 0", what), fmt::format("{}", value));
    at_most(value, what, most);
  }
  void at_most(double value, std::string_view what, double most) const {
    require(std::abs(value) <= most, fmt::format("{} of at most {:g}", what, most), fmt::format("{}", value));
  }
  void finite(const Vector3& value, std::string_view what) const {
    require(value.allFinite(), fmt::format("finite {}", what), to_text(value));
    for (const double coordinate : value) at_most(coordinate, what, kLargestLength);
  }
  void proper(const Pose& pose, std::string_view what) const {
    finite(pose.translation(), what);
    const Matrix3 R = pose.linear();
    const bool orthonormal = (R * R.transpose() - Matrix3::Identity()).cwiseAbs().maxCoeff() < kRounding;
    require(orthonormal && R.determinant() > 0, fmt::format("a rotation in {}", what), "another matrix");
  }

 private:
  std::string_view source_;
  std::string element_;
};

std::string_view source_of(const RobotDescription& robot) {
  return robot.source.empty() ? std::string_view(robot.name) : std::string_view(robot.source);
}

void check_bodies(const RobotDescription& robot) {
  const std::string_view source = source_of(robot);
  std::set<std::string> bodies, joints, shapes;
  for (std::size_t i = 0; i < robot.bodies.size(); ++i) {
    const Body& body = robot.bodies[i];
    const Reporter report(source, fmt::format("body '{}'", body.name));
    report.require(!body.name.empty() && bodies.insert(body.name).second, "a unique name",
                   fmt::format("'{}'", body.name));
    const int last_parent = static_cast<int>(i) - 1;
    report.require(i == 0 ? body.parent == -1 : body.parent >= 0 && body.parent <= last_parent,
                   i == 0 ? "no parent (-1) of the base" : fmt::format("a parent in 0..{}", last_parent),
                   std::to_string(body.parent));
    report.proper(body.X_PB, "the pose in the parent");
    check_inertia(body.inertia, source, fmt::format("body '{}'", body.name));
    for (const CollisionShape& shape : body.shapes) {
      const std::string element = fmt::format("collision shape '{}'", shape.name);
      Reporter(source, element)
          .require(!shape.name.empty() && shapes.insert(shape.name).second, "a unique name", "a second one");
      check_shape(shape, source, element);
    }
    if (i == 0) continue;
    report.require(!body.joint.name.empty() && joints.insert(body.joint.name).second, "a unique joint name",
                   fmt::format("'{}'", body.joint.name));
    check_joint(body.joint, source);
  }
}

bool has_body(const RobotDescription& robot, int body) { return body >= 0 && body <= robot.joint_count(); }
bool has_joint(const RobotDescription& robot, int joint) { return joint >= 0 && joint < robot.joint_count(); }

/// Name of a body, also of one that does not exist.
std::string body_name(const RobotDescription& robot, int body) {
  return has_body(robot, body) ? fmt::format("link '{}'", robot.bodies[static_cast<std::size_t>(body)].name)
                               : "no link";
}

std::string joint_name(const RobotDescription& robot, int joint) {
  return has_joint(robot, joint) ? fmt::format("joint '{}'", robot.joint(joint).name) : "no joint";
}

void check_loops(const RobotDescription& robot) {
  std::set<std::string> names;
  for (const LoopClosure& loop : robot.loops) {
    const Reporter report(source_of(robot), fmt::format("loop '{}'", loop.name));
    report.require(!loop.name.empty() && names.insert(loop.name).second, "a unique name", "a second one");
    report.require(has_body(robot, loop.body_a) && has_body(robot, loop.body_b) && loop.body_a != loop.body_b,
                   "two bodies",
                   fmt::format("{} and {}", body_name(robot, loop.body_a), body_name(robot, loop.body_b)));
    report.finite(loop.p_AP, "point on body a (m)");
    report.finite(loop.p_BP, "point on body b (m)");
  }
}

void check_couplings(const RobotDescription& robot) {
  std::set<int> followers;
  for (const JointCoupling& coupling : robot.couplings) {
    const bool has_joints = has_joint(robot, coupling.follower) && has_joint(robot, coupling.leader) &&
                            coupling.follower != coupling.leader;
    Reporter(source_of(robot), "couplings")
        .require(has_joints, "a follower and another joint that leads it",
                 fmt::format("{} and {}", joint_name(robot, coupling.follower),
                             joint_name(robot, coupling.leader)));
    const std::string element = fmt::format("coupling of joint '{}'", robot.joint(coupling.follower).name);
    const Reporter report(source_of(robot), element);
    report.require(followers.insert(coupling.follower).second, "one joint that it follows", "a second one");
    for (const double c : coupling.coefficients) {
      report.require(std::isfinite(c), "finite coefficients", fmt::format("{}", c));
      report.at_most(c, "coefficients", kLargestAngle);
    }
    validate_softness(coupling.softness, source_of(robot), element + ": softness");
  }
  for (const JointCoupling& coupling : robot.couplings) {
    Reporter(source_of(robot), fmt::format("coupling of joint '{}'", robot.joint(coupling.follower).name))
        .require(!follow_couplings(robot, coupling.follower, {}).in_a_circle,
                 "a joint that leads and follows none in the end",
                 fmt::format("'{}', which follows it in a circle", robot.joint(coupling.leader).name));
  }
}

/// Names stand in tables, which a line end would break; what else a terminal obeys is shown as it is written.
void require_one_line(const RobotDescription& robot, std::string name, std::string_view of) {
  if (name.find_first_of("\r\n") == std::string::npos) return;
  std::ranges::replace_if(
      name, [](char c) { return c == '\r' || c == '\n'; }, ' ');
  throw ConfigError(source_of(robot), of, "a name in one line", fmt::format("'{}' in several", name));
}

void check_roles(const RobotDescription& robot, Leg leg, std::set<int>& used) {
  const LegModel& model = (*robot.legs)[leg];
  const std::string_view source = source_of(robot);
  const LegRoles roles = model.roles();
  const std::vector<int> joints = model.joints();
  Reporter(source, fmt::format("legs.{}", name(leg)))
      .require(joints.size() == roles.size(), fmt::format("{} joints", roles.size()),
               std::to_string(joints.size()));
  for (std::size_t i = 0; i < roles.size(); ++i) {
    const LegRole& role = roles[i];
    const Reporter report(source, fmt::format("legs.{}.{}", name(leg), role.name));
    const int joint = joints[i];
    report.require(joint >= 0 && joint < robot.joint_count(), "the index of a joint", std::to_string(joint));
    const Body& body = robot.bodies[static_cast<std::size_t>(joint) + 1];
    report.require(used.insert(joint).second, "each joint once",
                   fmt::format("joint '{}' again", body.joint.name));
    const std::string found = fmt::format("joint '{}' on {}", body.joint.name, body_name(robot, body.parent));
    if (role.parent == LegRole::kAnyParent) {
      report.require(body.parent == 0 || std::ranges::count(joints, body.parent - 1) > 0,
                     "a joint on the base or on a link of the leg", found);
    } else {
      const int parent = role.parent < 0 ? 0 : joints[static_cast<std::size_t>(role.parent)] + 1;
      report.require(body.parent == parent, fmt::format("a joint on {}", body_name(robot, parent)), found);
    }
    report.require(body.joint.actuated == role.actuated, role.actuated ? "a servo" : "a passive joint",
                   "the opposite");
  }
}

/// What moves in a serial leg without a servo follows one of its servos, in proportion.
void check_followers(const RobotDescription& robot, Leg leg) {
  const LegModel& model = (*robot.legs)[leg];
  for (std::size_t i = 0; i < model.passive.size(); ++i) {
    const Reporter report(source_of(robot),
                          fmt::format("legs.{}.{}", name(leg), model.roles()[model.servos.size() + i].name));
    const FollowedJoint followed = follow_couplings(robot, model.passive[i], model.servos);
    report.require(followed.is_one_of_them, "a servo, or a joint that follows one of this leg",
                   fmt::format("joint '{}'", robot.joint(followed.joint).name));
    const JointCoupling* bent = followed.not_linear;
    report.require(
        bent == nullptr, "a coupling of at most two coefficients in a leg",
        bent == nullptr ? "" : fmt::format("one of higher powers of '{}'", robot.joint(bent->leader).name));
  }
}

/// A closed chain has hip and knee, each part between base and foot once, and is no larger than what holds
/// it.
void check_parts(const RobotDescription& robot, Leg leg) {
  const LegModel& model = (*robot.legs)[leg];
  const Reporter report(source_of(robot), fmt::format("legs.{}", name(leg)));
  const bool is_closed_chain = model.linkage == LegLinkage::kClosedChain;
  const std::size_t joints = model.joints().size(), parts = is_closed_chain ? joints : 0;
  report.require(model.parts.size() == parts, fmt::format("{} parts of a closed chain", parts),
                 std::to_string(model.parts.size()));
  if (!is_closed_chain) return;
  report.require(joints <= kMaxLegJoints, fmt::format("at most {} joints", kMaxLegJoints),
                 std::to_string(joints));
  report.require(model.servos.size() == 2 || model.servos.size() == 3, "2 or 3 servos",
                 std::to_string(model.servos.size()));
  for (const LegPart part : {LegPart::kHip, LegPart::kKnee}) {
    report.require(std::ranges::count(model.parts, part) == 1, "one hip and one knee",
                   std::to_string(std::ranges::count(model.parts, part)));
  }
  for (const LegPart part : {LegPart::kAbduction, LegPart::kAnkle}) {
    report.require(std::ranges::count(model.parts, part) <= 1, "at most one abduction and one ankle",
                   std::to_string(std::ranges::count(model.parts, part)));
  }
}

void check_leg(const RobotDescription& robot, Leg leg, std::set<int>& used) {
  check_parts(robot, leg);
  check_roles(robot, leg, used);
  const LegModel& model = (*robot.legs)[leg];
  const std::string_view source = source_of(robot);
  const bool five_bar = model.linkage == LegLinkage::kFiveBar;
  if (!five_bar && model.linkage != LegLinkage::kClosedChain) check_followers(robot, leg);
  // The last link of a serial leg, or either lower link of a five-bar.
  const int right = (five_bar ? model.joints().back() : model.last_joint()) + 1;
  const int left = five_bar ? model.passive.front() + 1 : right;
  const Reporter foot(source, fmt::format("legs.{}.foot", name(leg)));
  foot.require(model.foot_body == left || model.foot_body == right, "a foot on a lower link of its leg",
               fmt::format("one on {}", body_name(robot, model.foot_body)));
  foot.finite(model.p_BF, "foot centre (m)");
  foot.positive(model.foot_radius, "foot radius (m)", kLargestLength);
  if (!five_bar) return;
  bool closed = false;
  for (const LoopClosure& loop : robot.loops) {
    closed |= (loop.body_a == left && loop.body_b == right) || (loop.body_a == right && loop.body_b == left);
  }
  Reporter(source, fmt::format("legs.{}", name(leg)))
      .require(closed, "a loop between the two lower links", "none");
}

}  // namespace

void check_inertia(const SpatialInertia& inertia, std::string_view source, std::string_view element) {
  const Reporter report(source, std::string(element));
  report.positive(inertia.mass, "mass (kg)", kHeaviestBody);
  report.require(inertia.mass >= kLightestBody, fmt::format("mass (kg) of at least {:g}", kLightestBody),
                 fmt::format("{}", inertia.mass));
  report.finite(inertia.p_BC, "centre of mass (m)");
  const Matrix3& I = inertia.I_C;
  report.require(I.allFinite(), "finite inertia (kg m^2)", "a value that is not");
  report.at_most(I.cwiseAbs().maxCoeff(), "inertia (kg m^2)", kLargestInertia);
  report.require((I - I.transpose()).cwiseAbs().maxCoeff() <= kRounding * I.cwiseAbs().maxCoeff(),
                 "symmetric inertia", "ixy, ixz or iyz that differ across the diagonal");
  const Vector3 moments = Eigen::SelfAdjointEigenSolver<Matrix3>(I, Eigen::EigenvaluesOnly).eigenvalues();
  report.require(moments[0] > 0, "positive definite inertia",
                 fmt::format("principal moments {} kg m^2", to_text(moments)));
  report.require(moments[2] <= (moments[0] + moments[1]) * (1 + kRounding),
                 "inertia of a real body (largest principal moment <= sum of the other two)",
                 fmt::format("principal moments {} kg m^2", to_text(moments)));
}

void check_joint(const Joint& joint, std::string_view source) {
  const Reporter report(source, fmt::format("joint '{}'", joint.name));
  const bool unit = joint.axis.allFinite() && std::abs(joint.axis.norm() - 1) < kRounding;
  report.require(unit, "a unit axis", to_text(joint.axis));
  report.require(std::isfinite(joint.lower) && std::isfinite(joint.upper) && joint.lower < joint.upper,
                 "finite limits with lower < upper (rad)",
                 fmt::format("{} and {}", joint.lower, joint.upper));
  report.at_most(joint.lower, "limits (rad)", kLargestAngle);
  report.at_most(joint.upper, "limits (rad)", kLargestAngle);
  validate_softness(joint.limit_softness, source, fmt::format("joint '{}': limit_softness", joint.name));
  report.require(joint.target_lower <= joint.target_upper, "target_lower <= target_upper (rad)",
                 fmt::format("{} and {}", joint.target_lower, joint.target_upper));
  report.at_most(joint.target_lower, "range of targets (rad)", kLargestAngle);
  report.at_most(joint.target_upper, "range of targets (rad)", kLargestAngle);
  report.at_most(joint.spring_reference, "spring_reference (rad)", kLargestAngle);
  const auto check = [&](const JointNumber& number) {
    const std::string what =
        number.words.empty() ? fmt::format("{} ({})", number.name, number.unit) : std::string(number.words);
    const double value = joint.*number.member;
    number.positive ? report.positive(value, what, number.most)
                    : report.not_negative(value, what, number.most);
  };
  for (const JointNumber& number : kJointNumbers) {
    if (number.of == JointNumberOf::kJoint || joint.actuated) check(number);
  }
  report.require(!joint.actuated || joint.no_load_speed > 0 || joint.corner_speed == 0,
                 "no_load_speed (rad/s) beside corner_speed, which means nothing alone", "none");
  report.require(!joint.actuated || joint.no_load_speed == 0 || joint.no_load_speed > joint.corner_speed,
                 "corner_speed < no_load_speed (rad/s)",
                 fmt::format("{} and {}", joint.corner_speed, joint.no_load_speed));
}

void check_shape(const CollisionShape& shape, std::string_view source, std::string_view element) {
  const Reporter report(source, std::string(element));
  report.proper(shape.X_BG, "the pose on the body");
  if (shape.type == ShapeType::kHull) {
    const auto count = shape.vertices.size();
    report.require(count >= 4 && count <= kMaxHullVertices, fmt::format("4 to {} vertices", kMaxHullVertices),
                   std::to_string(count));
    for (const Vector3& vertex : shape.vertices) report.finite(vertex, "vertices (m)");
    return;
  }
  const bool is_round = shape.type == ShapeType::kCylinder || shape.type == ShapeType::kCapsule;
  const int sizes = shape.type == ShapeType::kSphere ? 1 : is_round ? 2 : 3;
  for (int i = 0; i < sizes; ++i) report.positive(shape.size[i], "size (m)", kLargestLength);
}

void check_structure(const RobotDescription& robot) {
  const Reporter report(source_of(robot), "robot");
  require_one_line(robot, robot.name, "robot");
  for (const Body& body : robot.bodies) {
    require_one_line(robot, body.name, "link");
    require_one_line(robot, body.joint.name, "joint");
  }
  report.require(!robot.bodies.empty(), "at least one body", "none");
  report.require(robot.joint_count() <= kMaxJoints, fmt::format("at most {} moving joints", kMaxJoints),
                 std::to_string(robot.joint_count()));
  check_couplings(robot);
  // Legs before bodies: a joint in the wrong role also breaks the order of bodies, and its role says more.
  if (robot.legs) {
    std::set<int> used;
    for (const Leg leg : kLegs) check_leg(robot, leg, used);
  }
  check_bodies(robot);
  check_loops(robot);
  ContactSpec contact;
  robot.contact.apply(contact);
  validate_contact(contact, source_of(robot));
  validate_softness(robot.loop_softness, source_of(robot), "loop_softness");
  validate_softness(robot.friction_softness, source_of(robot), "friction_softness");
}

void check_finite(const RobotDescription& robot) {
  for_each_leaf(robot, [&robot](const MemberPath& path, const auto& leaf) {
    if constexpr (std::is_same_v<decltype(leaf), const double&>) {
      if (!std::isfinite(leaf))
        throw ConfigError(source_of(robot), path.text(), "a finite number", fmt::format("{}", leaf));
    }
  });
}

void check_home(const RobotDescription& robot) {
  const Reporter report(source_of(robot), "home");
  report.require(robot.home.size() == robot.joint_count(),
                 fmt::format("{} joint angles", robot.joint_count()), std::to_string(robot.home.size()));
  report.require(std::isfinite(robot.home_height), "a finite height (m)",
                 fmt::format("{}", robot.home_height));
  for (int i = 0; i < robot.joint_count(); ++i) {
    const Joint& joint = robot.joint(i);
    const double angle = robot.home[i];
    report.require(angle >= joint.lower && angle <= joint.upper,
                   fmt::format("joint '{}' in {}..{} rad", joint.name, joint.lower, joint.upper),
                   fmt::format("{}", angle));
  }
  const std::vector<Pose> poses = home_poses(robot);
  const double gap = max_loop_gap(robot, poses);
  report.require(gap < kLoopTolerance, fmt::format("loops closed to {} m", kLoopTolerance),
                 fmt::format("a gap of {} m", gap));
  for (const JointCoupling& coupling : robot.couplings) {
    const double off = robot.home[coupling.follower] - coupling.follower_at(robot.home[coupling.leader]);
    // Two servos of a coupling may pull against it.
    report.require(robot.joint(coupling.follower).actuated || std::abs(off) < kHomeCouplingTolerance,
                   fmt::format("joint '{}' where '{}' has it, to {} rad", robot.joint(coupling.follower).name,
                               robot.joint(coupling.leader).name, kHomeCouplingTolerance),
                   fmt::format("{} rad away", off));
  }
}

}  // namespace crossgait
