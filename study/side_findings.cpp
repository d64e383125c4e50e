#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "physics/robot/hips.h"
#include "physics/robot/joint_numbers.h"
#include "physics/robot/multibody.h"
#include "study/leg_findings.h"

namespace crossgait {
namespace {

constexpr double kUnlike = 0.05;    // relative, of left and right
constexpr double kSameAxis = 0.99;  // cosine, of axes of left and right
constexpr std::array kSides{std::pair(Leg::FL, Leg::FR), std::pair(Leg::RL, Leg::RR)};

/// A plane in the base's frame of whose two sides one should be the mirror image of the other.
struct MirrorPlane {
  Vector3 point, normal;
  Vector3 image(const Vector3& p) const { return p - 2 * normal.dot(p - point) * normal; }
};

class SideFindings {
 public:
  explicit SideFindings(const RobotDescription& robot) : robot_(robot) {}

  std::vector<RobotFinding> list() {
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
        compare_axes(left, right, i, mirror, poses[of_a].linear() * body_a.joint.axis,
                     poses[of_b].linear() * body_b.joint.axis);
        compare_places(left, right, i, mirror, place(poses, a[i]), place(poses, b[i]));
      }
    }
    return std::move(found_);
  }

 private:
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

  void add_unlike(Leg left, Leg right, std::size_t role, const std::string& numbers) {
    found_.push_back({Severity::kWarning, "legs",
                      fmt::format("left and right are unlike: {} ('{}' and '{}')", numbers,
                                  robot_.joint((*robot_.legs)[left].joints()[role]).name,
                                  robot_.joint((*robot_.legs)[right].joints()[role]).name),
                      ""});
  }

  void compare(Leg left, Leg right, std::size_t role, std::string_view what, std::string_view unit,
               double of_left, double of_right) {
    if (std::abs(of_left - of_right) <= kUnlike * std::max(std::abs(of_left), std::abs(of_right))) return;
    add_unlike(left, right, role, fmt::format("{} of {:.3g} and {:.3g} {}", what, of_left, of_right, unit));
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

  /// Whichever way they point.
  void compare_axes(Leg left, Leg right, std::size_t role, const MirrorPlane& mirror, const Vector3& of_left,
                    const Vector3& of_right) {
    const Vector3 mirrored = of_right - 2 * mirror.normal.dot(of_right) * mirror.normal;
    if (std::abs(of_left.dot(mirrored)) >= kSameAxis) return;
    add_unlike(left, right, role,
               fmt::format("at home their axes are ({:.2g}, {:.2g}, {:.2g}) and ({:.2g}, {:.2g}, {:.2g})",
                           of_left.x(), of_left.y(), of_left.z(), of_right.x(), of_right.y(), of_right.z()));
  }

  const RobotDescription& robot_;
  std::vector<RobotFinding> found_;
};

}  // namespace

std::vector<RobotFinding> side_findings(const RobotDescription& robot) { return SideFindings(robot).list(); }

}  // namespace crossgait
