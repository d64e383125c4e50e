#include "parity/model_probes.h"

#include "parity/model_audit.h"
#include "physics/core/random.h"
#include "tests/support/engine_test.h"

namespace crossgait {
namespace {

class Probes : public EngineTest {};
CROSSGAIT_FOR_EVERY_BACKEND(Probes);

TEST_P(Probes, TurnEveryJointTheFirstOneToo) {
  const scenes::RobotPtr robot = scenes::quadruped();
  const auto world = make(robot);
  const std::vector<Pose> rest = probes::poses_with_turned(*world, -1);
  for (int joint = 0; joint < robot->joint_count(); ++joint) {
    const std::vector<Pose> turned = probes::poses_with_turned(*world, joint);
    for (int body = 1; body <= robot->joint_count(); ++body) {
      const auto i = static_cast<std::size_t>(body);
      const Eigen::AngleAxisd expected(body == joint + 1 ? 0.5 : 0, robot->joint(joint).axis);
      // Rounding of rotations, far above the ground.
      EXPECT_LT((turned[i].linear() - rest[i].linear() * expected.toRotationMatrix()).norm(),
                1e-12 + 10 * eps());  // rounding of rotations
    }
  }
}

/// The serial quadruped with other masses, and dry friction and damping in its joints: in some of them a foot
/// at 1 m/s takes less friction than there is.
scenes::RobotPtr random_robot(std::uint64_t seed) {
  Random random(seed);
  const auto factor = [&random](double most) { return std::pow(most, random.uniform(-1, 1)); };
  RobotDescription robot = *scenes::serial_quadruped();
  const double damping = 0.5 * factor(10), friction = 0.5 * factor(10);
  for (Body& body : robot.bodies) {
    const double mass = factor(5);
    body.inertia.mass *= mass;
    body.inertia.I_C *= mass;
    body.joint.damping = damping;
    body.joint.friction = friction;
  }
  return scenes::finished(robot);
}

// One coefficient in all worlds: whatever the audit finds of it is not there.
void expect_no_friction_found(const std::string& engine, std::uint64_t first, std::uint64_t last) {
  const std::string reference = available_engines().front();
  if (reference == engine) GTEST_SKIP() << "one engine with itself, which can only agree";
  int held = 0;
  for (std::uint64_t seed = first; seed < last; ++seed) {
    const WorldSpec spec = scenes::world_of(random_robot(seed));
    const auto a = make_world(reference, spec), b = make_world(engine, spec);
    for (const AuditFinding& finding : audit_models(*a, *b).findings)
      EXPECT_NE(finding.quantity, "friction") << "robot " << seed << ": " << describe({finding});
    for (PhysicsBackend* world : {a.get(), b.get()}) {
      const LegArray<probes::PressedFoot> feet = probes::press_feet(*world, probes::pressed(*world, 1));
      held += std::any_of(feet.begin(), feet.end(), [&](const auto& foot) {
        return foot.friction_ratio < 0.99 * spec.contact.friction;
      });
    }
  }
  // Such feet are among them: at 1 m/s their ratio is no coefficient.
  EXPECT_GT(held, 0);
  measured("worlds with a foot that has less friction than its coefficient at 1 m/s", held);
}

TEST_P(Probes, FindNoFrictionOfFeetThatAreNotAtItsLimit) { expect_no_friction_found(GetParam(), 0, 20); }
TEST_P(Probes, FindNoFrictionOfFeetOfFortyMoreRobots) { expect_no_friction_found(GetParam(), 20, 60); }

TEST_P(Probes, SlipOfAFootIsThatOfItsPointAfterTheStep) {
  const auto world = make(scenes::quadruped());
  const LegArray<probes::PressedFoot> still = probes::press_feet(*world, probes::pressed(*world, 0)),
                                      fast = probes::press_feet(*world, probes::pressed(*world, 4));
  for (const Leg leg : kLegs) {
    EXPECT_LT(still[leg].slip_after, 0.05);
    EXPECT_NEAR(fast[leg].slip_after, 4, 0.5);  // friction takes little of it in a millisecond
    EXPECT_NEAR(fast[leg].friction_ratio, world->spec().contact.friction, 1e-3);
  }
}

}  // namespace
}  // namespace crossgait
