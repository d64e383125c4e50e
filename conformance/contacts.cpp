// What contacts report and do: forces that carry a weight, geometry, walking.
#include <algorithm>
#include <cmath>

#include "conformance/contact_forces.h"
#include "conformance/topics.h"
#include "physics/robot/multibody.h"

namespace crossgait::conformance {
namespace {

constexpr const char* kSlope = "slope:angle=5,heading=30,size_x=2,size_y=2,cell=0.05";

/// Sum of contact forces averaged over the last 0.2 s of two seconds at home.
Vector3 mean_force(PhysicsBackend& world) {
  const JointTargets targets = scenes::home_targets(world.robot());
  advance(world, targets, 1800);
  Vector3 sum = Vector3::Zero();
  for (int i = 0; i < 200; ++i) {
    advance(world, targets);
    sum += total_force(world);
  }
  return sum / 200;
}

std::vector<double> standing(const Subject& subject) {
  double upright = 0, sideways = 0, least = std::numeric_limits<double>::infinity(), slip = 0, speed = 0;
  for (const scenes::RobotPtr& robot : {scenes::quadruped(), scenes::long_quadruped()}) {
    const auto world = subject.make(robot);
    const double weight = robot->total_mass() * kGravity;
    const Vector3 force = mean_force(*world);
    upright = std::max(upright, std::abs(force.z() / weight - 1));
    sideways = std::max(sideways, force.head<2>().norm() / weight);
    for (const FootContact& foot : world->foot_contacts()) {
      least = std::min(least, foot.touching ? foot.force.z() / weight : 0);
      slip = std::max(slip, foot.slip_speed);
    }
    speed = std::max(speed, world->state().v_WB.norm());
  }
  const auto slope = subject.make(world_on(kSlope, scenes::quadruped()));
  const Vector3 weight(0, 0, slope->robot().total_mass() * kGravity);
  const double on_slope = (mean_force(*slope) - weight).norm() / weight.z();
  const double left = residual_speed(subject.engine.info);
  return {upright, sideways, least, std::max(0.0, slip - left), std::max(0.0, speed - left), on_slope};
}

std::vector<double> penetration(const Subject& subject) {
  const auto world = subject.make(scenes::quadruped());
  mean_force(*world);
  const std::vector<double> weights = translational_inverse_weights(world->robot(), false);
  double deepest = 0, bound = 0;
  for (const Leg leg : kLegs) {
    const FootContact foot = world->foot_contacts()[leg];
    deepest = std::max(deepest, foot.penetration);
    const auto body = static_cast<std::size_t>((*world->robot().legs)[leg].foot_body);
    bound = std::max(bound, sinking(foot.force.z(), weights[body]));
  }
  // Hard contact removes a share of its penetration per step; what is left is what gravity adds in a few.
  return {deepest / (is_soft(subject) ? bound : 10 * kGravity * 1e-6)};
}

/// A ball of 5 cm at rest, 2 mm in the ground: the speed after a step, off what was asked for, over that.
double off_asked_speed(const Subject& subject, double erp, double fastest, double cfm) {
  constexpr double kRadius = 0.05, kDepth = 0.002;
  WorldSpec spec = scenes::world_of(scenes::block(ShapeType::kSphere, {kRadius, 0, 0}));
  spec.contact.erp = erp;
  spec.contact.max_depenetration_velocity = fastest;
  spec.contact.cfm = cfm;
  const auto world = subject.make(spec);
  RobotState state = world->home_state();
  state.p_WB = {0, 0, kRadius - kDepth};
  world->reset(state);
  advance(*world, {});
  const double falling = -kGravity * spec.physics_dt,
               asked = std::min(erp * kDepth / spec.physics_dt, fastest);
  const double expected = falling + (asked - falling) / (1 + cfm);
  return std::abs(world->state().v_WB.z() / expected - 1);
}

std::vector<double> error_reduction(const Subject& subject) {
  return {off_asked_speed(subject, 0.1, 1, 0), off_asked_speed(subject, 0.5, 0.05, 0),
          off_asked_speed(subject, 0.1, 1, 0.5)};
}

/// Differences of the contacts under four standing feet from where the terrain says that they are.
struct Geometry {
  double position = 0, distance = 0, normal = 0, others = 0, pushing = 0, cone = 0;
  void compare(const PhysicsBackend& world, const std::vector<Pose>& poses, double tolerance);
};

void Geometry::compare(const PhysicsBackend& world, const std::vector<Pose>& poses, double tolerance) {
  const RobotDescription& robot = world.robot();
  const Terrain& terrain = world.spec().terrain;
  others += std::abs(world.contacts().count - 4);
  for (const Contact& c : world.contacts()) {
    if (c.leg < 0 || c.body != (*robot.legs)[kLegs[static_cast<std::size_t>(c.leg)]].foot_body) {
      ++others;
      continue;
    }
    const Leg leg = kLegs[static_cast<std::size_t>(c.leg)];
    const Vector3 foot = foot_position(robot, leg, poses);
    const double radius = (*robot.legs)[leg].foot_radius;
    normal = std::max(normal, (c.normal - terrain.normal(foot.x(), foot.y())).norm() / (10 * tolerance));
    position =
        std::max(position, (c.p_WP - (foot - c.normal * (radius + c.distance / 2))).norm() / tolerance);
    SphereContact expected;
    const bool touches = terrain.touch_sphere(foot, radius + 1e-3, expected);
    distance =
        touches ? std::max(distance, std::abs(c.distance - expected.distance - 1e-3) / tolerance) : HUGE_VAL;
    const double normal_force = c.force.dot(c.normal);
    if (!(normal_force > 0)) ++pushing;
    cone = std::max(
        cone, (c.force - normal_force * c.normal).norm() / (world.spec().contact.friction * normal_force));
  }
}

std::vector<double> contact_geometry(const Subject& subject) {
  Geometry worst;
  for (const char* terrain : {"flat", kSlope}) {
    const auto world = subject.make(world_on(terrain, scenes::quadruped()));
    const JointTargets targets = scenes::home_targets(world->robot());
    advance(*world, targets, 600);
    std::vector<Pose> poses;  // contacts are those of the configuration that the step begins with
    forward_kinematics(world->robot(), world->state(), poses);
    advance(*world, targets);
    worst.compare(
        *world, poses,
        (world->spec().terrain.field() == nullptr ? 1e-12 : 1e-7) + 20 * epsilon(subject.precision()));
  }
  return {worst.others, worst.position, worst.distance, worst.normal, worst.pushing, worst.cone};
}

std::vector<double> trotting(const Subject& subject) {
  const auto world = subject.make(scenes::quadruped());
  const scenes::Trot trot(world->robot());
  double stance_force = 0, swing_force = 0;
  int loose = 0;
  while (world->state().time < 5.5) {
    const double t = world->state().time;
    advance(*world, trot.targets(t));
    const LegArray<FootContact> feet = world->foot_contacts();
    for (const Leg leg : kLegs) {
      // Well inside swing and stance; the servos are too soft to tell when exactly a foot leaves and lands.
      const bool swings = scenes::Trot::swings(leg, t);
      const bool settled =
          scenes::Trot::swings(leg, t - 0.15) == swings && scenes::Trot::swings(leg, t + 0.15) == swings;
      if (t < scenes::Trot::kStand + scenes::Trot::kCycle || !settled) continue;
      (swings ? swing_force : stance_force) += feet[leg].force.z();
      if (!swings && !feet[leg].touching) ++loose;
    }
  }
  return {static_cast<double>(loose), swing_force / stance_force, world->state().p_WB.x()};
}

std::vector<double> no_contact(const Subject& subject) {
  WorldSpec spec = scenes::world_of(scenes::quadruped());
  spec.fixed_base = true;
  const auto held = subject.make(spec);
  RobotState start = held->home_state();
  start.p_WB.z() = held->robot().home_height - 2e-3;
  int wrong = 0;
  for (const Leg leg : kLegs) {
    held->reset(start);
    JointTargets lifted = scenes::home_targets(held->robot());
    lifted.q[3 * static_cast<Eigen::Index>(leg)] += side_sign(leg) * 0.7;  // swung outward
    advance(*held, lifted, 800);
    const LegArray<FootContact> feet = held->foot_contacts();
    for (const Leg other : kLegs) wrong += feet[other].touching == (other != leg) ? 0 : 1;
  }
  const auto flying = subject.make(scenes::quadruped());
  start = flying->home_state();
  start.p_WB.z() += 1;
  flying->reset(start);
  advance(*flying, scenes::home_targets(flying->robot()), 100);
  return {static_cast<double>(wrong), static_cast<double>(flying->contacts().count)};
}

}  // namespace

std::vector<Check> contact_checks() {
  const std::string settled = "what is left of the touch-down's swinging after 1.8 s";
  const std::string rounding =
      "1e-12 m on the plane; 1e-7 m on a field, whose heights are floats; and 20 eps";
  return {
      {"standing",
       "The feet carry the weight, on the plane and on a slope, and stand still",
       {at_most(1e-3, "force over weight, off 1", "", settled),
        at_most(1e-3, "force sideways over weight", "", settled),
        at_least(0.1, "least foot's share of the weight", "", "no leg hangs"),
        at_most(1e-3, "feet slip, beyond what is declared", "m/s",
                settled + "; what the declared way of solving leaves"),
        at_most(1e-3, "base moves, beyond what is declared", "m/s", "the same"),
        at_most(1e-3, "force on a slope of 5 degrees, off the weight, relative", "", settled)},
       standing},
      {"penetration",
       "Feet sink as far as the contact law says",
       {at_most(1, "depth over what the law allows", "",
                "soft: R f = K imp r at the least impedance; hard: 10 g h^2")},
       penetration},
      {"error_reduction",
       "Hard contact undoes as much of a penetration in a step, as fast and as softly, as it is asked to",
       {with_rounding(at_most(1e-6, "speed with erp 0.1, relative", "",
                              "the solver's tolerance: one row, which gravity and the depth alone load"),
                      1000),
        with_rounding(
            at_most(1e-6, "speed with max_depenetration_velocity 0.05 m/s, relative", "", "the same"), 1000),
        with_rounding(at_most(1e-6, "speed with cfm 0.5, relative", "", "the same"), 1000)},
       error_reduction,
       {"Capabilities::error_reduction",
        [](const Subject& subject) { return subject.engine.info.capabilities.error_reduction; }}},
      {"contact_geometry",
       "Contacts are Terrain::touch_sphere's, named for their feet, midway in the overlap, and push",
       {at_most(0, "feet without, or contacts beside the feet's", "",
                "a standing foot touches in every step: hard contact needs a margin"),
        at_most(1, "point, off, over rounding", "", rounding),
        at_most(1, "distance, off, over rounding", "", rounding),
        at_most(1, "normal, off, over ten times rounding", "", rounding),
        at_most(0, "contacts that do not push", "", "a normal force is positive"),
        with_rounding(at_most(1 + 1e-6, "friction over that of the cone", "",
                              "soft cones are met to the solver's tolerance; rounding of accelerations"),
                      10000)},
       contact_geometry},
      {"trotting",
       "In a trot feet take turns: those that stand touch in every step, those that swing are light",
       {at_most(0, "steps in which a standing foot does not touch", "", "as `contact_geometry`"),
        at_most(0.2, "load of swinging feet over that of standing ones", "",
                "hard contact lets the robot tip on to a corner: it drags a foot"),
        at_least(0.3, "way in 5 s", "m", "it walks; 0.46 to 0.48 in MuJoCo and Bullet")},
       trotting},
      {"no_contact",
       "A foot that is held up does not touch, nor does anything in the air",
       {at_most(0, "of 16 feet, wrong", "", "three stand, one is swung outward"),
        at_most(0, "contacts a metre up", "", "there is nothing")},
       no_contact},
  };
}

}  // namespace crossgait::conformance
