// What contacts report and do: forces that carry a weight, geometry. Other shapes than feet: shape_test.cpp.
#include <cmath>
#include <numbers>

#include "crossgait/physics/multibody.h"
#include "crossgait/tests/conformance/contact_forces.h"
#include "crossgait/tests/support/backend_test.h"
#include "crossgait/tests/support/constants.h"

namespace crossgait {
namespace {

using test::kGravity;

double loop_gap(const PhysicsBackend& backend) {
  std::vector<Pose> poses;
  forward_kinematics(backend.robot(), backend.state(), poses);
  return max_loop_gap(backend.robot(), poses);
}

class Standing : public BackendTest {
 protected:
  /// Sum of contact forces averaged over the last 0.2 s of two seconds.
  static Vector3 mean_force(PhysicsBackend& backend) {
    const JointTargets targets = scenes::home_targets(backend.robot());
    EXPECT_EQ(backend.step(targets, 1800), StepStatus::kOk);
    Vector3 sum = Vector3::Zero();
    for (int i = 0; i < 200; ++i) {
      EXPECT_EQ(backend.step(targets), StepStatus::kOk);
      sum += total_force(backend);
    }
    return sum / 200;
  }
};
CROSSGAIT_FOR_EVERY_BACKEND(Standing);

TEST_P(Standing, FeetCarryTheWeight) {
  for (const scenes::RobotPtr& robot : {scenes::quadruped(), scenes::long_quadruped()}) {
    const auto backend = make(robot);
    const double weight = robot->total_mass() * kGravity;
    const Vector3 force = mean_force(*backend);
    measured("mean contact force over weight - 1", force.z() / weight - 1);
    EXPECT_NEAR(force.z() / weight, 1, 1e-3);  // what is left of the touch-down's swinging after 1.8 s
    EXPECT_LT(force.head<2>().norm() / weight, 1e-3);
    for (const FootContact& foot : backend->foot_contacts()) {
      EXPECT_TRUE(foot.touching);
      EXPECT_GT(foot.force.z(), 0.1 * weight);
      EXPECT_LT(foot.slip_speed, 1e-3);
    }
    EXPECT_LT(backend->state().v_WB.norm(), 1e-3);
  }
}

TEST_P(Standing, WeighsTheSameOnASlope) {
  WorldSpec spec = scenes::world_of(scenes::quadruped());
  spec.terrain = make_terrain("slope:angle=5,heading=30,size_x=2,size_y=2,cell=0.05");
  const auto backend = make(spec);
  const double weight = backend->robot().total_mass() * kGravity;
  const Vector3 force = mean_force(*backend);
  EXPECT_LT((force - Vector3(0, 0, weight)).norm() / weight, 1e-3);
}

TEST_P(Standing, PenetrationIsThatOfTheContactLaw) {
  const auto backend = make(scenes::quadruped());
  mean_force(*backend);
  const std::vector<double> weights = translational_inverse_weights(backend->robot(), false);
  double deepest = 0, bound = 0;
  for (const Leg leg : kLegs) {
    const FootContact foot = backend->foot_contacts()[leg];
    deepest = std::max(deepest, foot.penetration);
    const auto body = static_cast<std::size_t>((*backend->robot().legs)[leg].foot_body);
    bound = std::max(bound, sinking(foot.force.z(), weights[body]));
  }
  measured("deepest penetration, m", deepest);
  measured("bound for soft contact, m", bound);
  // Hard contact removes a fifth of its penetration per step; what is left is what gravity adds in a step.
  EXPECT_LE(deepest, capabilities().soft_contact ? bound : 10 * kGravity * 1e-6);
}

TEST_P(Standing, ContactsLieUnderTheFeetAlongTheNormal) {
  for (const char* terrain : {"flat", "slope:angle=5,heading=30,size_x=2,size_y=2,cell=0.05"}) {
    WorldSpec spec = scenes::world_of(scenes::quadruped());
    spec.terrain = make_terrain(terrain);
    const auto backend = make(spec);
    const RobotDescription& robot = backend->robot();
    const JointTargets targets = scenes::home_targets(robot);
    ASSERT_EQ(backend->step(targets, 600), StepStatus::kOk);
    std::vector<Pose> poses;  // contacts are those of the configuration that the step begins with
    forward_kinematics(robot, backend->state(), poses);
    ASSERT_EQ(backend->step(targets), StepStatus::kOk);
    ASSERT_EQ(backend->contacts().count, 4);
    for (const Contact& c : backend->contacts()) {
      ASSERT_GE(c.leg, 0);
      const Leg leg = kLegs[static_cast<std::size_t>(c.leg)];
      EXPECT_EQ(c.body, (*robot.legs)[leg].foot_body);
      const Vector3 foot = foot_position(robot, leg, poses);
      const double radius = (*robot.legs)[leg].foot_radius;
      // Poses and terrain agree to rounding; on a field, whose heights are floats, neighbouring triangles
      // tilt against each other by 1e-8 m in a cell.
      const double tolerance = spec.terrain.field() == nullptr ? 1e-12 : 1e-7;
      EXPECT_LT((c.normal - spec.terrain.normal(foot.x(), foot.y())).norm(), 10 * tolerance);
      EXPECT_LT((c.p_WP - (foot - c.normal * (radius + c.distance / 2))).norm(), tolerance);
      SphereContact expected;
      ASSERT_TRUE(spec.terrain.touch_sphere(foot, radius + 1e-3, expected));
      EXPECT_NEAR(c.distance, expected.distance + 1e-3, tolerance);
      // The force pushes, and stays in the friction cone (1e-6: soft cones are met to the solver's
      // tolerance).
      const double normal_force = c.force.dot(c.normal);
      EXPECT_GT(normal_force, 0);
      EXPECT_LE((c.force - normal_force * c.normal).norm(),
                spec.contact.friction * normal_force * (1 + 1e-6));
    }
  }
}

class Trotting : public BackendTest {};
CROSSGAIT_FOR_EVERY_BACKEND(Trotting);

TEST_P(Trotting, LoopsStayClosedAndFeetTakeTurns) {
  const auto backend = make(scenes::quadruped());
  const scenes::Trot trot(backend->robot());
  double gap = 0, deepest = 0, stance_force = 0, swing_force = 0;
  int steps = 0, loose = 0;
  while (backend->state().time < 5.5) {
    const double t = backend->state().time;
    ASSERT_EQ(backend->step(trot.targets(t)), StepStatus::kOk);
    gap = std::max(gap, loop_gap(*backend));
    const LegArray<FootContact> feet = backend->foot_contacts();
    for (const Leg leg : kLegs) {
      deepest = std::max(deepest, feet[leg].penetration);
      // Well inside swing and stance; the servos are too soft to tell when exactly a foot leaves and lands.
      const bool swings = scenes::Trot::swings(leg, t);
      const bool settled =
          scenes::Trot::swings(leg, t - 0.15) == swings && scenes::Trot::swings(leg, t + 0.15) == swings;
      if (t < scenes::Trot::kStand + scenes::Trot::kCycle || !settled) continue;
      (swings ? swing_force : stance_force) += feet[leg].force.z();
      if (!swings) ++steps;
      if (!swings && !feet[leg].touching) ++loose;
    }
  }
  measured("largest loop gap, m", gap);
  measured("deepest penetration, m", deepest);
  measured("load of swinging feet over load of standing feet", swing_force / stance_force);
  EXPECT_LT(gap, 1e-3);
  EXPECT_GT(steps, 1000);
  EXPECT_EQ(loose, 0);
  EXPECT_LT(swing_force,
            0.2 * stance_force);  // hard contact lets the robot tip on to a corner: it drags a foot
  EXPECT_GT(backend->state().p_WB.x(), 0.3);  // it walks
}

TEST_P(Trotting, AFootHeldUpDoesNotTouch) {
  WorldSpec spec = scenes::world_of(scenes::quadruped());
  spec.fixed_base = true;
  const auto backend = make(spec);
  RobotState start = backend->home_state();
  start.p_WB.z() = backend->robot().home_height - 2e-3;
  JointTargets targets = scenes::home_targets(backend->robot());
  for (const Leg leg : kLegs) {
    backend->reset(start);
    JointTargets lifted = targets;
    lifted.q[3 * static_cast<Eigen::Index>(leg)] += side_sign(leg) * 0.7;  // swung outward
    ASSERT_EQ(backend->step(lifted, 800), StepStatus::kOk);
    const LegArray<FootContact> feet = backend->foot_contacts();
    for (const Leg other : kLegs)
      EXPECT_EQ(feet[other].touching, other != leg) << name(leg) << ' ' << name(other);
  }
}

TEST(NoContact, InTheAirNothingTouches) {
  ASSERT_FALSE(available_engines().empty());
  for (const std::string& name : available_engines()) {
    const auto backend = make_backend(name, scenes::world_of(scenes::quadruped()));
    RobotState start = backend->home_state();
    start.p_WB.z() += 1;
    backend->reset(start);
    ASSERT_EQ(backend->step(scenes::home_targets(backend->robot()), 100), StepStatus::kOk);
    EXPECT_EQ(backend->contacts().count, 0);
    for (const FootContact& foot : backend->foot_contacts()) {
      EXPECT_FALSE(foot.touching);
      EXPECT_EQ(foot.force.norm(), 0);
    }
  }
}

class Sliding : public BackendTest {};
CROSSGAIT_FOR_EVERY_BACKEND(Sliding);

TEST_P(Sliding, SlipSpeedIsThatOfTheBody) {
  const auto backend = make(scenes::sled());
  ASSERT_EQ(backend->step({}, 200), StepStatus::kOk);
  RobotState moving = backend->state();
  moving.v_WB = {0.3, -0.4, 0};
  backend->reset(moving);
  ASSERT_EQ(backend->step({}), StepStatus::kOk);
  ASSERT_GE(backend->contacts().count, 3);
  for (const Contact& c : backend->contacts())
    EXPECT_NEAR(c.slip_speed, 0.5, 1e-9);  // at rest otherwise, to 1e-9 m/s
}

TEST_P(Sliding, FrictionStopsASledWhereItShould) {
  WorldSpec spec = scenes::world_of(scenes::sled());
  spec.contact.friction = 0.3;
  spec.solver.tolerance = 1e-6;
  const auto backend = make(spec);
  ASSERT_EQ(backend->step({}, 200), StepStatus::kOk);
  RobotState moving = backend->state();
  moving.p_WB.x() = moving.p_WB.y() = 0;
  moving.v_WB = {0.6, 0.8, 0};
  backend->reset(moving);
  ASSERT_EQ(backend->step({}, 600), StepStatus::kOk);
  const double expected = 1 / (2 * 0.3 * kGravity);  // v^2 / (2 mu g): 0.34 s and 0.17 m
  const Vector3 went = backend->state().p_WB - moving.p_WB;
  measured("stopping distance, relative error", went.head<2>().norm() / expected - 1);
  EXPECT_NEAR(went.head<2>().norm() / expected, 1, 0.01);  // v h / 2 late, and a soft contact's hopping
  EXPECT_NEAR(std::atan2(went.y(), went.x()), std::atan2(0.8, 0.6), 1e-3);
}

TEST_P(Sliding, NothingBrakesWithoutFriction) {
  WorldSpec spec = scenes::world_of(scenes::sled());
  spec.contact.friction = 0;
  const auto backend = make(spec);
  RobotState moving = backend->home_state();
  moving.v_WB = {0.6, 0.8, 0};
  backend->reset(moving);
  ASSERT_EQ(backend->step({}, 500), StepStatus::kOk);
  // MuJoCo's least friction coefficient, 1e-5, takes 5e-5 m/s.
  EXPECT_NEAR(backend->state().v_WB.head<2>().norm(), 1, 1e-4);
}

}  // namespace
}  // namespace crossgait
