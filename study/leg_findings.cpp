#include "study/leg_findings.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "ik/leg_kinematics.h"
#include "physics/robot/actuator.h"
#include "physics/robot/hips.h"
#include "physics/robot/multibody.h"
#include "study/likely_unit.h"

namespace crossgait {
namespace {

constexpr double kAtLimit = 0.01;  // rad
constexpr double kAside = 0.5;     // of the standing height: a base's origin out of the middle of the legs
constexpr double kUneven = 0.1;    // of the standing height: feet at home, of each other
constexpr double kFoot = 0.07;     // of the standing height: the radius of a usual foot
constexpr double kLeastFoot = 0.005, kMostFoot = 0.5;  // of the standing height, radii
constexpr double kTurned = 0.03;                       // rad: beyond how files are rounded
constexpr double kLeastSpeed = 0.5;                    // of sqrt(g / h): what a servo has to turn at
constexpr double kLeastAngle = 0.02;  // rad, off its target: what a servo has to be able to follow
constexpr double kLeastTransmission =
    0.26;  // rad, 15 degrees: there bars push four times as hard as they move

class LegFindings {
 public:
  explicit LegFindings(const RobotDescription& robot) : robot_(robot) {}

  std::vector<RobotFinding> list() {
    check_efforts();
    check_bars();
    check_home();
    check_feet();
    check_names();
    check_frame();
    return std::move(found_);
  }

 private:
  void add(Severity severity, std::string of, std::string what, std::string likely = "") {
    found_.push_back({severity, std::move(of), std::move(what), std::move(likely)});
  }

  void check_efforts() {
    const double weight = robot_.total_mass() * kGravity;
    for (const Leg leg : kLegs) {
      const LegKinematics kinematics = make_leg_kinematics(robot_, leg);
      LegPosture home;
      home.servos.resize(kinematics.servo_count());
      home.passive.resize(kinematics.passive_count());
      for (int i = 0; i < kinematics.servo_count(); ++i)
        home.servos[i] = robot_.home[kinematics.servo_joints()[static_cast<std::size_t>(i)]];
      for (int i = 0; i < kinematics.passive_count(); ++i)
        home.passive[i] = robot_.home[kinematics.passive_joints()[static_cast<std::size_t>(i)]];
      // What the ground's push on a foot asks of its servos; the legs' own weight is left out.
      const Eigen::VectorXd torques =
          kinematics.jacobian(home).transpose() * Vector3(0, 0, weight / kLegCount);
      for (int i = 0; i < kinematics.servo_count(); ++i)
        check_effort(robot_.joint(kinematics.servo_joints()[static_cast<std::size_t>(i)]), torques[i]);
    }
  }

  void check_effort(const Joint& joint, double standing) {
    const double limit = standing > 0 ? negative_effort(joint) : joint.effort_limit,
                 needed = std::abs(standing);
    if (limit >= 2 * needed) return;
    const bool cannot_stand = limit < needed;
    add(cannot_stand ? Severity::kError : Severity::kWarning, fmt::format("joint '{}'", joint.name),
        fmt::format(
            "its torque limit of {:.3g} N m is below the {:.3g} N m that standing on {} legs takes of it",
            limit, cannot_stand ? needed : 2 * needed, cannot_stand ? "four" : "two"));
  }

  void check_bars() {
    for (const Leg leg : kLegs) {
      if ((*robot_.legs)[leg].linkage != LegLinkage::kClosedChain) continue;
      const ClosedChainGeometry geometry = closed_chain_geometry(robot_, leg);
      const double transmission = geometry.chain.transmission(geometry.home);
      if (transmission >= kLeastTransmission) continue;
      add(Severity::kWarning, fmt::format("legs.{}", name(leg)),
          fmt::format(
              "at home its bars are {:.2g} degrees from a dead point, where they cannot move what has no "
              "servo, expected {:.2g} or more",
              transmission * kDegreesPerRadian, kLeastTransmission * kDegreesPerRadian));
    }
  }

  /// A damper may take all the torque of a servo at a speed below that of a gait; a spring may ask for all of
  /// it at an angle below what a servo can hold.
  void check_servo(const Joint& joint) {
    const double limit = std::max(joint.effort_limit, negative_effort(joint)),
                 speed = std::sqrt(kGravity / robot_.standing_height);
    const std::string of = fmt::format("joint '{}'", joint.name);
    if (joint.damping * kLeastSpeed * speed > limit)
      add(Severity::kWarning, of,
          fmt::format(
              "its damping of {:.3g} N m s/rad takes all of its torque limit of {:.3g} N m at {:.2g} rad/s, "
              "where gaits of this robot turn joints at {:.2g}",
              joint.damping, limit, limit / joint.damping, speed));
    if (joint.kp == 0) add(Severity::kWarning, of, "its servo has a kp of 0: it holds no angle");
    if (joint.kp * kLeastAngle > limit)
      add(Severity::kWarning, of,
          fmt::format(
              "its kp of {:.3g} N m/rad asks for all of its torque limit of {:.3g} N m at {:.2g} rad off its "
              "target",
              joint.kp, limit, limit / joint.kp));
  }

  void check_home() {
    for (const LegModel& leg : *robot_.legs) {
      for (const int i : leg.servos) {
        const Joint& joint = robot_.joint(i);
        check_servo(joint);
        const double room = std::min(robot_.home[i] - joint.lower, joint.upper - robot_.home[i]);
        if (room > kAtLimit) continue;
        add(Severity::kWarning, fmt::format("joint '{}'", joint.name),
            fmt::format("home at {:.3g} rad is at its limit, of {:.3g} to {:.3g} rad", robot_.home[i],
                        joint.lower, joint.upper));
      }
    }
  }

  void check_feet() {
    const double h = robot_.standing_height;
    const std::vector<Pose> poses = home_poses(robot_);
    const LegArray<Vector3> hips = hip_places(robot_);
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (const Leg leg : kLegs) {
      const double radius = (*robot_.legs)[leg].foot_radius;
      if (radius < kLeastFoot * h || radius > kMostFoot * h)
        add(radius > h ? Severity::kError : Severity::kWarning, fmt::format("legs.{}", crossgait::name(leg)),
            fmt::format("its foot has a radius of {:.3g} m, of a robot that stands {:.3g} m high", radius, h),
            radius > h ? likely_unit("its radius", kLengthUnits, radius / (kFoot * h)) : "");
      const double depth = hips[leg].z() - foot_position(robot_, leg, poses).z();
      least = std::min(least, depth);
      most = std::max(most, depth);
    }
    if (most - least > kUneven * h)
      add(Severity::kWarning, "robot",
          fmt::format("at home its feet are from {:.3g} to {:.3g} m below their hips: some hang in the air",
                      least, most));
  }

  /// Legs are named by where they are: gaits and commands count on it.
  void check_names() {
    const LegArray<Vector3> hips = hip_places(robot_);
    const Vector3 middle = hip_middle(robot_);
    for (const Leg leg : kLegs) {
      const Vector3 p = hips[leg] - middle;
      const bool right_side = p.y() * side_sign(leg) > 0, right_end = p.x() * (is_front(leg) ? 1 : -1) > 0;
      if (right_side && right_end) continue;
      add(Severity::kWarning, fmt::format("legs.{}", crossgait::name(leg)),
          fmt::format(
              "its hip is at ({:.3g}, {:.3g}) m from the middle of the hips, expected {} and {} of it", p.x(),
              p.y(), is_front(leg) ? "ahead" : "behind", is_left(leg) ? "to the left" : "to the right"));
    }
  }

  /// Says where the base's frame is not that of the legs: what counts from it is of another point, or leans.
  void check_frame() {
    const HipFrame hips = hip_frame(robot_);
    const double aside = hips.middle.head<2>().norm(), h = robot_.standing_height;
    if (aside > kAside * h)
      add(Severity::kNote, "base",
          fmt::format("its origin is {:.3g} m aside of the middle of the hips, at ({:.3g}, {:.3g}) m: "
                      "commands, ways and headings are those of the origin",
                      aside, hips.middle.x(), hips.middle.y()));
    for (const auto& [severity, angle, what, meant] :
         {std::tuple(Severity::kNote, hips.yaw, "yawed", "forward is along the base's x axis"),
          std::tuple(Severity::kWarning, hips.pitch, "pitched", "the base is held level, legs are not"),
          std::tuple(Severity::kWarning, hips.roll, "rolled", "the base is held level, legs are not")}) {
      if (std::abs(angle) > kTurned)
        add(severity, "base",
            fmt::format("in its frame the hips are {} by {:.3g} rad: {}", what, angle, meant));
    }
  }

  const RobotDescription& robot_;
  std::vector<RobotFinding> found_;
};

}  // namespace

std::vector<RobotFinding> leg_findings(const RobotDescription& robot) { return LegFindings(robot).list(); }

}  // namespace crossgait
