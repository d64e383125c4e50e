// Every check fails in an engine that does something else than it was asked to: none passes whatever happens.
#include <functional>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "conformance/check.h"
#include "tests/support/conformance_check.h"
#include "tests/support/engine_test.h"

namespace crossgait::conformance {
namespace {

using Change = std::function<void(WorldSpec&)>;

/// The worlds of an engine are another than they were asked to be, and a check has to see it.
struct Planted {
  const char* check;
  Change change;
};

Change of_robot(const std::function<void(RobotDescription&)>& change) {
  return [change](WorldSpec& spec) {
    RobotDescription robot = *spec.robot;
    change(robot);
    spec.robot = std::make_shared<const RobotDescription>(robot);
  };
}

Change of_bodies(const std::function<void(Body&)>& change) {
  return of_robot([change](RobotDescription& robot) {
    for (Body& body : robot.bodies) change(body);
  });
}

Change of_couplings(const std::function<void(JointCoupling&)>& change) {
  return of_robot([change](RobotDescription& robot) {
    for (JointCoupling& coupling : robot.couplings) change(coupling);
  });
}

Change of_joints(double Joint::*member, double factor) {
  return of_bodies([=](Body& body) { body.joint.*member *= factor; });
}

Change of_limits(double factor) {
  return of_bodies([=](Body& body) {
    body.joint.lower *= factor;
    body.joint.upper *= factor;
  });
}

Change of_shapes(double factor) {
  return of_bodies([=](Body& body) {
    for (CollisionShape& shape : body.shapes) shape.size.x() *= factor;
  });
}

Change of_gravity(double factor) {
  return [=](WorldSpec& spec) { spec.gravity *= factor; };
}

Change of_friction(double factor) {
  return [=](WorldSpec& spec) { spec.contact.friction *= factor; };
}

/// Every other world is pulled a little harder: no two are alike.
Change of_every_other_world() {
  return [count = std::make_shared<int>(0)](WorldSpec& spec) {
    if (++*count % 2 == 0) spec.gravity *= 1 + 1e-3;
  };
}

Change of_ground(float by) {
  return [=](WorldSpec& spec) {
    const HeightField* field = spec.terrain.field();
    if (field == nullptr) return;
    std::vector<float> heights(field->heights().begin(), field->heights().end());
    for (float& h : heights) h += by;
    spec.terrain =
        Terrain("raised", std::make_shared<HeightField>(field->columns(), field->rows(), field->size_x(),
                                                        field->size_y(), heights));
  };
}

Change of_terrain(const char* terrain) {
  return [=](WorldSpec& spec) { spec.terrain = make_terrain(terrain); };
}

std::vector<Planted> of_model_and_motion() {
  const Change mass = of_bodies([](Body& body) { body.inertia.mass *= 1.01; });
  const Change damping = of_bodies([](Body& body) { body.joint.damping += 0.01; });
  const Change base = [](WorldSpec& spec) { spec.fixed_base = true; };
  return {
      {"mass_properties", mass},
      {"frames", of_bodies([](Body& body) { body.X_PB.translation().z() += 1e-4; })},
      {"reset_state", base},
      {"fixed_base", [](WorldSpec& spec) { spec.fixed_base = false; }},
      {"inertia", mass},
      {"gravity", of_gravity(1.01)},
      {"free_fall", of_gravity(1.01)},
      {"robot_falls_as_one", of_gravity(1.01)},
      {"tumbling", [](WorldSpec& spec) { spec.physics_dt *= 2; }},
      {"robot_in_the_air", [](WorldSpec& spec) { spec.gravity.z() = -0.1; }},
      {"push", mass},
      {"wrench", mass},
      {"pendulum_small_swings", of_joints(&Joint::armature, 1.01)},
      {"pendulum_large_swings", of_gravity(1.01)},
      {"armature", of_joints(&Joint::armature, 1.001)},
      {"joint_damping", damping},
      {"joint_damping_at_the_end", of_joints(&Joint::implicit_joint_damping, 0.99)},
      {"double_pendulum", damping},
      {"servo_step", of_joints(&Joint::kp, 1.02)},
      {"servo_load", of_joints(&Joint::kp, 1.02)},
      {"servo_limits", of_joints(&Joint::effort_limit, 0.999)},
      {"servo_substeps", of_every_other_world()},
      {"servo_no_load_speed", of_joints(&Joint::no_load_speed, 1.02)},
      {"rerun", of_every_other_world()},
      {"restore", of_every_other_world()},
      {"questions", of_every_other_world()},
      {"threads", of_every_other_world()},
      {"divergence", of_every_other_world()},
  };
}

std::vector<Planted> of_contact() {
  const Change loop_softness =
      of_robot([](RobotDescription& robot) { robot.loop_softness.time_constant *= 3; });
  return {
      {"ground_heights", of_ground(1e-4F)},
      {"ground_border", of_terrain("rough:seed=1,size_x=3,size_y=2")},
      {"level_field", of_ground(1e-4F)},
      {"home_above_ground", of_shapes(1.2)},
      {"friction_cone_plane", of_friction(1.15)},
      {"friction_cone_field", of_friction(1.15)},
      {"soft_friction", [](WorldSpec& spec) { spec.contact.impratio = 1; }},
      {"hard_friction", of_friction(0.3)},
      {"turning_friction", [](WorldSpec& spec) { spec.contact.rolling_friction *= 1.3; }},
      {"sled_stops", of_friction(1.15)},
      {"no_friction", [](WorldSpec& spec) { spec.contact.friction += 1e-3; }},
      {"slip_speed", of_terrain("slope:angle=10,size_x=4,size_y=4,cell=0.05,flat_radius=0")},
      {"standing", of_gravity(1.01)},
      // Soft contact gives way; rigid contact falls too deep in a step to be seen coming.
      {"penetration",
       [](WorldSpec& spec) {
         spec.contact.softness.time_constant = 0.08;
         spec.physics_dt *= 10;
         spec.gravity *= 300;
       }},
      {"error_reduction", [](WorldSpec& spec) { spec.contact.cfm += 1e-3; }},
      {"contact_geometry", of_shapes(1.001)},
      {"trotting", of_joints(&Joint::kp, 0.2)},
      {"no_contact", of_shapes(8)},
      {"contact_features", of_shapes(1.001)},
      {"deepest_contacts", of_bodies([](Body& body) { body.shapes.resize(1); })},
      {"loops_closed",
       [soft = of_robot([](RobotDescription& robot) { robot.loop_softness.time_constant = 0.1; })](
           WorldSpec& spec) {
         soft(spec);
         spec.physics_dt *= 10;  // by whose square rigid loops gape
       }},
      {"loop_softness",
       [loop_softness, count = std::make_shared<int>(0)](WorldSpec& spec) {
         if (++*count % 2 == 0) loop_softness(spec);
       }},
  };
}

std::vector<Planted> of_joint_rows_and_parity() {
  return {
      {"coupled_pendulums", of_couplings([](JointCoupling& c) { c.coefficients[1] *= 1.01; })},
      {"coupling_momentum", of_couplings([](JointCoupling& c) { c.coefficients[1] *= 1.01; })},
      {"coupling_softness", of_couplings([](JointCoupling& c) { c.softness.time_constant *= 1.1; })},
      {"joint_friction_pendulum", of_joints(&Joint::friction, 0.9)},
      {"joint_friction_coasting", of_joints(&Joint::friction, 0.9)},
      {"joint_friction_holding", of_joints(&Joint::friction, 0.9)},
      {"joint_friction_reported", of_joints(&Joint::friction, 0.9)},
      {"joint_friction_standing", of_bodies([](Body& body) {
         body.joint.friction *= 0.01;
         body.joint.damping = body.joint.kd = 0;  // nothing else brings it to rest
       })},
      {"joint_limit_rest", of_limits(0.99)},
      {"joint_limit_stop", of_limits(1.1)},
      {"joint_limit_return", of_bodies([](Body& body) { body.joint.limited = false; })},
      {"joint_limit_none", of_bodies([](Body& body) { body.joint.limited = true; })},
      {"joint_limits_reported", of_limits(1.001)},
      {"implicit_servo_recursion", of_joints(&Joint::kp, 1.02)},
      {"implicit_servo_stiff", of_bodies([](Body& body) { body.joint.implicit_stiffness = 0; })},
      {"implicit_servo_limits", of_joints(&Joint::effort_limit, 0.999)},
      {"implicit_servo_friction", of_joints(&Joint::friction, 0.9)},
      {"implicit_servo_standing", of_joints(&Joint::kp, 1.5)},
      {"model_audit", of_joints(&Joint::armature, 1.01)},
      {"same_swing", of_joints(&Joint::armature, 1.01)},
      {"same_trot_flat", of_joints(&Joint::armature, 1.01)},
      {"same_trot_rough", of_joints(&Joint::armature, 1.01)},
      {"same_sled", of_friction(1.01)},
      {"same_joint_friction", of_joints(&Joint::friction, 0.9)},
      {"same_couplings", of_couplings([](JointCoupling& c) { c.coefficients[1] *= 1.01; })},
      {"same_implicit_servos", of_joints(&Joint::armature, 1.01)},
      {"walks_as_far", [](WorldSpec& spec) { spec.contact.friction = 0.05; }},
  };
}

std::vector<Planted> planted_faults() {
  std::vector<Planted> all = of_model_and_motion();
  for (Planted& planted : of_contact()) all.push_back(std::move(planted));
  for (Planted& planted : of_joint_rows_and_parity()) all.push_back(std::move(planted));
  return all;
}

/// The first engine of a precision that declares what the check needs, with the fault; none if there is none.
std::optional<Subject> subject_for(const Check& check, const Change& fault, Precision precision) {
  for (const std::string& name : available_engines()) {
    Subject subject = subject_of(name);
    if (subject.precision() != precision) continue;
    if (check.precondition.is_met != nullptr && !check.precondition.is_met(subject)) continue;
    subject.engine = with_change(subject.engine, fault);
    return subject;
  }
  return std::nullopt;
}

class PlantedFault : public ::testing::TestWithParam<std::tuple<Planted, Precision>> {};
INSTANTIATE_TEST_SUITE_P(EveryCheck, PlantedFault,
                         ::testing::Combine(::testing::ValuesIn(planted_faults()),
                                            ::testing::Values(Precision::kFloat64, Precision::kFloat32)),
                         [](const auto& test) {
                           return fmt::format("{}_{}", std::get<0>(test.param).check,
                                              name_of(std::get<1>(test.param)));
                         });

TEST_P(PlantedFault, IsSeen) {
  const auto& [planted, precision] = GetParam();
  const Check& check = check_of(planted.check);
  const std::optional<Subject> subject = subject_for(check, planted.change, precision);
  if (!subject) GTEST_SKIP() << "no engine here: " << name_of(precision) << ", " << check.precondition.what;
  EXPECT_EQ(run_check(check, *subject).status, Status::kFailed) << subject->engine.name();
}

TEST(PlantedFaults, ThereIsOneForEveryCheckThatDemandsSomething) {
  std::set<std::string> planted;
  for (const Planted& fault : planted_faults()) planted.insert(fault.check);
  for (const Check& check : checks()) {
    const bool requirements =
        std::any_of(check.requirements.begin(), check.requirements.end(),
                    [](const Requirement& requirement) { return requirement.bound() != "reported"; });
    EXPECT_EQ(planted.contains(check.name), requirements) << check.name;
  }
}

}  // namespace
}  // namespace crossgait::conformance
