#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "physics/core/across_axis.h"
#include "physics/core/error.h"
#include "physics/robot/multibody.h"
#include "physics/robot_files/inference/following_leg.h"
#include "physics/robot_files/inference/robot_inference.h"
#include "physics/robot_files/inference/standing_closed_leg.h"
#include "physics/robot_files/inference/turn_within.h"

namespace crossgait {
namespace {

constexpr double kMostForward = 0.15;  // of thigh and shin

/// From u to v about the unit vector `axis`, both across it, rad.
double turn_between(const Vector3& u, const Vector3& v, const Vector3& axis) {
  return std::atan2(axis.dot(u.cross(v)), u.dot(v));
}

/// A serial leg in the plane across its hip's axis, the abduction held.
class PlanarLeg {
 public:
  PlanarLeg(const RobotDescription& robot, Leg leg) : robot_(robot), model_((*robot.legs)[leg]) {
    const Pose X_knee = model_.linkage == LegLinkage::kHipFirst ? place_hip_first() : place_abduction_first();
    axis_ = X_.linear() * robot.joint(hip()).axis;
    hip_sign_ = axis_.y() < 0 ? -1 : 1;  // about the axis that points left
    axis_ *= hip_sign_;
    knee_sign_ = axis_.dot(X_knee.linear() * robot.joint(knee()).axis) < 0 ? -1 : 1;
    thigh_ = across(X_knee.translation() - X_.translation(), axis_);
    shin_ = across(X_knee * model_.p_BF - X_knee.translation(), axis_);
    aside_ = axis_.dot(X_knee * model_.p_BF - X_.translation());
  }

  double hip_x() const { return X_.translation().x(); }
  double abduction() const { return abduction_; }
  LegLengths lengths() const { return {thigh_.norm(), shin_.norm()}; }

  /// Angles in the order of the leg's servos with the foot `depth` below and `forward` of the hip.
  /// @param bend  +1: knee ahead of the line from hip to foot, -1: behind it
  /// @returns nothing if a limit forbids it
  std::optional<std::vector<double>> stand(double depth, double forward, int bend) const {
    const Vector3 foot = foot_in_plane(depth, forward);
    const double u = thigh_.norm(), l = shin_.norm();
    const double cosine = (foot.squaredNorm() - u * u - l * l) / (2 * u * l);
    if (!(std::abs(cosine) <= 1)) return std::nullopt;
    const double turned = bend * std::acos(cosine) - turn_between(thigh_, shin_, axis_);
    const Vector3 reach = thigh_ + Eigen::AngleAxisd(turned, axis_) * shin_;
    const auto hip_angle = turn_within(hip_sign_ * turn_between(reach, foot, axis_), robot_.joint(hip()));
    const auto knee_angle = turn_within(knee_sign_ * turned, robot_.joint(knee()));
    if (!hip_angle || !knee_angle) return std::nullopt;
    if (model_.servos.size() == 2) return std::vector<double>{*hip_angle, *knee_angle};
    if (model_.linkage == LegLinkage::kHipFirst)
      return std::vector<double>{*hip_angle, abduction_, *knee_angle};
    return std::vector<double>{abduction_, *hip_angle, *knee_angle};
  }

 private:
  /// Levels the hip's axis by the abduction before it. @returns the knee's frame in the base
  Pose place_abduction_first() {
    if (const int abduction = model_.joint("abduction"); abduction >= 0) {
      const Joint& joint = robot_.joint(abduction);
      const Body& base = body(abduction);
      const Vector3 hip_axis = base.X_PB.linear() * body(hip()).X_PB.linear() * robot_.joint(hip()).axis;
      abduction_ =
          std::clamp(levelling_angle(base.X_PB.linear() * joint.axis, hip_axis), joint.lower, joint.upper);
      X_ = base.X_PB * Eigen::AngleAxisd(abduction_, joint.axis);
    }
    X_ = X_ * body(hip()).X_PB;
    return X_ * body(knee()).X_PB;
  }

  /// Brings the knee's axis along the hip's, as near as it gets, by the abduction between them: then both
  /// move the foot in one plane. @returns the knee's frame in the base
  Pose place_hip_first() {
    const int abduction = model_.joint("abduction");
    const Joint& joint = robot_.joint(abduction);
    X_ = body(hip()).X_PB;
    const Pose X_abduction = body(abduction).X_PB, &X_knee = body(knee()).X_PB;
    const Vector3 hip_axis = across(X_abduction.linear().transpose() * robot_.joint(hip()).axis, joint.axis);
    const Vector3 knee_axis = across(X_knee.linear() * robot_.joint(knee()).axis, joint.axis);
    const double one = turn_between(knee_axis, hip_axis, joint.axis);
    const double other = turn_between(knee_axis, -hip_axis, joint.axis);
    abduction_ = std::clamp(std::abs(one) < std::abs(other) ? one : other, joint.lower, joint.upper);
    return X_ * X_abduction * Eigen::AngleAxisd(abduction_, joint.axis) * X_knee;
  }

  /// Finds the foot from the hip in the leg's plane, which need not be upright: `depth` and `forward` are the
  /// base's. Of legs that swing more aside than ahead they cannot both be had: these come near.
  Vector3 foot_in_plane(double depth, double forward) const {
    constexpr double kAhead = 0.5;
    if (axis_.y() < kAhead) return across(Vector3(forward, 0, -depth), axis_);
    Vector3 foot(forward - aside_ * axis_.x(), 0, -depth - aside_ * axis_.z());
    foot.y() = -(foot.x() * axis_.x() + foot.z() * axis_.z()) / axis_.y();
    return foot;
  }

  int hip() const { return model_.joint("hip"); }
  int knee() const { return model_.joint("knee"); }
  const Body& body(int joint) const { return robot_.bodies[static_cast<std::size_t>(joint) + 1]; }

  const RobotDescription& robot_;
  const LegModel& model_;
  double abduction_ = 0;
  Pose X_ = Pose::Identity();  // of the hip's body in the base at zero hip angle
  Vector3 axis_, thigh_, shin_;
  double aside_ = 0;  // of the foot from the hip, along the axis
  double hip_sign_ = 1, knee_sign_ = 1;
};

/// A leg with a knee, of whichever kind, as far as standing goes.
class StandingLeg {
 public:
  StandingLeg(const RobotDescription& robot, Leg leg) : planar_(robot, leg) {
    const LegModel& model = (*robot.legs)[leg];
    if (model.linkage == LegLinkage::kClosedChain) {
      closed_.emplace(robot, leg, planar_.abduction());
    } else if (!model.passive.empty()) {
      following_.emplace(robot, leg, planar_.abduction());
    }
  }
  double hip_x() const {
    return closed_ ? closed_->hip_x() : following_ ? following_->hip_x() : planar_.hip_x();
  }
  LegLengths lengths() const {
    return closed_ ? closed_->lengths() : following_ ? following_->lengths() : planar_.lengths();
  }
  /// Angles in the order of LegModel::joints(), of all of them or of those with a servo.
  std::optional<std::vector<double>> stand(double depth, double forward, int bend) {
    if (closed_) return closed_->stand(depth, forward, bend);
    return following_ ? following_->stand(depth, forward, bend) : planar_.stand(depth, forward, bend);
  }
  /// How far ahead of the hip the foot is at the angles of `stand`, m. @param asked  `forward` of it
  double forward_at(const std::vector<double>& angles, double asked) {
    if (closed_) return closed_->forward_at(angles);
    return following_ ? following_->forward_at(angles) : asked;
  }

 private:
  PlanarLeg planar_;
  std::optional<FollowingLeg> following_;
  std::optional<StandingClosedLeg> closed_;
};

double centre_of_mass_x(const RobotDescription& robot, const JointVector& q) {
  RobotState state;
  state.q = q;
  std::vector<Pose> poses;
  forward_kinematics(robot, state, poses);
  double moment = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const SpatialInertia& inertia = robot.bodies[i].inertia;
    moment += inertia.mass * (poses[i] * inertia.p_BC).x();
  }
  return moment / robot.total_mass();
}

void set_leg(const LegModel& model, const std::vector<double>& angles, JointVector& q) {
  const std::vector<int> joints = model.joints();
  for (std::size_t k = 0; k < angles.size(); ++k) q[joints[k]] = angles[k];
}

[[noreturn]] void fail_to_stand(const RobotDescription& robot, Leg leg, double height) {
  std::vector<std::string> limits;
  double widest = 0;
  for (const int i : (*robot.legs)[leg].joints()) {
    const Joint& joint = robot.joint(i);
    widest = std::max({widest, std::abs(joint.lower), std::abs(joint.upper)});
    limits.push_back(fmt::format("'{}' {:.3g}..{:.3g}", joint.name, joint.lower, joint.upper));
  }
  constexpr double kOfRadiansAsDegrees = 4 * M_PI / 180;  // limits of 4 rad at most, read as degrees
  constexpr double kTallest = 3;                          // m
  const char* likely = height > kTallest              ? "; likely lengths in mm or cm"
                       : widest < kOfRadiansAsDegrees ? "; likely radians that are read as degrees"
                                                      : "";
  throw ConfigError(
      robot.source, fmt::format("legs.{}", name(leg)),
      fmt::format("a leg that stands {:.3g} m below its hip, its knee forward or backward, or `home` "
                  "in a robot.yaml",
                  height),
      fmt::format("limits that forbid it: {} rad{}", fmt::join(limits, ", "), likely));
}

}  // namespace

LegLengths leg_lengths(const RobotDescription& robot, Leg leg) { return StandingLeg(robot, leg).lengths(); }

HomePose find_home(const RobotDescription& robot, double height, std::vector<Inference>& inferred) {
  HomePose home;
  home.q = JointVector::Zero(robot.joint_count());
  LegArray<int> bends{};
  LegArray<double> forward{};  // of the feet, which legs of which the knee follows do not choose
  std::vector<StandingLeg> legs;
  for (const Leg leg : kLegs) legs.emplace_back(robot, leg);
  const auto stand = [&](Leg leg) {
    StandingLeg& standing = legs[index(leg)];
    for (const int bend : {-1, 1}) {
      const auto angles = standing.stand(height, home.forward, bend);
      if (!angles) continue;
      bends[leg] = bend;
      set_leg((*robot.legs)[leg], *angles, home.q);
      robot.place_followers(home.q);
      forward[leg] = standing.forward_at(*angles, home.forward);
      return;
    }
    fail_to_stand(robot, leg, height);
  };
  for (const Leg leg : kLegs) stand(leg);
  // The legs' own masses move a little with the feet: it settles to less than a micrometre.
  constexpr int kRounds = 10;
  for (int i = 0; i < kRounds; ++i) {
    home.forward = balanced_offset(robot, home.q);
    for (const Leg leg : kLegs) stand(leg);
  }
  home.forward = std::accumulate(forward.begin(), forward.end(), 0.0) / kLegCount;
  std::vector<std::string> knees;
  for (const Leg leg : kLegs)
    knees.push_back(fmt::format("{} {}", name(leg), bends[leg] > 0 ? "forward" : "backward"));
  inferred.push_back(
      {"home", fmt::format("feet {:.4g} m below the hips, knees: {}", height, fmt::join(knees, ", ")),
       fmt::format("{} of thigh and shin; backward unless the limits forbid it", kStandingShare)});
  inferred.push_back({"stance_offset", fmt::format("{:.4g} m", home.forward), kStanceOffsetReason});
  return home;
}

double balanced_offset(const RobotDescription& robot, const JointVector& q) {
  double hips = 0, length = 0;
  for (const Leg leg : kLegs) {
    const StandingLeg planar(robot, leg);
    hips += planar.hip_x() / kLegCount;
    length += planar.lengths().sum() / kLegCount;
  }
  const double ahead = centre_of_mass_x(robot, q) - hips;
  return std::clamp(ahead, -kMostForward * length, kMostForward * length);
}

std::string problem_with_stance(const RobotDescription& robot, const JointVector& q) {
  for (int i = 0; i < robot.joint_count(); ++i) {
    const Joint& joint = robot.joint(i);
    if (!(q[i] >= joint.lower && q[i] <= joint.upper))
      return fmt::format("joint '{}' is at {:.4g} rad, beyond its limits", joint.name, q[i]);
  }
  RobotState state;
  state.q = q;
  std::vector<Pose> poses;
  forward_kinematics(robot, state, poses);
  double least = std::numeric_limits<double>::infinity(), most = -least, length = 0;
  for (const Leg leg : kLegs) {
    const int hip = (*robot.legs)[leg].joint("hip");
    const double depth =
        poses[static_cast<std::size_t>(hip) + 1].translation().z() - foot_position(robot, leg, poses).z();
    least = std::min(least, depth);
    most = std::max(most, depth);
    length += leg_lengths(robot, leg).sum() / kLegCount;
  }
  constexpr double kThird = 1.0 / 3;
  if (least < kThird * length || most - least > kThird * length)
    return fmt::format("its feet are {:.3g} to {:.3g} m below the hips, of legs of {:.3g} m", least, most,
                       length);
  return "";
}

ServoRule servo_rule(double mass, double height, double leg_length) {
  const double g = kGravity, weight = mass * g;
  ServoRule rule;
  rule.kp = 3 * weight * height;
  // Damping ratio 0.3 at the pitch of a leg that gives way by 0.03 h.
  rule.kd = 2 * 0.3 * rule.kp / std::sqrt(g / (0.03 * height));
  rule.armature = 0.005 * mass * height * height;
  rule.effort_limit = 0.8 * weight * height;
  rule.largest_real_effort = 3 * weight * leg_length;
  return rule;
}

}  // namespace crossgait
