// Shapes of every kind, thrown on to the ground: one set of contact points makes one motion.
#include "tests/parity/matched_pair.h"

namespace crossgait {
namespace {

class MatchedShapes : public MatchedPair {
 protected:
  static void thrown(const scenes::RobotPtr& robot, const char* terrain, double seconds) {
    WorldSpec spec = scenes::world_of(robot);
    spec.terrain = make_terrain(terrain);
    const JointTargets none{JointVector::Zero(static_cast<Eigen::Index>(robot->actuated_joints().size()))};
    for (const Vector3& attitude : {Vector3(0.3, 0.4, 0.5), Vector3(1.6, 0.2, -1), Vector3(-0.4, 1.4, 2)}) {
      RobotState start = home_of(spec);
      start.p_WB.z() += 0.1;
      start.q_WB = from_roll_pitch_yaw(attitude.x(), attitude.y(), attitude.z());
      start.v_WB = {0.4, 0.2, 0};
      start.w_WB = {2, -3, 1};
      SCOPED_TRACE(::testing::PrintToString(attitude.transpose()));
      const Difference d = run(
          spec, &start, [&](double) { return JointTargets(none); }, seconds);
      EXPECT_LT(d.position, 1e-9);
      EXPECT_GE(d.most_contacts, 1);
    }
  }
};
INSTANTIATE_TEST_SUITE_P(Engines, MatchedShapes, ::testing::ValuesIn(matched_pairs()), pair_name);

constexpr const char* kRough = "rough:seed=3,flat_radius=0,size_x=4,size_y=4";

TEST_P(MatchedShapes, ABoxTumbles) { thrown(scenes::block(ShapeType::kBox, {0.06, 0.04, 0.03}), "flat", 3); }
TEST_P(MatchedShapes, ABoxTumblesOnRoughGround) {
  thrown(scenes::block(ShapeType::kBox, {0.06, 0.04, 0.03}), kRough, 3);
}
TEST_P(MatchedShapes, ACylinderRolls) {
  thrown(scenes::block(ShapeType::kCylinder, {0.05, 0.04, 0}), "flat", 3);
}
TEST_P(MatchedShapes, ACylinderRollsOnRoughGround) {
  thrown(scenes::block(ShapeType::kCylinder, {0.05, 0.04, 0}), kRough, 3);
}
TEST_P(MatchedShapes, ACapsuleRolls) {
  thrown(scenes::block(ShapeType::kCapsule, {0.04, 0.05, 0}), "flat", 3);
}
TEST_P(MatchedShapes, ACapsuleRollsOnRoughGround) {
  thrown(scenes::block(ShapeType::kCapsule, {0.04, 0.05, 0}), kRough, 3);
}
TEST_P(MatchedShapes, AHullTumbles) { thrown(scenes::block(scenes::gem()), "flat", 3); }
TEST_P(MatchedShapes, AHullTumblesOnRoughGround) { thrown(scenes::block(scenes::gem()), kRough, 3); }
TEST_P(MatchedShapes, ThreeRichHullsTumble) {
  RobotDescription robot;
  robot.name = "three gems";
  Body body;
  body.name = "trunk";
  body.inertia = scenes::solid_box(3, {0.1, 0.05, 0.05});
  for (int k = 0; k < 3; ++k) {
    CollisionShape hull = scenes::gem();
    hull.name += std::to_string(k);
    hull.X_BG.translation().x() = 0.08 * (k - 1);
    body.shapes.push_back(hull);
  }
  robot.bodies.push_back(body);
  thrown(scenes::finished(robot), kRough, 2);
}
TEST_P(MatchedShapes, ARobotOfAllOfThemTumbles) { thrown(scenes::assortment(), "flat", 3); }
TEST_P(MatchedShapes, ARobotOfAllOfThemTumblesOnRoughGround) { thrown(scenes::assortment(), kRough, 3); }

}  // namespace
}  // namespace crossgait
