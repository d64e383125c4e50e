#include <fmt/format.h>

#include "scenes/robot_pieces.h"
#include "scenes/robots.h"

namespace crossgait::scenes {
namespace {

// Of a leg with its abduction at zero, from the hip: x forward, z up, m. All angles are zero as it stands.
constexpr double kAside = 0.04;  // of the hip from the abduction's axis
struct InPlane {
  double x, z;
};
constexpr InPlane kKnee{-0.07, -0.1}, kFoot{0, -0.2};
constexpr InPlane kCrankTip{-0.03, 0.02}, kRodEnd{-0.095, -0.07};
constexpr InPlane kHighKnee{-0.06, -0.08}, kAnkle{0.02, -0.15}, kToeRod{-0.075, -0.065}, kToePin{0.01, -0.17};

Vector3 in_plane(InPlane to, InPlane from = {0, 0}) { return {to.x - from.x, 0, to.z - from.z}; }

class LegMaker {
 public:
  LegMaker(RobotDescription& robot, Leg leg) : robot_(robot), leg_(leg) {
    (*robot.legs)[leg].linkage = LegLinkage::kClosedChain;
  }

  /// @returns the index of the new body
  int add(const std::string& part, int parent, const Vector3& p, const Vector3& end, double mass,
          bool servo) {
    const double size = end.norm();
    Body body = free_body(fmt::format("{}_{}", name(leg_), part),
                          {mass, end / 2, Vector3::Constant(mass * (size * size + 1e-4) / 12).asDiagonal()});
    body.parent = parent;
    body.X_PB.translation() = p;
    Joint& joint = body.joint;
    joint.name = body.name + "_joint";
    joint.axis = part == "abduction" ? Vector3::UnitX() : Vector3::UnitY();
    joint.lower = -1.2, joint.upper = 1.2;
    joint.damping = servo ? 0.02 : 1e-3;
    if (servo)
      joint.actuated = true, joint.armature = 1e-3, joint.kp = 30, joint.kd = 0.5, joint.effort_limit = 7;
    robot_.bodies.push_back(std::move(body));
    return robot_.joint_count();
  }

  int add_hip() {
    const Vector3 at((is_front(leg_) ? 0.15 : -0.15), 0.06 * side_sign(leg_), 0);
    return add("abduction", 0, at, {0, kAside * side_sign(leg_), 0}, 0.1, true);
  }

  void finish(std::vector<int> servos, std::vector<int> passive, std::vector<LegPart> parts, int foot_body,
              const Vector3& p_BF) {
    LegModel& model = (*robot_.legs)[leg_];
    for (int& body : servos) --body;
    for (int& body : passive) --body;
    model.servos = std::move(servos), model.passive = std::move(passive), model.parts = std::move(parts);
    model.foot_body = foot_body, model.p_BF = p_BF, model.foot_radius = 0.012;
    robot_.bodies[static_cast<std::size_t>(foot_body)].shapes.push_back(
        shape(fmt::format("{}_foot", name(leg_)), ShapeType::kSphere, {0.012, 0, 0}, p_BF));
  }

 private:
  RobotDescription& robot_;
  Leg leg_;
};

void add_four_bar_knee(RobotDescription& robot, Leg leg) {
  LegMaker make(robot, leg);
  const int abduction = make.add_hip();
  const Vector3 hip(0, kAside * side_sign(leg), 0);
  const int thigh = make.add("hip", abduction, hip, in_plane(kKnee), 0.1, true);
  const int crank = make.add("crank", abduction, hip, in_plane(kCrankTip), 0.02, true);
  const int shin = make.add("knee", thigh, in_plane(kKnee), in_plane(kFoot, kKnee), 0.05, false);
  const int rod = make.add("rod", crank, in_plane(kCrankTip), in_plane(kRodEnd, kCrankTip), 0.01, false);
  robot.loops.push_back(
      {fmt::format("{}_loop", name(leg)), rod, shin, in_plane(kRodEnd, kCrankTip), in_plane(kRodEnd, kKnee)});
  make.finish({abduction, thigh, crank}, {shin, rod},
              {LegPart::kAbduction, LegPart::kHip, LegPart::kBar, LegPart::kKnee, LegPart::kBar}, shin,
              in_plane(kFoot, kKnee));
}

void add_pantograph(RobotDescription& robot, Leg leg) {
  LegMaker make(robot, leg);
  const int abduction = make.add_hip();
  const int thigh =
      make.add("hip", abduction, {0, kAside * side_sign(leg), 0}, in_plane(kHighKnee), 0.1, true);
  const int shin = make.add("knee", thigh, in_plane(kHighKnee), in_plane(kAnkle, kHighKnee), 0.05, true);
  const int toe = make.add("ankle", shin, in_plane(kAnkle, kHighKnee), in_plane(kFoot, kAnkle), 0.03, false);
  const int rod = make.add("rod", thigh, in_plane(kToeRod), in_plane(kToePin, kToeRod), 0.01, false);
  robot.loops.push_back(
      {fmt::format("{}_loop", name(leg)), rod, toe, in_plane(kToePin, kToeRod), in_plane(kToePin, kAnkle)});
  make.finish({abduction, thigh, shin}, {toe, rod},
              {LegPart::kAbduction, LegPart::kHip, LegPart::kKnee, LegPart::kAnkle, LegPart::kBar}, toe,
              in_plane(kFoot, kAnkle));
}

RobotPtr on_a_trunk(std::string name, void (*add_leg)(RobotDescription&, Leg)) {
  RobotDescription robot;
  robot.name = std::move(name);
  robot.bodies.push_back(free_body("trunk", solid_box(2.5, {0.18, 0.06, 0.03})));
  robot.legs.emplace();
  for (const Leg leg : kLegs) add_leg(robot, leg);
  robot.standing_height = -kFoot.z;
  robot.home_height = robot.standing_height + 0.012;
  return finished(robot);
}

}  // namespace

RobotPtr four_bar_knees() { return on_a_trunk("four_bar_knees", add_four_bar_knee); }
RobotPtr pantographs() { return on_a_trunk("pantographs", add_pantograph); }

}  // namespace crossgait::scenes
