// Names of settings between MuJoCo's contact law and Bullet's, and that the list of factors is complete.
#include "backends/bullet/contact_factors.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "backends/bullet/bullet_backend.h"
#include "physics/core/error.h"
#include "scenes/scenes.h"

namespace crossgait::bullet {
namespace {

TEST(ContactFactors, TheTwoNamedSettingsAreTheEnds) {
  ContactFactors all;
  for (const auto& row : factor_table().rows) {
    EXPECT_FALSE(ContactFactors::matched().*row.member);
    all.*row.member = true;
  }
  EXPECT_EQ(all, ContactFactors::native());
  EXPECT_EQ(factor_table().name_of(ContactFactors::matched()), "bullet:matched");
  EXPECT_EQ(factor_table().name_of(ContactFactors::native()), "bullet");
}

TEST(ContactFactors, NeedOthersThatComeBeforeThemInTheTablesOrder) {
  std::vector<std::string> before;
  for (const auto& row : factor_table().rows) {
    auto next = before.begin();
    for (const std::string& need : row.factor.needs) {
      next = std::find(next, before.end(), need);
      EXPECT_NE(next, before.end()) << row.factor.name << " needs " << need;
    }
    before.push_back(row.factor.name);
  }
}

TEST(ContactFactors, NamesComeBack) {
  for (const char* changes : {"+surface", "+coulomb+hard_friction", "+hard_normal+speculative"}) {
    const ContactFactors made = factor_table().changed(ContactFactors::matched(), changes, "test");
    EXPECT_EQ(factor_table().name_of(made), std::string("bullet:matched") + changes);
  }
  const ContactFactors made = factor_table().changed(ContactFactors::native(), "-sweeps-speculative", "test");
  EXPECT_EQ(factor_table().name_of(made), "bullet-speculative-sweeps");  // in the table's order
  EXPECT_EQ(factor_table().changed(made, "+sweeps+speculative", "test"), ContactFactors::native());
}

TEST(ContactFactors, MeaninglessOnesAreRefused) {
  for (const char* changes : {"+nonsense", "+", "+speculative", "+sweeps", "-surface", "+surface+surface"}) {
    EXPECT_THROW(factor_table().changed(ContactFactors::matched(), changes, "test"), ConfigError) << changes;
  }
  EXPECT_THROW(factor_table().changed(ContactFactors::native(), "-hard_normal", "test"),
               ConfigError);  // others need it
  try {
    factor_table().changed(ContactFactors::matched(), "+speculative", "bullet:matched+speculative");
  } catch (const ConfigError& error) {
    EXPECT_STREQ(error.what(),
                 "engine: bullet:matched+speculative: expected hard_normal along with speculative, found "
                 "speculative without hard_normal");
  }
}

std::unique_ptr<PhysicsBackend> make(const std::string& name, const WorldSpec& spec) {
  return find(name).value().make(spec);
}

TEST(ContactFactors, EnginesAreFoundByName) {
  EXPECT_EQ(find("bullet:native").value().name(), "bullet");
  EXPECT_EQ(find("bullet:matched+surface").value().name(), "bullet:matched+surface");
  for (const char* name : {"", "mujoco", "bullet:", "bullet:other+surface"}) EXPECT_FALSE(find(name)) << name;
  for (const char* name : {"bullet+surface", "bullet:matched-surface"}) {
    EXPECT_THROW(find(name), ConfigError) << name;
  }
}

double largest_difference(const std::string& a, const std::string& b, const std::string& terrain,
                          int iterations, const scenes::RobotPtr& robot = scenes::quadruped(),
                          const std::string& contact = "friction=0.6") {
  WorldSpec spec = scenes::world_of(robot);
  parse_contact_settings(contact, "test").apply(spec.contact);
  spec.terrain = make_terrain(terrain);
  spec.solver.tolerance = 1e-12;
  spec.solver.iterations = iterations;
  const auto x = make(a, spec), y = make(b, spec);
  const scenes::Trot trot(*spec.robot);
  double worst = 0;
  for (int i = 0; i < 1500; ++i) {
    const JointTargets targets = trot.targets(i * 1e-3);
    EXPECT_EQ(x->step(targets), StepStatus::kOk);
    EXPECT_EQ(y->step(targets), StepStatus::kOk);
    worst = std::max(worst, (x->state().p_WB - y->state().p_WB).norm());
  }
  return worst;
}

// Crossgait's converged solution with all of Bullet's factors is that of the code of Bullet's library, once
// that sweeps until nothing moves: nothing is different between the two modes that is not in the table.
TEST(ContactFactors, AreAllThereIs) {
  for (const char* terrain : {"flat", "rough:seed=1,size_x=4,size_y=2"}) {
    EXPECT_LT(largest_difference("bullet:own", "bullet-sweeps", terrain, 2000), 1e-8) << terrain;
  }
  // Stuck joints are stiff, and those of a serial leg that stands along with its foot more than it has
  // degrees of freedom: sweeps converge slowly.
  EXPECT_LT(largest_difference("bullet:own", "bullet-sweeps", "flat", 5000,
                               scenes::with_joint_friction(scenes::quadruped(), 0.02)),
            1e-8);
  EXPECT_LT(largest_difference("bullet:own", "bullet-sweeps", "flat", 5000,
                               scenes::with_joint_friction(scenes::serial_quadruped(), 0.2)),
            1e-6);
}

/// How far 0.5 s of trot lie from one with cfm 0.3, m.
double softened_by(const std::string& engine) {
  WorldSpec spec = scenes::world_of(scenes::quadruped()), other = spec;
  other.contact.cfm = 0.3;
  const auto x = make(engine, spec), y = make(engine, other);
  const scenes::Trot trot(*spec.robot);
  for (int i = 0; i < 500; ++i) {
    const JointTargets targets = trot.targets(i * 1e-3);
    EXPECT_EQ(x->step(targets), StepStatus::kOk);
    EXPECT_EQ(y->step(targets), StepStatus::kOk);
  }
  return (x->state().p_WB - y->state().p_WB).norm();
}

// The library's rows, the sweeps of ours and the converged solution follow what is asked of hard contact.
TEST(ContactFactors, AreAllThereIsWhateverIsAskedOfHardContact) {
  for (const char* contact : {"erp=0.05", "erp=0.8", "max_depenetration_velocity=0.01", "cfm=0.001",
                              "cfm=0.3", "erp=0.4,max_depenetration_velocity=5,cfm=0.01"}) {
    SCOPED_TRACE(contact);
    EXPECT_LT(largest_difference("bullet:own", "bullet-sweeps", "flat", 2000, scenes::quadruped(), contact),
              1e-8);
    EXPECT_LT(largest_difference("bullet", "bullet-sweeps", "flat", 2000, scenes::quadruped(), contact),
              1e-8);
  }
}

// What is asked of contacts is not of limits of joints, nor of laws without hard contact.
TEST(ContactFactors, OthersStayAsTheyAreWhateverIsAskedOfHardContact) {
  WorldSpec spec = scenes::world_of(scenes::arm({{.limit = 0.3, .limited = true}}));
  spec.fixed_base = true;
  WorldSpec other = spec;
  parse_contact_settings("erp=0.8,cfm=0.3", "test").apply(other.contact);
  for (const char* engine : {"bullet", "bullet-sweeps", "bullet:matched"}) {
    const auto x = make(engine, spec), y = make(engine, other);
    RobotState start = x->home_state();
    start.q[0] = -0.35;  // beyond the limit, which is hit twice a second
    start.qd[0] = 3;
    x->reset(start);
    y->reset(start);
    for (int i = 0; i < 1000; ++i) {
      ASSERT_EQ(x->step(JointTargets()), StepStatus::kOk);
      ASSERT_EQ(y->step(JointTargets()), StepStatus::kOk);
    }
    EXPECT_TRUE(scenes::identical(x->state(), y->state())) << engine;
  }
  EXPECT_EQ(softened_by("bullet:matched"), 0);
  EXPECT_GT(softened_by("bullet"), 1e-6);  // m, in 0.5 s of trot: 30 % of each row's response
}

TEST(ContactFactors, EachChangesSomethingOrIsRounding) {
  // On its own, but for those that need others.
  const auto difference = [](const char* a, const char* b) { return largest_difference(a, b, "flat", 100); };
  EXPECT_LT(difference("bullet:matched", "bullet:matched+narrowphase"), 1e-10);
  for (const char* changed : {"+surface", "+coulomb", "+hard_friction", "+hard_normal"}) {
    EXPECT_GT(difference("bullet:matched", (std::string("bullet:matched") + changed).c_str()), 1e-4)
        << changed;
  }
  EXPECT_GT(difference("bullet:matched+hard_normal", "bullet:matched+hard_normal+speculative"), 1e-4);
  // Where there is none, that of joints is neither soft nor hard.
  EXPECT_EQ(difference("bullet:matched", "bullet:matched+hard_joint_friction"), 0);
  EXPECT_GT(largest_difference("bullet:matched", "bullet:matched+hard_joint_friction", "flat", 100,
                               scenes::with_joint_friction(scenes::quadruped(), 0.02)),
            1e-4);
}

TEST(ContactFactors, ConcernTheRobotsThatTheyChange) {
  const EngineFamily whole = family();
  const auto names = [](const EngineFamily& f) {
    std::vector<std::string> result;
    for (const ModelFactor& factor : f.factors) result.push_back(factor.name);
    return result;
  };
  EXPECT_EQ(names(family_for(whole, *scenes::with_joint_friction(scenes::quadruped(), 0.1))), names(whole));
  const EngineFamily smooth = family_for(whole, *scenes::quadruped());
  EXPECT_EQ(smooth.factors.size() + 1, whole.factors.size());
  EXPECT_NO_THROW(smooth.validate());
  EXPECT_EQ(smooth.with({}).name(), "bullet:matched");
  EXPECT_EQ(smooth.with({"coulomb"}).name(), "bullet:matched+coulomb");
  EXPECT_EQ(smooth.with(names(smooth)).name(), "bullet");  // along with what `sweeps` needs
}

TEST(ContactFactors, PointsJustAboveTheGroundAreAsFarAwayAsTheyAreAndMayCloseTheGap) {
  for (const char* name :
       {"bullet:matched+hard_normal+speculative", "bullet:matched+narrowphase+hard_normal+speculative"}) {
    const auto world = make(name, scenes::world_of(scenes::quadruped()));
    RobotState state = world->home_state();  // feet a tenth of a millimetre over the ground
    state.p_WB.z() += 2e-4;
    state.v_WB.z() = -1;  // down by a millimetre in a step
    world->reset(state);
    ASSERT_EQ(world->step(scenes::home_targets(world->robot())), StepStatus::kOk);
    ASSERT_EQ(world->contacts().count, 4) << name;
    for (const Contact& c : world->contacts()) {
      EXPECT_GE(c.leg, 0);
      EXPECT_NEAR(c.distance, 3e-4, 1e-9) << name;    // home is known to a nanometre
      EXPECT_NEAR(c.p_WP.z(), 1.5e-4, 1e-9) << name;  // midway
    }
    ASSERT_EQ(world->step(scenes::home_targets(world->robot())), StepStatus::kOk);
    for (const Contact& c : world->contacts())
      EXPECT_NEAR(c.distance, 0, 3e-5) << name;  // a tenth: legs fold on circles, not on lines
  }
}

TEST(ContactFactors, AnyCanBeSavedAndRestored) {
  for (const char* name :
       {"bullet:matched+narrowphase", "bullet:matched+hard_normal+speculative", "bullet-sweeps"}) {
    const auto world = make(name, scenes::world_of(scenes::quadruped()));
    EXPECT_EQ(world->info().name, name);
    EXPECT_NE(world->info().laws.contact, "mujoco");
    EXPECT_NE(world->info().laws.contact, "hard/sweeps");
    const scenes::Trot trot(world->robot());
    const auto walk = [&](int from, int to) {
      for (int i = from; i < to; ++i) ASSERT_EQ(world->step(trot.targets(i * 1e-3)), StepStatus::kOk);
    };
    walk(0, 700);
    const Snapshot snapshot = world->save();
    walk(700, 1000);
    const RobotState end = world->state();
    world->restore(snapshot);
    walk(700, 1000);
    EXPECT_TRUE(scenes::identical(world->state(), end)) << name;
  }
}

}  // namespace
}  // namespace crossgait::bullet
