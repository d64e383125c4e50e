// Coulomb friction: a sled sticks and slides where it should, stops where it should, in every heading alike.
#include <algorithm>
#include <cmath>

#include "conformance/contact_forces.h"
#include "conformance/topics.h"
#include "scenes/incline.h"

namespace crossgait::conformance {
namespace {

/// Speed at which contact gives way under the load that friction holds, at most, m/s. In MuJoCo's law a
/// friction row at rest balances R f = B v, with R at most (1 - d_min) / d_min / m and B = 2 / (d_max t_c):
/// the creep of a body whose four runners carry a quarter of its weight each. Hard contact does not creep:
/// what is left is the tolerance that its solver stops at, or where it stops after a few iterations.
double allowed_creep(const Subject& subject) {
  if (!is_soft(subject)) return 1e-5 + residual_speed(subject.engine.info);
  const Softness soft;
  const double load = kGravity * std::sin(scenes::incline_angle(scenes::kJustInside)) / 4;  // per mass
  const double R = (1 - soft.impedance_min) / soft.impedance_min,
               B = 2 / (soft.impedance_max * soft.time_constant);
  // The runners uphill carry less than that, reach the edge of their cones and leave a little more to the
  // others.
  return 1.05 * R * load / B;
}

std::vector<double> friction_cone(const Subject& subject, scenes::MakeIncline make_incline) {
  const scenes::FrictionCone cone = scenes::measure_friction_cone(subject.engine, make_incline);
  const double creep = allowed_creep(subject);
  return {cone.creep_speed / creep, cone.creep_distance / (creep * scenes::kInclineSeconds),
          cone.distance_error, cone.range, cone.off_line};
}

double creep_speed(const Subject& subject, double impratio) {
  scenes::Incline incline = scenes::tilted_gravity(scenes::incline_angle(2 * scenes::kJustInside), 0);
  incline.spec.contact.friction = scenes::kInclineFriction;
  incline.spec.contact.impratio = impratio;
  incline.spec.solver.tolerance = 1e-10;
  const auto world = subject.make(incline.spec);
  advance(*world, {}, 1000);
  return world->state().v_WB.dot(incline.downhill);
}

std::vector<double> soft_friction(const Subject& subject) {
  const double soft = creep_speed(subject, 1), stiff = creep_speed(subject, 10);
  return {soft, soft / stiff};
}

std::vector<double> hard_friction(const Subject& subject) {
  const double allowed = allowed_creep(subject);
  return {std::abs(creep_speed(subject, 1)) / allowed, std::abs(creep_speed(subject, 10)) / allowed};
}

/// A sled at rest on the plane, set in motion. @param v  m/s
std::unique_ptr<PhysicsBackend> sliding_sled(const Subject& subject, const WorldSpec& spec,
                                             const Vector3& v) {
  auto world = subject.make(spec);
  advance(*world, {}, 200);
  RobotState moving = world->state();
  moving.p_WB.x() = moving.p_WB.y() = 0;
  moving.v_WB = v;
  world->reset(moving);
  return world;
}

std::vector<double> sled_stops(const Subject& subject) {
  WorldSpec spec = scenes::world_of(scenes::sled());
  spec.contact.friction = 0.3;
  spec.solver.tolerance = 1e-6;
  const auto world = sliding_sled(subject, spec, {0.6, 0.8, 0});
  advance(*world, {}, 600);
  const double expected = 1 / (2 * 0.3 * kGravity);  // v^2 / (2 mu g): 0.34 s and 0.17 m
  const Vector3 way = world->state().p_WB;
  return {std::abs(way.head<2>().norm() / expected - 1),
          std::abs(std::atan2(way.y(), way.x()) - std::atan2(0.8, 0.6))};
}

std::vector<double> no_friction(const Subject& subject) {
  WorldSpec spec = scenes::world_of(scenes::sled());
  spec.contact.friction = 0;
  const auto world = subject.make(spec);
  RobotState moving = world->home_state();
  moving.v_WB = {0.6, 0.8, 0};
  world->reset(moving);
  advance(*world, {}, 500);
  return {std::abs(world->state().v_WB.head<2>().norm() - 1)};
}

std::vector<double> slip_speed(const Subject& subject) {
  const auto world = sliding_sled(subject, scenes::world_of(scenes::sled()), {0.3, -0.4, 0});
  advance(*world, {});
  double worst = 0;
  for (const Contact& c : world->contacts()) worst = std::max(worst, std::abs(c.slip_speed - 0.5));
  // At rest otherwise.
  const double allowed = 1e-9 + 100 * epsilon(subject.precision()) + residual_speed(subject.engine.info);
  return {worst / allowed, static_cast<double>(world->contacts().count)};
}

/// A ball of 5 cm on flat ground: what is left of a spin about the vertical, of 2 rad/s, or of rolling at
/// 0.5 m/s after 0.3 s, off what constant torsional and rolling friction leave.
std::vector<double> turning_friction(const Subject& subject) {
  constexpr double kRadius = 0.05, kTorsional = 0.0005, kRolling = 0.001, kSeconds = 0.3;
  WorldSpec spec = scenes::world_of(scenes::block(ShapeType::kSphere, {kRadius, 0, 0}));
  spec.contact.friction = 1;
  spec.contact.condim = 6;
  spec.contact.torsional_friction = kTorsional;
  spec.contact.rolling_friction = kRolling;
  spec.contact.impratio = 100;  // rolling does not creep into sliding
  const auto moved = [&](const Vector3& v, const Vector3& w) {
    const auto world = subject.make(spec);
    advance(*world, {}, 300);
    RobotState moving = world->state();
    moving.v_WB = v;
    moving.w_WB = w;
    world->reset(moving);
    advance(*world, {}, static_cast<int>(std::lround(kSeconds / spec.physics_dt)));
    return world->state();
  };
  const Body& body = spec.robot->bodies[0];
  const double m = body.inertia.mass, I = body.inertia.I_C(2, 2), weight = m * kGravity;
  const double spin = 2 - kTorsional * weight / I * kSeconds;
  // m v' = -f and I v' / r = f r - mu m g.
  const double speed = 0.5 - kRolling * weight / (m * kRadius + I / kRadius) * kSeconds;
  return {std::abs(moved(Vector3::Zero(), {0, 0, 2}).w_WB.z() / spin - 1),
          std::abs(moved({0.5, 0, 0}, {0, 0.5 / kRadius, 0}).v_WB.x() / speed - 1)};
}

std::vector<Requirement> cone_requirements() {
  return {at_most(1, "creeps a tenth inside the cone, over what the law allows", "",
                  "soft: 1.05 R f / B of the law; hard: 1e-5 m/s, the solver's tolerance, and "
                  "what the declared way of solving leaves"),
          at_most(1, "creeps in 0.3 s, over what the law allows", "", "the same"),
          at_most(0.01, "slides a tenth outside, off a t^2 / 2, relative", "",
                  "half a step late (0.3 %), and a soft contact hops under way"),
          at_most(0.01, "range over eight headings, relative", "", "the same"),
          at_most(1e-3, "off the line of fall, share of the way", "", "friction opposes slip")};
}

}  // namespace

std::vector<Check> friction_checks() {
  const std::string left = "1e-5 m/s, the solver's tolerance, and what the declared way of solving leaves";
  return {
      {"friction_cone_plane", "Coulomb's cone, not a pyramid, on the plane under tilted gravity",
       cone_requirements(),
       [](const Subject& subject) { return friction_cone(subject, scenes::tilted_gravity); }},
      {"friction_cone_field", "The same on a height field: normals and tangents of its triangles",
       cone_requirements(),
       [](const Subject& subject) { return friction_cone(subject, scenes::inclined_field); }},
      {"soft_friction",
       "Soft friction creeps by R f / B, and R is impratio times smaller than the normal's",
       {at_least(1e-4, "creeps", "m/s", "a tenth of what the law says: it is there"),
        between(9.8, 10.2, "creep over that of impratio 10", "",
                "loads shift a little between the runners uphill and downhill")},
       soft_friction,
       {"Capabilities::soft_contact", is_soft}},
      {"hard_friction",
       "Hard friction does not creep, whatever impratio is",
       {at_most(1, "creeps, over what is declared", "", left),
        at_most(1, "creeps with impratio 10, over what is declared", "", "the same")},
       hard_friction,
       {"not Capabilities::soft_contact", [](const Subject& subject) { return !is_soft(subject); }}},
      {"turning_friction",
       "Torsional and rolling friction take their lengths times m g of a ball's turning",
       {at_most(0.01, "spin left, relative", "", "friction of all kinds shares one cone: 1e-4, and creep"),
        at_most(0.01, "speed left, relative", "", "the same")},
       turning_friction,
       {"Capabilities::turning_friction",
        [](const Subject& subject) { return subject.engine.info.capabilities.turning_friction; }}},
      {"sled_stops",
       "Friction takes mu m g of a sliding body, against its motion",
       {at_most(0.01, "way, off v^2 / (2 mu g), relative", "", "v h / 2 late, and a soft contact's hopping"),
        at_most(1e-3, "direction, off", "rad", "friction opposes slip")},
       sled_stops},
      {"no_friction",
       "Without friction nothing brakes",
       {at_most(1e-4, "speed lost of 1 m/s in 0.5 s", "m/s", "MuJoCo's least coefficient, 1e-5, takes 5e-5")},
       no_friction},
      {"slip_speed",
       "slip_speed is that of the body at the point before the step",
       {at_most(1, "off the sled's 0.5 m/s, over what is declared", "",
                "at rest otherwise, to 1e-9 m/s, rounding and what the declared way of solving leaves"),
        at_least(3, "contacts", "", "three runners at least carry it")},
       slip_speed},
  };
}

}  // namespace crossgait::conformance
