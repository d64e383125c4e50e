#include "study/setup.h"

#include <algorithm>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "backends/registry.h"
#include "physics/core/error.h"
#include "physics/robot/robot_identity.h"
#include "physics/robot_files/data_path.h"
#include "scenes/robots.h"
#include "scenes/scenes.h"
#include "study/engine_comparison.h"
#include "study/robot_parts.h"

namespace crossgait {
namespace {

WorldSpec nominal() { return scenes::world_of(scenes::quadruped()); }

std::vector<std::string> names_of(const WorldSetup& setup) {
  std::vector<std::string> names;
  for (const SetupChange& change : setup.changes) names.push_back(change.name);
  return names;
}

void expect_refused(const std::string& text, const std::string& part) {
  try {
    (void)read_setup(text, nominal());
    FAIL() << text;
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

TEST(Setup, IsAWithNamedChanges) {
  const WorldSpec a = nominal();
  const WorldSetup setup = read_setup("friction=0.4,mass=x1.1,kp=x0.8", a);
  EXPECT_EQ(names_of(setup), (std::vector<std::string>{"friction", "mass", "kp"}));
  EXPECT_EQ(setup.changes[0].from, "0.6");
  EXPECT_EQ(setup.changes[0].to, "0.4");
  EXPECT_EQ(setup.changes[2].group, "gains");
  EXPECT_DOUBLE_EQ(setup.b.contact.friction, 0.4);
  EXPECT_NEAR(setup.b.robot->total_mass(), 1.1 * a.robot->total_mass(), 1e-12);
  EXPECT_EQ(identity_text(*setup.a.robot), identity_text(*a.robot));
  EXPECT_EQ(factors_of(setup), SetupFactorOf::kChange);
}

TEST(Setup, RefusesWhatIsNoChange) {
  expect_refused("", "found ''");
  expect_refused("frction=0.4", "did you mean friction?");
  expect_refused("robto=x", "did you mean robot?");
  expect_refused("friction=0.6", "what is not so already");
  expect_refused("delay=x2", "what is not so already");
  expect_refused("mass=x1", "what is not so already");
  expect_refused("friction=0.4,friction=0.3", "a second one");
  expect_refused("friction", "NAME=VALUE");
  expect_refused("friction=0.4,", "found ''");
  expect_refused("torsional_friction=0.01", "condim");
  expect_refused("physics_dt=1", "time step");
  expect_refused("mass=0", "--against: body 'trunk': expected mass");
  expect_refused("slope=100", "--against: slope: expected an angle");
  expect_refused("robot=", "robot=FILE");
  expect_refused("robot=scara_quadruped", "a file that says otherwise");
  expect_refused("robot=serial_quadruped", "bodies");
}

TEST(Setup, FactorsAreAsFewAsCanBeRun) {
  const auto level = [](const std::string& text) { return factors_of(read_setup(text, nominal())); };
  const std::string eight =
      "friction=0.4,impratio=10,mass=x1.1,trunk_mass=x1.1,kp=x0.9,kd=0.01,effort=x0.9,delay=0.004";
  EXPECT_EQ(level(eight), SetupFactorOf::kChange);
  EXPECT_EQ(level(eight + ",lag=0.01"), SetupFactorOf::kGroup);
  const std::string more =
      eight + ",damping=x2,stiffness=0.1,armature=x2,joint_friction=0.01,physics_dt=0.0005,gravity=9.7";
  EXPECT_EQ(level(more), SetupFactorOf::kKind);
  const Engine engine = find_engine(available_engines().front());
  const WorldSetup setup = read_setup(more, nominal());
  const EngineFamily family = setup_family(engine, setup);
  EXPECT_NO_THROW(family.validate());
  EXPECT_LE(family.factors.size(), kMostSetupFactors);
  EXPECT_NE(describe(setup).find("14 changes are more than 8"), std::string::npos) << describe(setup);
}

// The ends of the family are the two setups, and what lies between has worlds and names of its own.
TEST(Setup, LiesAtTheEndOfItsFamily) {
  const WorldSpec a = nominal();
  const WorldSetup setup = read_setup("friction=0.4,kp=x0.8", a);
  const Engine engine = find_engine(available_engines().front());
  const EngineFamily family = setup_family(engine, setup);
  EXPECT_EQ(family.from, engine.name());
  EXPECT_EQ(family.to, engine.name() + " with friction=0.4,kp=x0.8");
  EXPECT_EQ(family.with({}).name(), family.from);
  EXPECT_EQ(family.with({"friction", "kp"}).name(), family.to);
  const auto one = family.with({"kp"}).make(a);
  EXPECT_EQ(one->spec().contact.friction, a.contact.friction);
  const int servo = a.robot->actuated_joints().front();
  EXPECT_DOUBLE_EQ(one->spec().robot->joint(servo).kp, 0.8 * a.robot->joint(servo).kp);
  const auto all = with_setup(engine, setup).make(a);
  EXPECT_EQ(all->spec().contact.friction, 0.4);
  EXPECT_EQ(identity_text(*all->spec().robot), identity_text(*setup.b.robot));
}

// Its legs in another order, other names, and an axis that points the other way.
RobotDescription told_otherwise(const RobotDescription& a) {
  RobotDescription b = a;
  const std::size_t half = (a.bodies.size() - 1) / 2;
  std::vector<std::size_t> place{0};  // of a, by places in b: the second half of the bodies first
  for (std::size_t i = 0; i < a.bodies.size() - 1; ++i) place.push_back((i + half) % (2 * half) + 1);
  std::vector<int> now(place.size());
  for (std::size_t i = 0; i < place.size(); ++i) now[place[i]] = static_cast<int>(i);
  for (std::size_t i = 1; i < place.size(); ++i) {
    Body& body = b.bodies[i] = a.bodies[place[i]];
    body.parent = now[static_cast<std::size_t>(body.parent)];
    body.name = "other_" + body.name;
    body.joint.name = "other_" + body.joint.name;
    b.home[static_cast<Eigen::Index>(i) - 1] = a.home[static_cast<Eigen::Index>(place[i]) - 1];
  }
  for (LoopClosure& loop : b.loops) {
    loop.body_a = now[static_cast<std::size_t>(loop.body_a)];
    loop.body_b = now[static_cast<std::size_t>(loop.body_b)];
  }
  for (const Leg leg : kLegs) {
    LegModel& model = (*b.legs)[leg];
    for (auto* joints : {&model.servos, &model.passive}) {
      for (int& joint : *joints) joint = now[static_cast<std::size_t>(joint) + 1] - 1;
    }
    model.foot_body = now[static_cast<std::size_t>(model.foot_body)];
  }
  Joint& turned = b.bodies[3].joint;
  turned.axis *= -1;
  std::swap(turned.lower, turned.upper);
  turned.lower *= -1;
  turned.upper *= -1;
  std::swap(turned.target_lower, turned.target_upper);
  turned.target_lower *= -1;
  turned.target_upper *= -1;
  b.home[2] *= -1;
  return b;
}

TEST(RobotParts, AreOfTheSameRobotHoweverItIsTold) {
  for (const scenes::RobotPtr& robot : {scenes::quadruped(), scenes::serial_quadruped()}) {
    const RobotDescription b = in_order_of(*robot, told_otherwise(*robot));
    EXPECT_TRUE(unlike_parts(*robot, b).empty()) << robot->name;
    EXPECT_EQ(identity_text(b), identity_text(*robot));
  }
}

TEST(RobotParts, HaveAnglesFromTheSameZero) {
  const RobotDescription a = *scenes::serial_quadruped();
  RobotDescription b = a;
  for (const Leg leg : kLegs) {
    const int hip = (*a.legs)[leg].joint("hip");
    Body& body = b.bodies[static_cast<std::size_t>(hip) + 1];
    body.X_PB.rotate(Eigen::AngleAxisd(1.5, body.joint.axis));
    b.home[hip] -= 1.5;
    body.joint.lower -= 1.5;
    body.joint.upper -= 1.5;
  }
  ASSERT_NO_THROW(b.validate());
  EXPECT_THROW(in_order_of(a, b), ConfigError);
}

TEST(RobotParts, AreNamedByWhatDiffers) {
  const RobotDescription a = *scenes::serial_quadruped();
  const auto parts = [&a](void (*change)(RobotDescription&)) {
    RobotDescription b = a;
    change(b);
    return unlike_parts(a, b);
  };
  using Names = std::vector<std::string>;
  using R = RobotDescription;
  EXPECT_EQ(parts([](R& b) { b.bodies[2].inertia.p_BC.x() += 1e-3; }), Names{"mass properties"});
  EXPECT_EQ(parts([](R& b) { b.bodies[1].joint.kd += 0.1; }), Names{"gains"});
  EXPECT_EQ(parts([](R& b) { b.bodies[1].joint.effort_limit += 1; }), Names{"effort"});
  EXPECT_EQ(parts([](R& b) { b.bodies[1].joint.damping += 0.1; }), Names{"damping"});
  EXPECT_EQ(parts([](R& b) { b.bodies[1].joint.armature += 0.1; }), Names{"armature"});
  EXPECT_EQ(parts([](R& b) { b.bodies[1].joint.friction += 0.1; }), Names{"dry friction"});
  EXPECT_EQ(parts([](R& b) { b.bodies[1].joint.lag += 0.1; }), Names{"drives"});
  EXPECT_EQ(parts([](R& b) { b.bodies[1].joint.spring_reference += 0.1; }), Names{"springs"});
  EXPECT_EQ(parts([](R& b) { b.bodies[1].joint.upper += 0.1; }), Names{"geometry"});
  EXPECT_EQ(parts([](R& b) { b.bodies[1].X_PB.translation().x() += 0.1; }), Names{"geometry"});
  EXPECT_EQ(parts([](R& b) { b.standing_height += 0.1; }), Names{"geometry"});
  EXPECT_EQ(parts([](R& b) { b.friction_softness.time_constant *= 2; }), Names{"softness"});
  EXPECT_EQ(parts([](R& b) { b.bodies[3].joint.limit_softness.time_constant *= 2; }), Names{"softness"});
}

// Parts leave nothing out: one after the other they make the one robot of the other.
TEST(RobotParts, AreAllOfARobot) {
  const RobotDescription a = *scenes::quadruped();
  const RobotDescription b = in_order_of(a, *scenes::long_quadruped());
  const std::vector<std::string> parts = unlike_parts(a, b);
  EXPECT_TRUE(std::find(parts.begin(), parts.end(), "geometry") != parts.end());
  RobotDescription robot = a;
  for (const std::string& part : parts) robot = with_part(robot, b, part);
  RobotDescription expected = b;
  expected.contact = a.contact;
  EXPECT_EQ(identity_text(robot), identity_text(expected));
}

TEST(Setup, TakesAnotherFileOfTheRobotApart) {
  const WorldSetup setup = read_setup("robot=scara_quadruped_long,friction=0.4", nominal());
  const std::vector<std::string> names = names_of(setup);
  EXPECT_EQ(names.front(), "geometry");
  EXPECT_EQ(names.back(), "friction");
  EXPECT_EQ(setup.text.find("robot=scara_quadruped_long@"), 0U) << setup.text;
  const RobotDescription other = load_robot(find_robot("scara_quadruped_long"));
  EXPECT_EQ(setup.b.robot->total_mass(), other.total_mass());
}

BehaviourSpec short_trot() {
  WalkConfig config;
  config.timing = {.seconds = 0.2, .settle_seconds = 0.1};
  return {config, {}, 0};
}

JudgeOptions judge_against(const LoadedBehaviour& loaded, const std::string& text) {
  JudgeOptions options;
  options.verdict.starts = 4;
  options.explain = true;
  options.against = read_setup(text, loaded.world());
  return options;
}

// One change is the whole gap.
TEST(SetupVerdict, OfOneChangeIsItsCause) {
  const LoadedBehaviour loaded = short_trot();
  const std::string engine = available_engines().front();
  const EngineComparison judged = judge_engines(loaded, {engine}, judge_against(loaded, "gravity=x0.5"));
  ASSERT_EQ(judged.verdicts.pairs.size(), 1U);
  EXPECT_EQ(judged.verdicts.pairs.front().b, engine + " with gravity=x0.5");
  const Attribution& attribution = judged.backgrounds.front().attribution.value();
  ASSERT_EQ(attribution.effects.size(), 1U);
  bool found = false;
  for (std::size_t s = 0; s < attribution.statistics.size(); ++s) {
    EXPECT_EQ(attribution.effects.front().effect[s].estimate, attribution.gap[s].estimate);
    const Cause cause = attribution.cause(s);
    if (cause.kind == Cause::Kind::kNothing) continue;
    EXPECT_EQ(cause.leading, std::vector<std::string>{"gravity"}) << cause.sentence;
    found = true;
  }
  EXPECT_TRUE(found);
  const auto& models = judged.backgrounds.front().models.findings;
  ASSERT_FALSE(models.empty());
  EXPECT_EQ(models.front().quantity, "gravity");
  const nlohmann::ordered_json json = to_json(judged);
  EXPECT_EQ(json["against"]["text"], "gravity=x0.5");
  EXPECT_EQ(json["against"]["factor"], "change");
  EXPECT_EQ(json["against"]["changes"][0]["to"], "4.905");
}

// Each engine and itself, and engines among each other.
TEST(SetupVerdict, IsOfSeveralEngines) {
  const LoadedBehaviour loaded = short_trot();
  const std::vector<std::string> all = available_engines();
  if (all.size() < 2) GTEST_SKIP() << "one engine alone";
  JudgeOptions options = judge_against(loaded, "gravity=x0.5");
  options.explain = false;
  const EngineComparison judged = judge_engines(loaded, {all[0], all[1]}, options);
  const std::string with = " with gravity=x0.5";
  std::vector<std::string> names;
  for (const JudgedEngine& engine : judged.engines) names.push_back(engine.name);
  EXPECT_EQ(names, (std::vector<std::string>{all[0], all[0] + with, all[1], all[1] + with}));
  EXPECT_EQ(judged.verdicts.pairs.size(), 6U);
  EXPECT_TRUE(judged.backgrounds[pair_index(1, 3, 4)].models.findings.empty()) << "both under the setup";
  EXPECT_FALSE(judged.backgrounds[pair_index(0, 1, 4)].models.findings.empty());
}

// An environment's world is changed on top of what it draws.
TEST(SetupVerdict, IsOfPoliciesToo) {
  PolicyConfig config;
  config.environment = std::get<WalkConfig>(short_trot().what).environment();
  config.environment.randomisation[Randomised::kMass] = {0.8, 1.2};
  const LoadedBehaviour loaded = BehaviourSpec{config, {}, 0};
  const JudgeOptions options = judge_against(loaded, "gravity=x0.5,physics_dt=0.0005");
  const EngineComparison judged = judge_engines(loaded, {available_engines().front()}, options);
  const Attribution& attribution = judged.backgrounds.front().attribution.value();
  EXPECT_EQ(attribution.effects.size(), 2U);
}

}  // namespace
}  // namespace crossgait
