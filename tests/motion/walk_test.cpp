#include "motion/walk.h"

#include <cmath>

#include <gtest/gtest.h>

#include "backends/registry.h"
#include "motion/gait_source.h"
#include "motion/time_steps.h"
#include "physics/core/error.h"
#include "physics/robot/multibody.h"

namespace crossgait {
namespace {

std::shared_ptr<const RobotDescription> robot() {
  static const auto kRobot = std::make_shared<const RobotDescription>(
      load_robot(CROSSGAIT_SOURCE_DIR "/models/robots/scara_quadruped/robot.yaml"));
  return kRobot;
}

std::unique_ptr<PhysicsBackend> any_world() {
  WorldSpec spec;
  spec.robot = robot();
  return make_world(available_engines().front(), spec);
}

LegArray<Vector3> standing_feet() {
  LegArray<Vector3> feet;
  feet.fill(Vector3(0, 0, -0.06));
  return feet;
}

WorldSpec world_spec() {
  WorldSpec spec;
  spec.robot = robot();
  return spec;
}

ControllerPtr standing() {
  return make_feet_controller([](double) { return standing_feet(); }, world_spec());
}

TEST(FootTargetTracker, UnreachableStandingFootIsAnError) {
  LegArray<Vector3> feet = standing_feet();
  feet[Leg::RL].z() = -0.5;
  const FootTargetTracker legs(robot());
  EXPECT_THROW((void)legs.standing_state(feet, Terrain()), ConfigError);
}

TEST(FootTargetTracker, CountsTargetsOutOfReach) {
  FootTargetTracker legs(robot());
  LegArray<Vector3> feet = standing_feet();
  legs.update(feet, 2e-3);
  EXPECT_EQ(legs.clamped(), 0);
  feet[Leg::FR].z() = -0.5;
  EXPECT_TRUE(legs.update(feet, 2e-3).q.allFinite());
  EXPECT_EQ(legs.clamped(), 1);
  EXPECT_EQ(legs.status()[Leg::FR], IkStatus::kClampedTooFar);
  legs.restart();
  EXPECT_EQ(legs.clamped(), 0);
}

TEST(FootTargetTracker, LeadVanishesAtRestAndGrowsWithSpeed) {
  FootTargetTracker plain(robot(), ServoCompensation::none()), leading(robot(), {.load = false});
  LegArray<Vector3> feet = standing_feet();
  EXPECT_EQ(plain.update(feet, 2e-3).q, leading.update(feet, 2e-3).q);
  EXPECT_EQ(plain.update(feet, 2e-3).q, leading.update(feet, 2e-3).q);
  for (const Leg leg : kLegs) feet[leg].x() += 1e-4;  // 0.05 m/s
  const JointVector lead = leading.update(feet, 2e-3).q - plain.update(feet, 2e-3).q;
  for (const Leg leg : kLegs) feet[leg].x() += 2e-4;  // 0.10 m/s
  const JointVector twice = leading.update(feet, 2e-3).q - plain.update(feet, 2e-3).q;
  EXPECT_GT(lead.lpNorm<Eigen::Infinity>(), 1e-3);
  EXPECT_NEAR(twice.lpNorm<Eigen::Infinity>() / lead.lpNorm<Eigen::Infinity>(), 2.0,
              0.02);  // the legs' pose moved 2e-4 m
}

TEST(FootTargetTracker, FeetSweepLessByWhatTheyRoll) {
  GaitParameters p;
  p.load_share = 1;  // nothing gives way
  const FootTargetTracker legs(robot());
  const Vector2 sweep = legs.rolling_correction(standing_feet(), p);
  // Sideways: the leg turns by 1 / D for each metre, D = 0.06 + 0.010 m below the tilt axis
  // (docs/kinematics.md).
  const double radius = (*robot()->legs)[Leg::FL].foot_radius;
  EXPECT_NEAR(1 / sweep.y(), 1 + radius / 0.07, 1e-6);  // central differences over 1e-4 of 0.07 m
  // Forward: of a chain u, l from shoulder to foot with the foot's velocity v, v . u = w (z x l) . u.
  constexpr double kUpper = 0.045, kLower = 0.06, kDepth = 0.06, kShoulder = -0.010;
  const Vector2 foot(-kShoulder, -kDepth);  // from the rear shoulder
  const double reach = foot.norm();
  const double bend = std::acos((reach * reach + kUpper * kUpper - kLower * kLower) / (2 * reach * kUpper));
  const double angle = std::atan2(foot.y(), foot.x()) - bend;  // its elbow is outward, to the rear
  const Vector2 upper = kUpper * Vector2(std::cos(angle), std::sin(angle)), lower = foot - upper;
  const double rate = upper.x() / (-lower.y() * upper.x() + lower.x() * upper.y());
  EXPECT_GT(rate, 10);
  EXPECT_NEAR(1 / sweep.x(), 1 + radius * rate, 1e-5);  // as above
}

TEST(FootTargetTracker, FeetSweepOtherwiseByWhatTheirLoadLeaves) {
  const FootTargetTracker legs(robot()), plain(robot(), ServoCompensation::none());
  const auto advance = [](const FootTargetTracker& l, double share, double duty) {
    GaitParameters p;
    p.load_share = share;
    p.duty_factor = duty;
    return Vector2(l.rolling_correction(standing_feet(), p).cwiseInverse());
  };
  const Vector2 carried = advance(legs, 1, 0.5), half = advance(legs, 0.5, 0.5);
  EXPECT_LT(half.x(), carried.x() - 0.01);  // it gives way against the sweep
  // In proportion to what is left, and to the load of a leg: the weight over the legs that stand.
  EXPECT_LT((advance(legs, 0, 0.5) - carried - 2 * (half - carried)).norm(), 1e-12);
  EXPECT_LT((advance(legs, 0.5, 0.75) - carried - 2.0 / 3 * (half - carried)).norm(), 1e-12);
  EXPECT_EQ(advance(plain, 1, 0.5), advance(legs, 0, 0.5)) << "servos that make up for nothing";
}

TEST(FootTargetTracker, HoldsUpTheLoadOfStandingLegs) {
  // A servo's lead times its stiffness is a torque, and the torques of all legs do the work of lifting the
  // weight: tau . theta' = load d' for any velocity d' of the foot downward.
  FootTargetTracker plain(robot(), ServoCompensation::none());
  FootTargetTracker lifting(robot(), {.lag = false});
  lifting.set_load_share(1);
  LegArray<Vector3> feet = standing_feet();
  feet[Leg::FR].z() += 0.01;  // in the air
  const JointVector lead = lifting.update(feet, 0).q - plain.update(feet, 0).q;
  const std::vector<int> joints = robot()->actuated_joints();
  const double third = robot()->total_mass() * 9.81 / 3, h = 1e-6;
  for (const Leg leg : kLegs) {
    LegArray<Vector3> up = feet, down = feet;
    up[leg].z() += h;
    down[leg].z() -= h;
    const JointVector rate =
        (JointVector(plain.update(down, 0).q) - JointVector(plain.update(up, 0).q)) / (2 * h);
    double force = 0;
    for (std::size_t k = 0; k < joints.size(); ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      force += robot()->joint(joints[k]).kp * lead[i] * rate[i];
    }
    EXPECT_NEAR(force, leg == Leg::FR ? 0 : third, 1e-6);  // h^2 and rounding / h of the differences
  }
}

TEST(LoadShares, PassSmoothlyToTheLowestFeet) {
  LegArray<Vector3> feet = standing_feet();
  for (const double share : load_shares(feet, 0.005)) EXPECT_DOUBLE_EQ(share, 0.25);
  feet[Leg::FL].z() += 0.0025;
  const LegArray<double> halfway = load_shares(feet, 0.005);
  EXPECT_NEAR(halfway[Leg::FL], 0.5 / 3.5, 1e-12);  // rounding
  EXPECT_NEAR(halfway[Leg::RR], 1 / 3.5, 1e-12);
  feet[Leg::FL].z() += 0.02;
  EXPECT_EQ(load_shares(feet, 0.005)[Leg::FL], 0);
}

TEST(ElbowDrag, IsThePowerThatTheElbowsDissipate) {
  // Virtual work: tau . theta' must equal d (elbow_left'^2 + elbow_right'^2), with rates by central
  // differences.
  const FiveBarGeometry g = five_bar_geometry(*robot(), Leg::FL);
  const Vector3 foot(0.012, 0.015, -0.062), velocity(0.3, -0.1, -0.2);
  const double d = 0.02, h = 1e-6;
  const LegAngles at = solve_leg(g, foot).angles;
  const LegAngles before = solve_leg(g, foot - h * velocity).angles,
                  after = solve_leg(g, foot + h * velocity).angles;
  const auto rate = [h](double a, double b) { return (b - a) / (2 * h); };
  const Vector3 rates(rate(before.tilt, after.tilt), rate(before.shoulder_left, after.shoulder_left),
                      rate(before.shoulder_right, after.shoulder_right));
  const double left = rate(before.elbow_left, after.elbow_left),
               right = rate(before.elbow_right, after.elbow_right);
  const Vector3 torque =
      leg_jacobian(g, at).transpose() * elbow_drag_force(g, place_leg(g, foot), velocity, {.damping = d});
  EXPECT_NEAR(torque.dot(rates), d * (left * left + right * right),
              1e-7);  // h^2 and rounding / h of the differences
}

TEST(ElbowDrag, TakesDryFrictionByTheSignOfTheElbowsRates) {
  const FiveBarGeometry g = five_bar_geometry(*robot(), Leg::FL);
  const Vector3 foot(0.012, 0.015, -0.062), velocity(0.3, -0.1, -0.2);
  // Elbows turn at several rad/s: with a slowness of 1e-6 friction counts in full, and its power is friction
  // times the sum of their speeds, a damper's the sum of their squares.
  const auto power = [&](const JointDrag& elbow) {
    return elbow_drag_force(g, place_leg(g, foot), velocity, elbow).dot(velocity);
  };
  const double h = 1e-6;
  const LegAngles before = solve_leg(g, foot - h * velocity).angles,
                  after = solve_leg(g, foot + h * velocity).angles;
  const double left = (after.elbow_left - before.elbow_left) / (2 * h),
               right = (after.elbow_right - before.elbow_right) / (2 * h);
  ASSERT_GT(std::min(std::abs(left), std::abs(right)), 0.1);
  EXPECT_NEAR(power({.friction = 0.05, .slow = 1e-6}), 0.05 * (std::abs(left) + std::abs(right)), 1e-7);
  EXPECT_EQ(power({.damping = 0.02, .friction = 0, .slow = 0.1}), power({.damping = 0.02}));
}

TEST(JointDrag, IsSmoothWhereTheJointTurnsRound) {
  const JointDrag drag{.damping = 0.5, .friction = 2, .slow = 0.1};
  EXPECT_EQ(drag.torque(0), 0);
  EXPECT_NEAR(drag.torque(10), 5 + 2, 2e-4);  // (slow / rate)^2 / 2 of the friction is missing
  EXPECT_EQ(drag.torque(-3), -drag.torque(3));
  EXPECT_NEAR(drag.dry(0.1), 2 / std::sqrt(2.0), 1e-12);
}

TEST(FootTargetTracker, LeadsByTheDryFrictionOfItsServos) {
  // A friction of f asks servos of stiffness kp for f / kp more in the direction they turn.
  constexpr double kFriction = 0.02;
  RobotDescription rubbing = *robot();
  for (const LegModel& leg : *rubbing.legs) {
    for (const int i : leg.servos) rubbing.bodies[static_cast<std::size_t>(i) + 1].joint.friction = kFriction;
  }
  FootTargetTracker smooth(robot()), dry(std::make_shared<const RobotDescription>(rubbing));
  const std::vector<int> actuated = robot()->actuated_joints();
  LegArray<Vector3> feet;
  for (int step = 0; step < 3; ++step) {
    feet.fill(Vector3(0.0004 * step, 0.0001 * step, -0.06));
    const JointVector a = smooth.update(feet, 2e-3).q, b = dry.update(feet, 2e-3).q;
    for (Eigen::Index k = 0; k < a.size(); ++k) {
      const double lead = std::abs(b[k] - a[k]) * robot()->joint(actuated[static_cast<std::size_t>(k)]).kp;
      EXPECT_NEAR(lead, step == 0 ? 0 : kFriction, 0.02 * kFriction)
          << k;  // some are not much faster than slow
    }
  }
}

TEST(Walk, AcceptsOnlyTimingThatCanBe) {
  WalkTiming timing;
  for (const auto& [physics_dt, substeps] : {std::pair{1e-3, 2}, {2e-3, 1}, {0.25e-3, 8}}) {
    EXPECT_NO_THROW(timing.validate(physics_dt));
    EXPECT_EQ(whole_steps("control_dt", timing.control_dt, physics_dt), substeps);
  }
  EXPECT_EQ(timing.control_steps(), 2500);
  EXPECT_THROW(timing.validate(3e-3), ConfigError);
  timing.control_dt = 2.5e-3;
  EXPECT_THROW(timing.validate(1e-3), ConfigError);
  for (const double seconds : {-1.0, 0.0, std::nan(""), HUGE_VAL, 1e-300, 0.4 * WalkTiming{}.control_dt}) {
    WalkTiming bad;
    bad.seconds = seconds;
    EXPECT_THROW(bad.validate(1e-3), ConfigError) << seconds;
  }
}

TEST(Walk, StandingStillGoesNowhere) {
  const auto world = any_world();
  const WalkTiming timing{.seconds = 1};
  const MotionSummary s = run_walk(*world, standing(), timing);
  EXPECT_LT(std::abs(s.distance_m), 2e-3);  // soft contact lets a standing robot creep
  EXPECT_EQ(s.outcome, Outcome::kWalked);
  for (const auto& at : s.first_at_s) EXPECT_FALSE(at.has_value());
  EXPECT_EQ(s.physics_steps, 1000);
  for (const Leg leg : kLegs) EXPECT_DOUBLE_EQ(s.duty_factor[leg], 1.0);
}

TEST(Walk, TrotStatisticsAreThoseOfATrot) {
  const auto world = any_world();
  const WalkTiming timing{.seconds = 4};
  const GaitChoice trot = choose_gait("trot", {});
  int samples = 0;
  const MotionSummary s =
      run_walk(*world, make_gait_controller(trot, world_spec()), timing, [&](const WalkSample& sample) {
        ++samples;
        EXPECT_TRUE(sample.world.state().is_finite());
        return true;
      });
  EXPECT_EQ(samples, 2000);
  const double nominal = nominal_speed(trot.parameters);
  EXPECT_GT(s.mean_speed_mps, 0.8 * nominal);  // measured 0.93, the first stride growing from standing
  EXPECT_LT(s.mean_speed_mps, 1.1 * nominal);
  EXPECT_NEAR(s.distance_m, s.mean_speed_mps * s.simulated_seconds, 1e-12);
  EXPECT_LT(s.max_loop_gap_m, 1e-3);
  EXPECT_EQ(s.ik_clamped, 0);
  for (const Leg leg : kLegs) {
    EXPECT_GT(s.duty_factor[leg], 0.45);
    EXPECT_LT(s.duty_factor[leg], 0.9);  // soft servos lift late and land early
  }
}

TEST(GaitSource, ServosMakeUpForTheShareThatTheGaitSays) {
  const auto targets = [](const std::vector<std::string>& settings, const GaitLayers& layers) {
    const ControllerPtr source = make_gait_controller(choose_gait("trot", settings), world_spec(), layers);
    ControlTargets out;
    for (int i = 0; i < 100; ++i) source->advance(2e-3, out);
    return JointVector(out.joints.q);
  };
  const JointVector none = targets({"load_share=0"}, {});
  EXPECT_EQ(none, targets({}, {.compensation = {.load = false}, .heading_hold = {}}));
  EXPECT_GT((targets({}, {}) - none).lpNorm<Eigen::Infinity>(), 0.05);  // 0.2 rad for the whole load
}

TEST(DriveLegs, FollowsAShareOfTheLoadThatChangesOnTheWay) {
  GaitParameters p = find_gait("trot").preferred;
  GaitGenerator gait(find_gait("trot"), p, leg_origins(*robot()));
  p.load_share = 0;
  ASSERT_TRUE(gait.set_parameters(p));
  FootTargetTracker legs(robot()), none(robot(), {.load = false});
  ControlTargets out, expected;
  for (int i = 0; i < 500; ++i) {
    const LegArray<FootTarget>& feet = gait.update(2e-3);
    drive_legs(legs, gait, feet, {}, 2e-3, out);
    solve_legs(none, target_positions(feet), 2e-3, expected);
  }
  EXPECT_EQ(gait.effective().parameters.load_share, 0);
  EXPECT_EQ(out.joints.q, expected.joints.q);
}

TEST(GaitChoice, SettingsChangeEveryGaitThatMayBeChosen) {
  const VelocityCommand command{0.1, 0, 0};
  const GaitChoice plain = choose_gait("auto", {}, command),
                   set = choose_gait("auto", {"cycle_time=.3"}, command);
  EXPECT_EQ(plain.name(), "auto");
  ASSERT_EQ(plain.bands.size(), 2U);
  ASSERT_EQ(set.bands.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NE(plain.bands[i].gait.preferred.cycle_time, 0.3);
    EXPECT_EQ(set.bands[i].gait.preferred.cycle_time, 0.3);
    EXPECT_EQ(set.bands[i].gait.preferred.duty_factor, plain.bands[i].gait.preferred.duty_factor);
  }
  EXPECT_EQ(set.parameters.cycle_time, 0.3);
  const GaitChoice guide = choose_gait("auto:guide", {}, command);
  EXPECT_EQ(guide.name(), "auto:guide");
  ASSERT_EQ(guide.bands.size(), 3U);
  EXPECT_EQ(guide.bands[1].gait.name, "trot:guide");
  EXPECT_EQ(guide.bands[1].below, 0.3);
  EXPECT_THROW((void)choose_gait("auto:guide", {}), ConfigError);
  EXPECT_EQ(choose_gait("pace", {}).name(), "pace");
}

TEST(Walk, ObserverCanEndIt) {
  const auto world = any_world();
  int samples = 0;
  const MotionSummary s = run_walk(*world, standing(), WalkTiming{.seconds = 5},
                                   [&](const WalkSample&) { return ++samples < 10; });
  EXPECT_EQ(s.physics_steps, 20);
}

TEST(Walk, FallingIsNoticed) {
  // Pulled sideways by more than its weight and unable to slide, the robot must tip over its feet: its centre
  // of mass is as high as they are apart.
  WorldSpec spec;
  spec.robot = robot();
  spec.gravity = {0, 20, -9.81};
  spec.contact.friction = 5;
  const auto world = make_world(available_engines().front(), spec);
  const WalkTiming timing{.seconds = 2, .settle_seconds = 0};
  const MotionSummary s = run_walk(*world, standing(), timing);
  ASSERT_TRUE(s.has(Outcome::kFell));
  EXPECT_GT(*s.first_at_s[static_cast<std::size_t>(Outcome::kFell)], 0.0);
  EXPECT_FALSE(s.has(Outcome::kDiverged));
  EXPECT_DOUBLE_EQ(s.simulated_seconds, 2);  // a fall is on the trace
}

TEST(GaitSource, UnknownNamesAreErrors) {
  EXPECT_THROW((void)choose_gait("hop", {}), ConfigError);
  EXPECT_THROW((void)choose_gait("trot", {"step_len=1"}), ConfigError);
  EXPECT_THROW((void)choose_gait("trot", {"step_length"}), ConfigError);
  EXPECT_DOUBLE_EQ(choose_gait("trot", {"step_length=.07"}).parameters.step_length, 0.07);
}

}  // namespace
}  // namespace crossgait
