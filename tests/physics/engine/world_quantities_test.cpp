#include "physics/engine/world_quantities.h"

#include <set>

#include <gtest/gtest.h>

#include "physics/core/error.h"
#include "physics/robot/robot_identity.h"
#include "scenes/robots.h"
#include "scenes/scenes.h"

namespace crossgait {
namespace {

WorldSpec with_everything() {
  WorldSpec world = scenes::world_of(scenes::quadruped());
  RobotDescription robot = *world.robot;
  // Something of everything, so that a factor changes it.
  for (Body& body : std::span(robot.bodies).subspan(1)) {
    Joint& joint = body.joint;
    joint.damping = 0.02;
    joint.implicit_joint_damping = 0.5;
    joint.stiffness = 0.1;
    joint.friction = 0.01;
    joint.armature = 1e-4;
    if (!joint.actuated) continue;
    joint.kd = 0.01;
    joint.effort_negative = 0.8;
    joint.implicit_stiffness = joint.implicit_damping = 0.5;
    joint.corner_speed = 10;
    joint.no_load_speed = 20;
    joint.backlash = 0.01;
    joint.delay = 0.004;
    joint.lag = 0.01;
    joint.sensor_noise = 1e-3;
  }
  world.contact.cfm = 0.01;
  world.robot = std::make_shared<const RobotDescription>(robot);
  world.validate();
  return world;
}

WorldSpec changed(const std::string& text) {
  WorldSpec world = with_everything();
  parse_quantity_change(text, "test").apply(world);
  return world;
}

void expect_no_change(const std::string& text, const std::string& part) {
  try {
    const QuantityChange change = parse_quantity_change(text, "test");
    WorldSpec world = with_everything();
    change.apply(world);
    FAIL() << text;
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

TEST(WorldQuantities, HaveNamesOfTheirOwn) {
  std::set<std::string> names;
  for (const WorldQuantity& quantity : world_quantities()) {
    EXPECT_TRUE(names.insert(quantity.name).second) << quantity.name;
    EXPECT_FALSE(quantity.group.empty()) << quantity.name;
    EXPECT_TRUE(quantity.set || quantity.scale) << quantity.name;
  }
  for (const char* name : {"friction", "impratio", "mass", "kp", "joint_friction", "delay", "physics_dt"})
    EXPECT_TRUE(names.contains(name)) << name;
}

TEST(WorldQuantities, AreMultipliedByAFactorAndNothingElseIs) {
  const WorldSpec before = with_everything();
  for (const WorldQuantity& quantity : world_quantities()) {
    if (!quantity.scale || !quantity.get) continue;
    SCOPED_TRACE(quantity.name);
    const WorldSpec after = changed(quantity.name + "=x1.25");
    const std::vector<double> a = quantity.get(before), b = quantity.get(after);
    ASSERT_EQ(a.size(), b.size());
    ASSERT_FALSE(a.empty());
    for (std::size_t i = 0; i < a.size(); ++i) {
      EXPECT_NE(a[i], 0);
      EXPECT_NEAR(b[i], 1.25 * a[i], 1e-12 * std::abs(b[i]));
    }
    for (const WorldQuantity& other : world_quantities()) {
      const bool concerned = other.group == quantity.group || !other.get;
      if (!concerned) {
        EXPECT_EQ(other.get(before), other.get(after)) << other.name;
      }
    }
  }
}

TEST(WorldQuantities, TakeAValue) {
  for (const char* text :
       {"friction=0.3", "impratio=20", "mass=2", "trunk_mass=0.3", "kp=7", "delay=0.006", "armature=0.002",
        "physics_dt=0.002", "gravity=3.7", "slope=5", "solref=0.01:0.9"}) {
    SCOPED_TRACE(text);
    const QuantityChange change = parse_quantity_change(text, "test");
    for (const double value : change.quantity->get(changed(text))) {
      if (std::string_view(text).starts_with("solref")) break;
      EXPECT_NEAR(value, change.value.front(), 1e-12);
    }
    EXPECT_EQ(quantity_text(*change.quantity, changed(text)),
              std::string_view(text).substr(std::string_view(text).find('=') + 1));
  }
  EXPECT_EQ(changed("cone=pyramidal").contact.cone, FrictionCone::kPyramidal);
}

// Masses take their inertias along; inertias alone leave the masses.
TEST(WorldQuantities, OfMassesAreTwo) {
  const RobotDescription before = *with_everything().robot, heavy = *changed("mass=x2").robot,
                         wide = *changed("inertia=x2").robot;
  EXPECT_NEAR(heavy.total_mass(), 2 * before.total_mass(), 1e-12);
  EXPECT_NEAR(wide.total_mass(), before.total_mass(), 1e-15);
  for (std::size_t i = 0; i < before.bodies.size(); ++i) {
    EXPECT_TRUE(heavy.bodies[i].inertia.I_C.isApprox(2 * before.bodies[i].inertia.I_C, 1e-12));
    EXPECT_TRUE(wide.bodies[i].inertia.I_C.isApprox(2 * before.bodies[i].inertia.I_C, 1e-12));
  }
}

// On ground that rises by 30 degrees half of the weight pulls back along it.
TEST(WorldQuantities, ASlopeTiltsGravity) {
  const Vector3 g = changed("slope=30").gravity;
  EXPECT_NEAR(g.x(), -kGravity / 2, 1e-12);
  EXPECT_NEAR(g.norm(), kGravity, 1e-12);
}

TEST(WorldQuantities, RefuseWhatTheyAreNot) {
  expect_no_change("frcition=0.4", "did you mean friction?");
  expect_no_change("friction", "NAME=VALUE");
  expect_no_change("friction=11", "[0, 10]");
  expect_no_change("friction=slippery", "'slippery'");
  expect_no_change("mass=heavy", "a number of kg");
  expect_no_change("mass=x-1", "xFACTOR");
  expect_no_change("mass=-1", "not below 0");
  expect_no_change("inertia=1", "xFACTOR");
  expect_no_change("solref=x2", "a value");
  expect_no_change("cone=x2", "a value");
  expect_no_change("kp=nan", "a number");
  expect_no_change("slope=90", "between -90 and 90");
}

// What was scaled stays scaled; what was not is as in the other world to the last bit.
TEST(CarryOver, KeepsWhatWasVaried) {
  const WorldSpec from = with_everything();
  WorldSpec to = from;
  for (const char* text : {"physics_dt=0.002", "impratio=10", "kp=7", "mass=x1.5", "delay=0", "slope=10"})
    parse_quantity_change(text, "test").apply(to);
  const WorldSpec same = carry_over(from, to, from);
  EXPECT_EQ(same.robot, to.robot);
  EXPECT_EQ(same.physics_dt, to.physics_dt);
  EXPECT_EQ(same.gravity, to.gravity);
  WorldSpec copied = from;
  copied.robot = std::make_shared<const RobotDescription>(*from.robot);
  EXPECT_EQ(identity_text(*carry_over(from, to, copied).robot), identity_text(*to.robot));

  WorldSpec varied = from;
  varied.physics_dt /= 2;
  varied.contact.impratio *= 10;
  for (const char* text : {"kp=x1.25", "mass=x2", "damping=x3"})
    parse_quantity_change(text, "test").apply(varied);
  const WorldSpec both = carry_over(from, to, varied);
  EXPECT_DOUBLE_EQ(both.physics_dt, 0.001);
  EXPECT_DOUBLE_EQ(both.contact.impratio, 100);
  EXPECT_NEAR(both.robot->total_mass(), 3 * from.robot->total_mass(), 1e-12);
  for (int i = 0; i < both.robot->joint_count(); ++i) {
    const Joint& joint = both.robot->joint(i);
    EXPECT_NEAR(joint.damping, 0.06, 1e-15);
    if (!joint.actuated) continue;
    EXPECT_DOUBLE_EQ(joint.kp, 8.75);
    EXPECT_EQ(joint.delay, 0);
  }
}

}  // namespace
}  // namespace crossgait
