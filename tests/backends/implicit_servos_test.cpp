// Servos whose torque hangs on how a step ends, in every engine that solves them.
#include <gtest/gtest.h>

#include "backends/registry.h"
#include "parity/model_audit.h"
#include "physics/core/error.h"
#include "scenes/scenes.h"
#include "tests/support/engine_test.h"

namespace crossgait {
namespace {

using scenes::home_targets;
using scenes::quadruped;
using scenes::with_implicit_servos;
using scenes::world_of;

class ImplicitServos : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Engines, ImplicitServos, ::testing::ValuesIn(available_engines()), engine_of_test);

bool solves(const Engine& engine) { return !engine.info.laws.implicit_servos.empty(); }

TEST_P(ImplicitServos, AreSolvedOrRefusedByName) {
  const Engine engine = find_engine(GetParam());
  const WorldSpec spec = world_of(with_implicit_servos(quadruped()));
  if (solves(engine)) {
    EXPECT_NO_THROW(static_cast<void>(engine.make(spec)));
    return;
  }
  try {
    static_cast<void>(engine.make(spec));
    FAIL() << "made a world of what it does not solve";
  } catch (const ConfigError& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find("expected an explicit servo: `" + GetParam() + "` does not solve implicit ones"),
              std::string::npos)
        << message;
  }
}

TEST_P(ImplicitServos, ContinueBitForBit) {
  const Engine engine = find_engine(GetParam());
  if (!solves(engine)) GTEST_SKIP() << "no Laws::implicit_servos";
  const WorldSpec spec = world_of(with_implicit_servos(quadruped()));
  const auto a = engine.make(spec), b = engine.make(spec);
  const scenes::Trot trot(*spec.robot);
  const auto advance = [&](PhysicsBackend& world, int steps) {
    for (int i = 0; i < steps; ++i) ASSERT_EQ(world.step(trot.targets(world.state().time)), StepStatus::kOk);
  };
  advance(*a, 700);
  b->restore(a->save());
  advance(*a, 300);
  advance(*b, 300);
  EXPECT_TRUE(scenes::identical(a->state(), b->state()));
  EXPECT_EQ(a->torques(), b->torques());
}

TEST_P(ImplicitServos, AreMeasuredAsTheyAre) {
  const Engine engine = find_engine(GetParam());
  if (!solves(engine)) GTEST_SKIP() << "no Laws::implicit_servos";
  const auto a = engine.make(world_of(with_implicit_servos(quadruped())));
  RobotDescription other = *with_implicit_servos(quadruped());
  const auto same = engine.make(world_of(with_implicit_servos(quadruped())));
  EXPECT_TRUE(audit_models(*a, *same).findings.empty());
  const int servo = other.actuated_joints()[4];
  other.bodies[static_cast<std::size_t>(servo) + 1].joint.kp *= 1.05;
  const auto b = engine.make(world_of(std::make_shared<const RobotDescription>(other)));
  const ModelAudit audit = audit_models(*a, *b);
  ASSERT_FALSE(audit.findings.empty());
  EXPECT_EQ(audit.findings.front().quantity, "servo stiffness");
}

}  // namespace
}  // namespace crossgait
