#include "study/robot_findings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "ik/leg_kinematics.h"
#include "physics/robot/actuator.h"
#include "physics/robot/hips.h"
#include "physics/robot/joint_numbers.h"
#include "physics/robot/multibody.h"
#include "study/link_box.h"
#include "study/robot_quantities.h"

namespace crossgait {
namespace {

constexpr double kLeastGyration = 0.02, kMostGyration = 0.6, kImpossibleGyration = 1.5;  // of a link's extent
constexpr double kLeastDensity = 20, kMostDensity = 2e4, kImpossibleDensity = 1e5;       // kg/m^3
constexpr double kLeastHeight = 0.03, kMostHeight = 3;                                   // m
constexpr double kHugeShape = 10;  // of the standing height
constexpr double kWidened = 1.5;   // of a link's box, for its centre of mass
constexpr double kBeside = 0.25;   // of its longest side, beside it
constexpr double kThin = 0.1;      // of the longest side: a box whose volume says nothing
constexpr double kUnlike = 0.05;   // relative, of left and right
constexpr double kAtLimit = 0.01;  // rad
constexpr double kAside = 0.5;     // of the standing height: a base's origin out of the middle of the legs
constexpr double kTurned = 0.03;   // rad: beyond how files are rounded
constexpr std::array kSides{std::pair(Leg::FL, Leg::FR), std::pair(Leg::RL, Leg::RR)};
constexpr double kLeastSpeed = 0.5;   // of sqrt(g / h): what a servo has to turn at
constexpr double kLeastAngle = 0.02;  // rad, off its target: what a servo has to be able to follow
constexpr double kLeastTransmission =
    0.26;  // rad, 15 degrees: there bars push four times as hard as they move

/// A unit in which a number would have been right, and by which factor it is too large as it is.
struct Unit {
  double factor;
  const char* words;
};
constexpr std::array kInertiaUnits{Unit{1e3, "g m^2"}, Unit{1e4, "kg cm^2"}, Unit{1e6, "kg mm^2"},
                                   Unit{1e7, "g cm^2"}, Unit{1e9, "g mm^2"}};
constexpr std::array kLengthUnits{Unit{1e3, "mm"}, Unit{100, "cm"}, Unit{39.37, "inches"}};

/// "moments in kg mm^2": the unit that makes most of being `times` too large, if it is near one.
template <std::size_t N>
std::string likely_unit(const char* what, const std::array<Unit, N>& units, double times) {
  constexpr double kNear = 0.75;  // decades
  const auto off = [&](const Unit& unit) { return std::abs(std::log10(times / unit.factor)); };
  const Unit& best = *std::ranges::min_element(units, {}, off);
  return off(best) < kNear ? fmt::format("{} in {}", what, best.words) : "";
}

double length(const CollisionShape& shape) {
  LinkOutline outline;
  outline.add(shape);
  return outline.length();
}

/// A plane in the base's frame of whose two sides one should be the mirror image of the other.
struct MirrorPlane {
  Vector3 point, normal;
  Vector3 image(const Vector3& p) const { return p - 2 * normal.dot(p - point) * normal; }
};

class Findings {
 public:
  explicit Findings(const LoadedRobot& loaded) : robot_(loaded.robot), outlines_(robot_.bodies.size()) {
    for (std::size_t i = 0; i < outlines_.size(); ++i) {
      const Body& body = robot_.bodies[i];
      outlines_[i].add(Vector3::Zero());
      for (const CollisionShape& shape : body.shapes) outlines_[i].add(shape);
      if (body.parent >= 0) outlines_[static_cast<std::size_t>(body.parent)].add(body.X_PB.translation());
    }
    if (!robot_.legs) return;
    for (const LegModel& leg : *robot_.legs) outlines_[static_cast<std::size_t>(leg.foot_body)].add(leg.p_BF);
  }

  std::vector<RobotFinding> list() {
    check_size();
    for (std::size_t i = 0; i < robot_.bodies.size(); ++i)
      check_body(robot_.bodies[i], LinkBox(outlines_[i]));
    if (robot_.legs) {
      check_efforts();
      check_bars();
      check_home();
      check_frame();
      compare_sides();
    }
    std::ranges::stable_sort(found_, std::ranges::greater{}, &RobotFinding::severity);
    return std::move(found_);
  }

 private:
  void add(Severity severity, std::string of, std::string what, std::string likely = "") {
    found_.push_back({severity, std::move(of), std::move(what), std::move(likely)});
  }

  void check_size() {
    const double h = robot_.standing_height;
    if (h > kMostHeight || (h > 0 && h < kLeastHeight))
      add(Severity::kError, "robot",
          fmt::format("it stands {:.3g} m high, expected {} to {} m", h, kLeastHeight, kMostHeight),
          h > kMostHeight ? likely_unit("lengths", kLengthUnits, h / 0.3) : "");
    for (const Body& body : robot_.bodies) {
      for (const CollisionShape& shape : body.shapes) {
        const double size = length(shape);
        if (!(size > kHugeShape * h)) continue;
        add(Severity::kError, fmt::format("link '{}'", body.name),
            fmt::format("its shape '{}' is {:.3g} m large, of a robot that stands {:.3g} m high", shape.name,
                        size, h),
            likely_unit("lengths of the shape", kLengthUnits, size / h));
      }
    }
  }

  void check_body(const Body& body, const LinkBox& box) {
    const std::string of = fmt::format("link '{}'", body.name);
    const SpatialInertia& inertia = body.inertia;
    const double extent = box.sizes().norm();
    // A link without shapes and ends says nothing of its size.
    if (!(extent > 1e-6)) return;
    const double moment =
        Eigen::SelfAdjointEigenSolver<Matrix3>(inertia.I_C, Eigen::EigenvaluesOnly).eigenvalues()[2];
    const double gyration = std::sqrt(moment / inertia.mass);
    if (gyration > kMostGyration * extent || gyration < kLeastGyration * extent) {
      // Of a rod of that extent.
      const double times = moment / (inertia.mass * extent * extent / 12);
      add(gyration > kImpossibleGyration * extent ? Severity::kError : Severity::kWarning, of,
          fmt::format(
              "its largest moment of {:.3g} kg m^2 on {:.3g} kg is a radius of gyration of {:.3g} m, of a "
              "link {:.3g} m large",
              moment, inertia.mass, gyration, extent),
          times > 1 ? likely_unit("moments", kInertiaUnits, times) : "");
    }
    check_centre(of, inertia.p_BC, box);
    check_density(of, inertia.mass, box);
  }

  void check_centre(const std::string& of, const Vector3& p_BC, const LinkBox& box) {
    // A flat box has no width to widen, and motors stand out beside a link of which only a rod collides.
    const Vector3 half =
        (kWidened / 2 * box.sizes()).cwiseMax(Vector3::Constant(kBeside * box.sizes().maxCoeff()));
    const auto is_inside = [&](const Vector3& p) {
      return (box.from_middle(p).cwiseAbs() - half).maxCoeff() <= 0;
    };
    if (is_inside(p_BC)) return;
    std::string likely;
    for (const Unit& unit : kLengthUnits) {
      if (likely.empty() && is_inside(p_BC / unit.factor) && p_BC.norm() > box.sizes().norm())
        likely = fmt::format("its place in {}", unit.words);
    }
    const double off = box.from_middle(p_BC).norm();
    // Twice as far off as the link is large there is nothing to be heavy.
    add(off > 2 * box.sizes().norm() ? Severity::kError : Severity::kWarning, of,
        fmt::format(
            "its centre of mass at ({:.3g}, {:.3g}, {:.3g}) m is {:.3g} m from the middle of a link {:.3g} m "
            "large",
            p_BC.x(), p_BC.y(), p_BC.z(), off, box.sizes().norm()),
        likely);
  }

  void check_density(const std::string& of, double mass, const LinkBox& box) {
    const Vector3 sizes = box.sizes();
    if (sizes.minCoeff() < kThin * sizes.maxCoeff()) return;
    const double density = mass / sizes.prod();
    if (density >= kLeastDensity && density <= kMostDensity) return;
    add(density > kImpossibleDensity ? Severity::kError : Severity::kWarning, of,
        fmt::format("{:.3g} kg in a box of {:.3g} x {:.3g} x {:.3g} m is {:.3g} kg/m^3, expected {} to {}",
                    mass, sizes.x(), sizes.y(), sizes.z(), density, kLeastDensity, kMostDensity),
        density > kMostDensity ? likely_unit("its mass", std::array{Unit{1e3, "g"}}, density / 1000) : "");
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

  void add_unlike(Leg left, Leg right, std::size_t role, const std::string& numbers) {
    add(Severity::kWarning, "legs",
        fmt::format("left and right are unlike: {} ('{}' and '{}')", numbers,
                    robot_.joint((*robot_.legs)[left].joints()[role]).name,
                    robot_.joint((*robot_.legs)[right].joints()[role]).name));
  }

  void compare(Leg left, Leg right, std::size_t role, std::string_view what, std::string_view unit,
               double of_left, double of_right) {
    if (std::abs(of_left - of_right) <= kUnlike * std::max(std::abs(of_left), std::abs(of_right))) return;
    add_unlike(left, right, role, fmt::format("{} of {:.3g} and {:.3g} {}", what, of_left, of_right, unit));
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

  /// The plane y = 0 of the base, or that between the legs where a file has the base's frame elsewhere.
  MirrorPlane mirror_plane(const std::vector<Pose>& poses) const {
    const HipFrame hips = hip_frame(robot_);
    const MirrorPlane of_base{Vector3::Zero(), Vector3::UnitY()},
        of_hips{hips.middle, Eigen::AngleAxisd(hips.yaw, Vector3::UnitZ()) * Vector3::UnitY()};
    const auto off = [&](const MirrorPlane& plane) {
      double sum = 0;
      for (const auto& [left, right] : kSides) {
        const std::vector<int> a = (*robot_.legs)[left].joints(), b = (*robot_.legs)[right].joints();
        for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
          sum += (place(poses, a[i]) - plane.image(place(poses, b[i]))).norm();
      }
      return sum;
    };
    return off(of_base) <= off(of_hips) ? of_base : of_hips;
  }

  static Vector3 place(const std::vector<Pose>& poses, int joint) {
    return poses[static_cast<std::size_t>(joint) + 1].translation();
  }

  /// Compares where joints of left and right are at home, one of them mirrored.
  void compare_places(Leg left, Leg right, std::size_t role, const MirrorPlane& mirror, const Vector3& p_left,
                      const Vector3& p_right) {
    if ((p_left - mirror.image(p_right)).norm() <= kUnlike * robot_.standing_height) return;
    const auto text = [](const Vector3& p) {
      return fmt::format("({:.3g}, {:.3g}, {:.3g})", p.x(), p.y(), p.z());
    };
    add_unlike(left, right, role,
               fmt::format("at home their joints are at {} and {} m", text(p_left), text(p_right)));
  }

  void compare_sides() {
    const std::vector<Pose> poses = home_poses(robot_);
    const MirrorPlane mirror = mirror_plane(poses);
    for (const auto& [left, right] : kSides) {
      const std::vector<int> a = (*robot_.legs)[left].joints(), b = (*robot_.legs)[right].joints();
      if (a.size() != b.size()) continue;
      for (std::size_t i = 0; i < a.size(); ++i) {
        const auto of_a = static_cast<std::size_t>(a[i]) + 1, of_b = static_cast<std::size_t>(b[i]) + 1;
        const Body &body_a = robot_.bodies[of_a], &body_b = robot_.bodies[of_b];
        compare(left, right, i, "masses", "kg", body_a.inertia.mass, body_b.inertia.mass);
        compare(left, right, i, "moments (sums of three)", "kg m^2", body_a.inertia.I_C.trace(),
                body_b.inertia.I_C.trace());
        compare(left, right, i, "ranges", "rad", body_a.joint.upper - body_a.joint.lower,
                body_b.joint.upper - body_b.joint.lower);
        for (const JointNumber& number : kJointNumbers)
          compare(left, right, i, number.name, number.unit, body_a.joint.*number.member,
                  body_b.joint.*number.member);
        compare_places(left, right, i, mirror, place(poses, a[i]), place(poses, b[i]));
      }
    }
  }

  const RobotDescription& robot_;
  std::vector<LinkOutline> outlines_;  ///< of each body's shapes, its joint, what hangs on it and its foot
  std::vector<RobotFinding> found_;
};

}  // namespace

std::string_view name(Severity severity) noexcept {
  constexpr std::array<std::string_view, 3> kNames{"note", "warning", "error"};
  return kNames[static_cast<std::size_t>(severity)];
}

std::vector<RobotFinding> robot_findings(const LoadedRobot& loaded) { return Findings(loaded).list(); }

std::vector<RobotFinding> all_findings(const LoadedRobot& loaded, const WorldSpec& world) {
  std::vector<RobotFinding> findings = robot_findings(loaded);
  for (const std::string& warning : robot_warnings(loaded, world))
    findings.push_back({Severity::kWarning, "robot", warning, ""});
  return findings;
}

std::string describe(const RobotFinding& finding) {
  return fmt::format("{}: {}{}", finding.of, finding.what,
                     finding.likely.empty() ? "" : fmt::format("; likely {}", finding.likely));
}

std::string describe(const std::vector<RobotFinding>& findings) {
  std::string text;
  for (const RobotFinding& f : findings) text += fmt::format("{}: {}\n", name(f.severity), describe(f));
  return text;
}

nlohmann::ordered_json to_json(const std::vector<RobotFinding>& findings) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const RobotFinding& f : findings)
    list.push_back({{"severity", name(f.severity)}, {"of", f.of}, {"what", f.what}, {"likely", f.likely}});
  return list;
}

}  // namespace crossgait
