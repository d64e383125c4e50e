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
      const JointVector before = world.state().qd;
      EXPECT_EQ(world.step(step.targets.joints), StepStatus::kOk);
      if (!step.counts) continue;
      add_physics_step(world, step.targets, weight, r);
      // What the servo gave: the torque on the joint is that less the joint's damping.
      for (const int j : robot.actuated_joints())
        r.work += std::abs((world.torques()[j] + robot.joint(j).damping * before[j]) *
                           (before[j] + world.state().qd[j]) / 2) *
                  world.spec().physics_dt;
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
    // It goes straight on: too little of a turn, where one was asked for.
    EXPECT_EQ(m.outcome, straight ? Outcome::kWalked : Outcome::kTooSlow);
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
              straight ? 0 : 0.4);  // 0.2 rad/s for 2.7 s are missing where a turn was asked for
    EXPECT_NEAR(m.swing_contact_ratio.value(), drag, kRounding);
    EXPECT_GT(drag, 0);
    EXPECT_LT(drag, 0.5);  // it does lift its feet
    const double weight = spec.robot->total_mass() * 9.81;
    EXPECT_NEAR(m.cost_of_transport.value(), r.work / (weight * r.path), kRounding);
    EXPECT_NEAR(m.rms_roll_deg, std::sqrt(r.roll2) * 180 / M_PI, kRounding);
    EXPECT_NEAR(m.rms_pitch_deg, std::sqrt(r.pitch2) * 180 / M_PI, kRounding);
    // Forward is where it faced, 0.4 rad to the left of +x.
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

/// Work of `steps` physics steps with these targets, J.
double work_of(PhysicsBackend& world, const JointTargets& targets, int steps) {
  MotionStatistics statistics(world.robot());
  statistics.begin(world, 0);
  ControlTargets control;
  control.joints = targets;
  for (int i = 0; i < steps; ++i) {
    EXPECT_EQ(world.step(targets), StepStatus::kOk);
    statistics.add_physics_step(world, control);
  }
  EXPECT_NEAR(statistics.integrals().seconds, steps * world.spec().physics_dt, 1e-12);
  return statistics.integrals().work;
}

WorldSpec weightless_hinge(const scenes::ArmLink& link) {
  WorldSpec spec = scenes::world_of(scenes::arm({link}));
  spec.fixed_base = true;
  spec.gravity.setZero();
  return spec;
}

TEST_P(MotionNumbers, WorkOfAKnownTorqueIsItsKineticEnergy) {
  // A servo at its limit gives a constant torque: the hinge has (torque x time)^2 / (2 inertia) in the end.
  const scenes::ArmLink link{.servo = true, .kp = 1e6, .kd = 0, .effort_limit = 0.02, .limit = 1e3};
  const auto world = make(weightless_hinge(link));
  const double inertia = link.joint_inertia(), half = 0.25;
  const double energy = std::pow(link.effort_limit * half, 2) / (2 * inertia);
  const int steps = static_cast<int>(std::lround(half / world->spec().physics_dt));
  JointTargets targets{JointVector::Constant(1, 1e3)};
  // Rounding of 250 steps; MuJoCo's mass matrix carries 1e-15 of regularisation.
  const double rounding = 1e-10 + 250 * eps();
  EXPECT_NEAR(work_of(*world, targets, steps), energy, rounding * energy);
  EXPECT_NEAR(world->state().qd[0], link.effort_limit * half / inertia, 10 * rounding);
  // Braking takes it out again, and counts as well: a servo does not store it.
  targets.q[0] = -1e3;
  EXPECT_NEAR(work_of(*world, targets, steps), energy, rounding * energy);
  EXPECT_NEAR(world->state().qd[0], 0, 10 * rounding);
}

TEST_P(MotionNumbers, WhatDampingTakesIsTheServosWork) {
  // The servo's torque, from a state in which it holds what damping takes: none of its energy stays.
  scenes::ArmLink link{
      .damping = 0.01, .servo = true, .kp = 1e6, .kd = 0, .effort_limit = 0.02, .limit = 1e3};
  const auto world = make(weightless_hinge(link));
  RobotState state = world->home_state();
  state.qd[0] = link.effort_limit / link.damping;
  world->reset(state);
  const double rate = state.qd[0], seconds = 100 * world->spec().physics_dt;
  EXPECT_NEAR(work_of(*world, {JointVector::Constant(1, 1e3)}, 100), link.effort_limit * rate * seconds,
              1e-12 + 100 * eps());
  EXPECT_NEAR(world->state().qd[0], rate, 1e-12 + 100 * eps());  // rounding of 100 steps
}

ControllerPtr trot_of_its_size(const WorldSpec& spec) {
  return make_gait_controller(choose_gait("trot", {}, {}, gait_scale(*spec.robot)), spec);
}

/// Targets of `source` for control steps of `held` s, in steps that may be shorter.
ControllerPtr held_for(const ControllerPtr& source, double held) {
  const auto holding = motions::functions_of(source);
  holding->on_advance = [source, held, step = 0L, last = ControlTargets{}](double dt,
                                                                           ControlTargets& out) mutable {
    if (step++ % std::lround(held / dt) == 0) source->advance(held, last);
    out = last;
  };
  holding->on_look = [](const RobotState&, double) {};
  return holding;
}

TEST_P(MotionNumbers, CostIsNoMatterOfWhenTheServosAreLookedAt) {
  // One motion, its targets changing every 4 ms, told in control steps of 4, 2 and 1 ms: torques jump with
  // the targets and decay in between.
  const WorldSpec spec = scenes::world_of(scenes::serial_quadruped());
  const auto walked = [&](double control_dt) {
    const auto world = make(spec);
    return run_walk(*world, held_for(trot_of_its_size(spec), 4e-3),
                    {.seconds = 2, .control_dt = control_dt, .settle_seconds = 0.2});
  };
  const MotionSummary coarse = walked(4e-3);
  for (const double control_dt : {2e-3, 1e-3}) {
    const MotionSummary fine = walked(control_dt);
    EXPECT_EQ(fine.final_position_m, coarse.final_position_m);
    EXPECT_NEAR(fine.cost_of_transport.value(), coarse.cost_of_transport.value(), 1e-12);  // rounding
  }
}

TEST_P(MotionNumbers, ADelayThatChangesNoMotionChangesNoCost) {
  // A millisecond later the robot does the same: what it costs may differ by what the motion differs by.
  const auto walked = [&](double delay) {
    RobotDescription robot = *scenes::serial_quadruped();
    for (Body& body : robot.bodies) body.joint.delay = body.joint.actuated ? delay : 0;
    const WorldSpec spec = scenes::world_of(scenes::finished(robot));
    const auto world = make(spec);
    return run_walk(*world, trot_of_its_size(spec), {.seconds = 5});
  };
  const MotionSummary prompt = walked(0), late = walked(1e-3);
  EXPECT_NEAR(late.distance_m, prompt.distance_m, 0.005 * prompt.distance_m);
  EXPECT_NEAR(late.cost_of_transport.value(), prompt.cost_of_transport.value(),
              0.01 * prompt.cost_of_transport.value());
}

}  // namespace
}  // namespace crossgait
