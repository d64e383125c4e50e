#include "tests/parity/planted_faults.h"

#include <cmath>
#include <memory>

#include "motion/gait_source.h"

namespace crossgait {
namespace {

constexpr std::size_t kBody = 5;  // any but the base
constexpr int kJoint = 4;         // that it hangs on
const char* const kBodyName = "body FL_lower_right";
const char* const kJointName = "joint FL_elbow_right";

Joint& joint(RobotDescription& robot, int i) { return robot.bodies[static_cast<std::size_t>(i) + 1].joint; }

// The same corner heights with cells split along the other diagonal: four cells for each, whose middle takes
// the mean of that diagonal's ends.
void split_the_other_way(WorldSpec& spec) {
  const HeightField& old = *spec.terrain.field();
  const int columns = 2 * old.columns() - 1, rows = 2 * old.rows() - 1;
  std::vector<float> heights;
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      const int c0 = c / 2, r0 = r / 2, c1 = (c + 1) / 2, r1 = (r + 1) / 2;
      // On a node all four are one; on an edge two and two; in the middle: right front and left back.
      heights.push_back(static_cast<float>((old.at(c1, r0) + old.at(c0, r1)) / 2));
    }
  }
  spec.terrain = Terrain(spec.terrain.name(), std::make_shared<const HeightField>(columns, rows, old.size_x(),
                                                                                  old.size_y(), heights));
}

}  // namespace

std::function<void(WorldSpec&)> of_robot(std::function<void(RobotDescription&)> change) {
  return [change = std::move(change)](WorldSpec& spec) {
    auto robot = std::make_shared<RobotDescription>(*spec.robot);
    change(*robot);
    spec.robot = std::move(robot);
  };
}

std::vector<TinyFault> tiny_faults() {
  const auto of_body = [](void (*change)(Body&, double)) {
    return [change](WorldSpec& spec, double size) {
      of_robot([=](RobotDescription& robot) { change(robot.bodies[kBody], size); })(spec);
    };
  };
  return {
      {"time step", 1e-6, [](WorldSpec& spec, double size) { spec.physics_dt *= 1 + size; }},
      {"mass", 1e-6, of_body([](Body& body, double size) { body.inertia.mass *= 1 + size; })},
      {"centre of mass", 1e-8, of_body([](Body& body, double size) { body.inertia.p_BC.x() += size; })},
      {"inertia", 1e-6, of_body([](Body& body, double size) { body.inertia.I_C *= 1 + size; })},
      {"link placement", 1e-7,  // of a leg as a whole: its loop stays closed
       [](WorldSpec& spec, double size) {
         of_robot([=](RobotDescription& robot) { robot.bodies[1].X_PB.translation().x() += size; })(spec);
       }},
  };
}

std::vector<PlantedFault> planted_faults() {
  using R = RobotDescription;
  return {
      {"time step 2 % long", [](WorldSpec& s) { s.physics_dt *= 1.02; }, "time step", ""},
      {"mass of one link +2 %", of_robot([](R& r) { r.bodies[kBody].inertia.mass *= 1.02; }), "mass",
       kBodyName},
      {"centre of mass off by .5 mm", of_robot([](R& r) { r.bodies[kBody].inertia.p_BC.x() += 5e-4; }),
       "centre of mass", kBodyName},
      {"inertia of the trunk +2 %", of_robot([](R& r) { r.bodies[0].inertia.I_C *= 1.02; }), "inertia",
       "body trunk"},
      {"one joint .5 mm off", of_robot([](R& r) { r.bodies[1].X_PB.translation().x() += 5e-4; }),
       "link placement", "body FL_tilt_link"},
      {"sign of one axis", of_robot([](R& r) {
         joint(r, kJoint).axis *= -1;
         r.home[kJoint] *= -1;
       }),
       "joint axis", kJointName},
      {"armature of one joint +2 %", of_robot([](R& r) { joint(r, 0).armature *= 1.02; }), "armature",
       "joint FL_tilt"},
      {"gravity of the equator", [](WorldSpec& s) { s.gravity.z() = -9.78; }, "gravity", "axis z"},
      {"servo stiffness of one joint +2 %", of_robot([](R& r) { joint(r, 0).kp *= 1.02; }), "servo stiffness",
       "joint FL_tilt"},
      {"servo damping of one joint +1e-4", of_robot([](R& r) { joint(r, 0).kd += 1e-4; }), "servo damping",
       "joint FL_tilt"},
      {"effort limit of one joint -2 %", of_robot([](R& r) { joint(r, 0).effort_limit *= 0.98; }),
       "effort limit", "joint FL_tilt"},
      {"damping of one elbow +2 %", of_robot([](R& r) { joint(r, kJoint).damping *= 1.02; }), "joint damping",
       kJointName},
      {"dry friction of .01 N m in one elbow", of_robot([](R& r) { joint(r, kJoint).friction = 0.01; }),
       "joint friction", kJointName},
      {"one foot .2 mm larger", of_robot([](R& r) {
         LegModel& leg = (*r.legs)[Leg::RR];
         for (CollisionShape& shape : r.bodies[static_cast<std::size_t>(leg.foot_body)].shapes) {
           if (shape.type == ShapeType::kSphere && shape.X_BG.translation().isApprox(leg.p_BF, 1e-9))
             shape.size.x() += 2e-4;
         }
         leg.foot_radius += 2e-4;
       }),
       "foot radius", "foot RR"},
      {"corners of the trunk .1 mm larger", of_robot([](R& r) {
         for (CollisionShape& shape : r.bodies[0].shapes) shape.size.x() += 1e-4;
       }),
       "collision shape", "body trunk"},
      {"friction .6 -> .58", [](WorldSpec& s) { s.contact.friction = 0.58; }, "friction", "foot "},
      {"field split along the other diagonal", split_the_other_way, "diagonal of the height field", "(",
       "rough:seed=1,size_x=2,size_y=2"},
      {"ground 1 mm higher on one corner",
       [](WorldSpec& s) {
         const HeightField& old = *s.terrain.field();
         std::vector<float> heights(old.heights().begin(), old.heights().end());
         heights[static_cast<std::size_t>(old.columns() * (old.rows() / 2) + old.columns() / 2)] += 1e-3F;
         s.terrain = Terrain("raised", std::make_shared<const HeightField>(
                                           old.columns(), old.rows(), old.size_x(), old.size_y(), heights));
       },
       "height of the ground", "(", "rough:seed=1,size_x=0.8,size_y=0.8"},
      {"loops twice as soft", of_robot([](R& r) { r.loop_softness.time_constant *= 2; }), "motion in the air",
       "", "flat", true},
  };
}

LegArray<Vector3> standing_feet(const std::string& gait, const RobotDescription& robot) {
  GaitGenerator generator(find_gait(gait), find_gait(gait).preferred, leg_origins(robot));
  generator.reset(GaitGenerator::Start::kStanding);
  return target_positions(generator.update(0));
}

ControllerPtr careful_crawl(const WorldSpec& world) {
  constexpr double kCycle = 2.4, kSwing = 0.12, kStep = 0.03, kLift = 0.03, kLean = 0.03;  // s, -, m, m, m
  const LegArray<Vector3> rest = standing_feet("walk", *world.robot);
  const auto clock = std::make_shared<double>(0);
  const auto smooth = [](double s) { return (1 - std::cos(M_PI * s)) / 2; };
  const auto feet_after = [=](double dt) {
    *clock += dt;
    const double grown = smooth(std::min(1.0, *clock));
    // Feet are lifted in turn around the body, FL, RL, RR, FR; the body leans away from the one in the air.
    const double turn = 2 * M_PI * (*clock / kCycle - kSwing / 2) + M_PI / 4;
    const Vector3 lean = -kLean * grown * Vector3(std::cos(turn), std::sin(turn), 0);
    LegArray<Vector3> feet;
    for (const Leg leg : kLegs) {
      constexpr std::array<double, kLegCount> kStart{0, 0.75, 0.25, 0.5};
      const double phase = *clock / kCycle - kStart[static_cast<std::size_t>(leg)];
      const double p = phase - std::floor(phase);
      const bool swings = p < kSwing;
      const double s = swings ? smooth(p / kSwing) - 0.5 : 0.5 - (p - kSwing) / (1 - kSwing);
      const double up = swings ? std::sin(M_PI * p / kSwing) : 0;
      feet[leg] = rest[leg] + grown * Vector3(kStep * s, 0, kLift * up) - lean;
    }
    return feet;
  };
  return make_feet_controller(feet_after, world);
}

}  // namespace crossgait
