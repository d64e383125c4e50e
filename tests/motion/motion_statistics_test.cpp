// Every number of a motion, worked out once more from a recording of the same motion at every physics step.
#include "motion/motion_statistics.h"

#include <cmath>

#include "physics/robot/multibody.h"
#include "tests/motion/motions.h"
#include "tests/support/engine_test.h"

namespace crossgait {
namespace {

struct ControlStep {
  ControlTargets targets;
  bool counts = false;  // after settling
};

/// `source`, with everything that it says written down, and blind: it is not told where the robot is.
ControllerPtr recorded(const ControllerPtr& source, std::vector<ControlStep>& steps, RobotState& start) {
  const auto recording = motions::functions_of(source);
  recording->on_stand = [source, &start](const Terrain& terrain, const Placement& placement) {
    return start = source->initial_state(terrain, placement);
  };
  recording->on_hold = [source, &steps](double dt, ControlTargets& out) {
    source->hold_pose(dt, out);
    steps.push_back({out, false});
  };
  recording->on_advance = [source, &steps](double dt, ControlTargets& out) {
    source->advance(dt, out);
    steps.push_back({out, true});
  };
  recording->on_look = [](const RobotState&, double) {};
  return recording;
}

/// The definitions of MotionSummary, straight from states and contacts.
struct Recomputed {
  LegArray<double> duty{}, swing{}, drag{}, inner{}, inner_contact{};
  double sweep = 0, commanded_yaw = 0, heading_error = 0;
  double slip = 0, penetration = 0, gap = 0, work = 0, path = 0, roll2 = 0, pitch2 = 0, time = 0;
  Vector3 first = Vector3::Zero(), last = Vector3::Zero();
  double first_yaw = 0;
  int physics_steps = 0, clamped = 0;
};

double yaw_of(const RobotState& s) {
  const Vector3 x = s.q_WB * Vector3::UnitX();
  return std::atan2(x.y(), x.x());
}

void add_physics_step(const PhysicsBackend& world, const ControlTargets& targets, double weight,
                      Recomputed& r) {
  ++r.physics_steps;
  for (const Contact& c : world.contacts()) r.penetration = std::max(r.penetration, -c.distance);
  const LegArray<FootContact> feet = world.foot_contacts();
  for (const Leg leg : kLegs) {
    if (feet[leg].touching) {
      ++r.duty[leg];
      r.slip += feet[leg].slip_speed * world.spec().physics_dt;
    }
    if (!targets.contact_schedule || !(*targets.contact_schedule)[leg].swing) continue;
    const double dragged = feet[leg].force.norm() > 0.02 * weight ? 1 : 0;
    ++r.swing[leg];
    r.drag[leg] += dragged;
    if (std::abs((*targets.contact_schedule)[leg].progress - 0.5) > 0.4) continue;
    ++r.inner[leg];
    r.inner_contact[leg] += dragged;
  }
}

Recomputed recompute(PhysicsBackend& world, const RobotState& start, const std::vector<ControlStep>& steps,
                     double dt) {
  Recomputed r;
  const RobotDescription& robot = world.robot();
  const double weight = robot.total_mass() * world.spec().gravity.norm();
  const int substeps = static_cast<int>(std::lround(dt / world.spec().physics_dt));
  std::vector<Vector3> way;  // every half second
  int control_steps = 0;
  world.reset(start);
  for (const ControlStep& step : steps) {
    if (step.counts && control_steps == 0) {
      r.first = world.state().p_WB;
      r.first_yaw = yaw_of(world.state());
      way.push_back(r.first);
    }
    for (int i = 0; i < substeps; ++i) {
      EXPECT_EQ(world.step(step.targets.joints), StepStatus::kOk);
      if (step.counts) add_physics_step(world, step.targets, weight, r);
    }
    if (!step.counts) continue;
    const RobotState& s = world.state();
    ++control_steps;
    r.time += dt;
    r.clamped += step.targets.ik_clamped;
    if (const auto& asked = step.targets.velocity) {
      const double followed = step.targets.limit_factor * dt;
      r.commanded_yaw += asked->yaw_rate * followed;
      r.heading_error =
          std::max(r.heading_error,
                   std::abs(std::remainder(yaw_of(world.state()) - r.first_yaw - r.commanded_yaw, 2 * M_PI)));
      for (const Leg leg : kLegs) {
        if (step.targets.contact_schedule && !(*step.targets.contact_schedule)[leg].swing)
          r.sweep += std::hypot(asked->vx, asked->vy) * followed;
      }
    }
    for (const int i : robot.actuated_joints()) {
      // What the servo gave: the torque on the joint is that less the joint's damping.
      r.work += std::abs((world.torques()[i] + robot.joint(i).damping * s.qd[i]) * s.qd[i]) * dt;
    }
    std::vector<Pose> poses;
    forward_kinematics(robot, s, poses);
    if (control_steps % 5 == 0) r.gap = std::max(r.gap, max_loop_gap(robot, poses));  // every 10 ms
    const Matrix3 R = s.q_WB.toRotationMatrix();
    r.pitch2 += std::pow(std::asin(-R(2, 0)), 2);
    r.roll2 += std::pow(std::atan2(R(2, 1), R(2, 2)), 2);
    if (control_steps % 250 == 0) way.push_back(s.p_WB);
    r.last = s.p_WB;
  }
  way.push_back(r.last);
  for (std::size_t i = 1; i < way.size(); ++i) r.path += (way[i] - way[i - 1]).head<2>().norm();
  r.roll2 /= control_steps;
  r.pitch2 /= control_steps;
  return r;
}

/// The same motion, said to be meant for a turn to the left that the steps follow by half.
ControllerPtr said_to_turn(const ControllerPtr& source) {
  const auto turning = motions::functions_of(source);
  turning->on_advance = [source](double dt, ControlTargets& out) {
    source->advance(dt, out);
    out.velocity = VelocityCommand{0.1, 0.05, 0.4};
    out.limit_factor = 0.5;
  };
  return turning;
}

class MotionNumbers : public EngineTest {
 protected:
  struct Run {
    MotionSummary motion;
    Recomputed again;
  };
  static Run run(const WorldSpec& spec, const ControllerPtr& source, const WalkTiming& timing) {
    std::vector<ControlStep> steps;
    RobotState start;
    const auto world = make(spec), other = make(spec);
    Run run;
    run.motion = run_walk(*world, recorded(source, steps, start), timing, {}, {{0.1, 0, 0, 0, 0.4}, 0, {}});
    run.again = recompute(*other, start, steps, timing.control_dt);
    EXPECT_TRUE(scenes::identical(world->state(), other->state()));  // it was the same motion
    return run;
  }
  // Sums of a few thousand numbers in another order, or trigonometry done another way.
  static constexpr double kRounding = 1e-11;
};
CROSSGAIT_FOR_EVERY_BACKEND(MotionNumbers);

TEST_P(MotionNumbers, AreThoseOfARecordingAtEveryPhysicsStep) {
  for (const char* terrain : {"flat", "rough:seed=2,size_x=4,size_y=4"}) {
    WorldSpec spec = scenes::world_of(scenes::quadruped());
    spec.terrain = make_terrain(terrain);
    const WalkTiming timing{.seconds = 2.7, .settle_seconds = 0.3};
    const ControllerPtr trot = motions::trot(spec.robot);
    const bool straight = std::string_view(terrain) == "flat";
    const auto [m, r] = run(spec, straight ? trot : said_to_turn(trot), timing);
    EXPECT_EQ(m.outcome, Outcome::kWalked);
    EXPECT_EQ(m.physics_steps, r.physics_steps);
    EXPECT_EQ(m.physics_steps, 2700);
    EXPECT_NEAR(m.simulated_seconds, 2.7, kRounding);
    EXPECT_EQ(m.ik_clamped, r.clamped);
    EXPECT_EQ(m.max_penetration_m, r.penetration);
    EXPECT_NEAR(m.max_loop_gap_m, r.gap, 1e-15);  // see loop_gap_test
    EXPECT_NEAR(m.slip_m, r.slip, kRounding);
    EXPECT_NEAR(m.path_m, r.path, kRounding);
    double drag = 0, inner = 0;
    for (const Leg leg : kLegs) {
      EXPECT_EQ(m.duty_factor[leg], r.duty[leg] / r.physics_steps);
      EXPECT_GT(r.swing[leg], 1000);
      drag += r.drag[leg] / r.swing[leg] / kLegCount;
      EXPECT_NEAR(r.inner[leg] / r.swing[leg], 0.8, 0.02);  // a control step at either edge of a swing
      inner += r.inner_contact[leg] / r.inner[leg] / kLegCount;
    }
    EXPECT_NEAR(m.swing_contact_ratio_inner.value(), inner, kRounding);
    EXPECT_LT(inner, drag);  // feet touch at the ends of a swing above all
    EXPECT_NEAR(m.slip_per_path.value(), r.slip / r.sweep, kRounding);
    EXPECT_NEAR(m.heading_error_deg.value(), r.heading_error * 180 / M_PI, kRounding);
    EXPECT_GT(r.heading_error,
              straight ? 0 : 0.4);  // .2 rad/s for 2.7 s are missing where a turn was asked for
    EXPECT_NEAR(m.swing_contact_ratio.value(), drag, kRounding);
    EXPECT_GT(drag, 0);
    EXPECT_LT(drag, 0.5);  // it does lift its feet
    const double weight = spec.robot->total_mass() * 9.81;
    EXPECT_NEAR(m.cost_of_transport.value(), r.work / (weight * r.path), kRounding);
    EXPECT_NEAR(m.rms_roll_deg, std::sqrt(r.roll2) * 180 / M_PI, kRounding);
    EXPECT_NEAR(m.rms_pitch_deg, std::sqrt(r.pitch2) * 180 / M_PI, kRounding);
    // Forward is where it faced, .4 rad to the left of +x.
    const Vector3 moved = r.last - r.first;
    EXPECT_NEAR(m.distance_m,
                moved.head<2>().dot(Eigen::Vector2d(std::cos(r.first_yaw), std::sin(r.first_yaw))),
                kRounding);
    EXPECT_NEAR(m.lateral_m,
                moved.head<2>().dot(Eigen::Vector2d(-std::sin(r.first_yaw), std::cos(r.first_yaw))),
                kRounding);
    EXPECT_NEAR(r.first_yaw, 0.4, 0.1);
    EXPECT_NEAR(m.mean_speed_mps, m.distance_m / 2.7, kRounding);
    EXPECT_EQ(m.final_position_m, r.last);
    EXPECT_GT(m.distance_m, 0.2);
  }
}

TEST_P(MotionNumbers, AStandingRobotHasNoCostOfTransportAndNoDrag) {
  const WorldSpec spec = scenes::world_of(scenes::quadruped());
  const auto [m, r] = run(spec, motions::standing(spec.robot), {.seconds = 1});
  EXPECT_LT(m.path_m, 0.1 * spec.robot->home_height);
  EXPECT_FALSE(m.cost_of_transport.has_value());
  EXPECT_FALSE(m.swing_contact_ratio.has_value());
  EXPECT_FALSE(m.swing_contact_ratio_inner.has_value());
  EXPECT_FALSE(m.slip_per_path.has_value());
  EXPECT_FALSE(m.heading_error_deg.has_value());
  for (const Leg leg : kLegs) EXPECT_EQ(m.duty_factor[leg], 1);
}

TEST_P(MotionNumbers, SwayingWithinAStrideIsNoWay) {
  // Feet to and fro by 10 mm twice a second: the body comes back to where it was every half second.
  const WorldSpec spec = scenes::world_of(scenes::quadruped());
  const auto clock = std::make_shared<double>(0);
  const ControllerPtr sway = make_feet_controller(
      [clock](double dt) {
        *clock += dt;
        LegArray<Vector3> feet;
        feet.fill(Vector3(0, 0.01 * std::sin(4 * M_PI * *clock), -0.06));
        return feet;
      },
      spec);
  const auto [m, r] = run(spec, sway, {.seconds = 3});
  EXPECT_LT(m.path_m, 0.02);  // where the way to and fro is 6 x 40 mm
  EXPECT_NEAR(m.path_m, r.path, kRounding);
}

TEST_P(MotionNumbers, TheLeadInIsNoPartOfIt) {
  // Half a second of the trot before anything counts.
  const WorldSpec spec = scenes::world_of(scenes::quadruped());
  const auto late = make(spec), whole = make(spec);
  const MotionSummary m = run_walk(*late, motions::trot(spec.robot), {.seconds = 1}, {}, {{}, 0.5, {}});
  const MotionSummary all = run_walk(*whole, motions::trot(spec.robot), {.seconds = 1.5});
  EXPECT_TRUE(scenes::identical(late->state(), whole->state()));
  EXPECT_DOUBLE_EQ(m.simulated_seconds, 1);
  EXPECT_EQ(m.physics_steps, 1000);
  EXPECT_EQ(m.final_position_m, all.final_position_m);
  EXPECT_LT(m.distance_m, all.distance_m);
}

TEST_P(MotionNumbers, PowerIsThatOfTheServosAlone) {
  // A world of one instant: the servos' torque is kp times their lag, whatever joints lose to damping.
  const auto world = make(scenes::quadruped());
  const RobotDescription& robot = world->robot();
  JointTargets targets = scenes::home_targets(robot);
  targets.q.array() += 0.05;
  ASSERT_EQ(world->step(targets, 20), StepStatus::kOk);
  const RobotState before = world->state();
  ASSERT_EQ(world->step(targets), StepStatus::kOk);
  double expected = 0;
  const std::vector<int> servos = robot.actuated_joints();
  for (std::size_t k = 0; k < servos.size(); ++k) {
    const Joint& joint = robot.joint(servos[k]);
    // Of the last physics step: from the state that it began with, whose damping is out of the sum again,
    // times the speed that it ended with.
    const double servo =
        std::clamp(joint.kp * (targets.q[static_cast<Eigen::Index>(k)] - before.q[servos[k]]) -
                       joint.kd * before.qd[servos[k]],
                   -joint.effort_limit, joint.effort_limit);
    const double torque = servo - joint.damping * before.qd[servos[k]];
    EXPECT_NEAR(world->torques()[servos[k]], torque, 1e-15);
    const double qd = world->state().qd[servos[k]];
    expected += std::abs((torque + joint.damping * qd) * qd);
  }
  EXPECT_GT(expected, 0.01);
  EXPECT_NEAR(servo_power(*world, servos), expected, 1e-12 * expected);  // rounding
}

}  // namespace
}  // namespace crossgait
