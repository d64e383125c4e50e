// Inside the MuJoCo world: the compiled model, and its collision routine.
#include "backends/mujoco/model.h"

#include <cmath>
#include <cstdio>
#include <vector>

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "backends/mujoco/model_xml.h"
#include "backends/mujoco/mujoco_backend.h"
#include "backends/mujoco/version.h"
#include "physics/engine/contact_features.h"
#include "physics/robot/multibody.h"
#include "scenes/scenes.h"

namespace crossgait::mujoco {
namespace {

int body_id(const mjModel& m, int body) { return mj_name2id(&m, mjOBJ_BODY, body_name(body).c_str()); }

TEST(MujocoModel, InverseWeightsAreThoseOfTheDescription) {
  double worst = 0;
  for (const bool fixed : {false, true}) {
    for (const scenes::RobotPtr& robot :
         {scenes::quadruped(), scenes::long_quadruped(), scenes::awkward_robot()}) {
      WorldSpec spec = scenes::world_of(robot);
      spec.fixed_base = fixed;
      const ModelPtr m = compile_model(spec);
      const std::vector<double> expected = translational_inverse_weights(*robot, fixed);
      for (int i = fixed ? 1 : 0; i <= robot->joint_count(); ++i) {
        const double weight = expected[static_cast<std::size_t>(i)];
        const double difference = std::abs(m->body_invweight0[2 * body_id(*m, i)] / weight - 1);
        worst = std::max(worst, difference);
        EXPECT_LT(difference, 1e-10) << robot->name << " body " << i;  // two factorisations of condition 1e5
      }
    }
  }
  std::printf("measured inverse weights, relative: %.3g\n", worst);
}

TEST(MujocoModel, InverseWeightsOfJointsAreThoseOfTheDescription) {
  for (const bool fixed : {false, true}) {
    for (const scenes::RobotPtr& robot :
         {scenes::quadruped(), scenes::long_quadruped(), scenes::awkward_robot()}) {
      WorldSpec spec = scenes::world_of(robot);
      spec.fixed_base = fixed;
      const ModelPtr m = compile_model(spec);
      const JointVector expected = joint_inverse_weights(*robot, fixed);
      for (int i = 0; i < robot->joint_count(); ++i) {
        const int dof = m->jnt_dofadr[mj_name2id(m.get(), mjOBJ_JOINT, joint_name(i).c_str())];
        EXPECT_NEAR(m->dof_invweight0[dof] / expected[i], 1, 1e-10) << robot->name << " joint " << i;
      }
    }
  }
}

TEST(MujocoModel, HoldsTheJointsDryFriction) {
  RobotDescription robot = *scenes::quadruped();
  robot.friction_softness = {0.03, 0.7, 0.5, 0.99, 0.01};
  for (int i = 0; i < robot.joint_count(); ++i)
    robot.bodies[static_cast<std::size_t>(i) + 1].joint.friction = 0.01 * i;
  const ModelPtr m = compile_model(scenes::world_of(std::make_shared<const RobotDescription>(robot)));
  for (int i = 0; i < robot.joint_count(); ++i) {
    const int dof = m->jnt_dofadr[mj_name2id(m.get(), mjOBJ_JOINT, joint_name(i).c_str())];
    EXPECT_EQ(m->dof_frictionloss[dof], 0.01 * i);
    EXPECT_EQ(m->dof_solref[mjNREF * dof], 0.03);
    EXPECT_EQ(m->dof_solref[mjNREF * dof + 1], 0.7);
    EXPECT_EQ(m->dof_solimp[mjNIMP * dof], 0.5);
    EXPECT_EQ(m->dof_solimp[mjNIMP * dof + 1], 0.99);
    EXPECT_EQ(m->dof_solimp[mjNIMP * dof + 2], 0.01);
  }
}

TEST(MujocoModel, DoesNothingOnItsOwn) {
  WorldSpec spec = scenes::world_of(scenes::quadruped());
  spec.physics_dt = 5e-4;
  spec.solver.tolerance = 1e-11;
  spec.contact.impratio = 3;
  const ModelPtr m = compile_model(spec);
  EXPECT_EQ(m->opt.timestep, 5e-4);
  EXPECT_EQ(m->opt.tolerance, solver_tolerance(1e-11));
  EXPECT_EQ(m->opt.impratio, 3);
  EXPECT_EQ(m->opt.gravity[2], -9.81);
  EXPECT_EQ(m->opt.integrator, mjINT_EULER);
  EXPECT_EQ(m->opt.solver, mjSOL_NEWTON);
  EXPECT_EQ(m->opt.cone, mjCONE_ELLIPTIC);
  EXPECT_EQ(m->nu, 0);  // torques come from the shared servo law
  EXPECT_EQ(m->nv, 26);
  EXPECT_EQ(m->neq, 4);
  for (int i = 0; i < m->nv; ++i) {
    EXPECT_EQ(m->dof_damping[i], 0);
    EXPECT_EQ(m->dof_frictionloss[i], 0);
  }
  for (int i = 0; i < m->njnt; ++i) {
    EXPECT_EQ(m->jnt_limited[i], m->jnt_type[i] == mjJNT_HINGE);  // its URDF limits all of them
    EXPECT_EQ(m->jnt_stiffness[i], 0);
  }
  EXPECT_NEAR(mj_getTotalmass(m.get()), spec.robot->total_mass(), 1e-15);
}

TEST(MujocoModel, AShapeHasAsManyCopiesAsItsContactsNeed) {
  const auto last_part = [](ShapeType type, const Vector3& size, std::vector<Vector3> vertices = {}) {
    CollisionShape shape;
    shape.type = type;
    shape.size = size;
    shape.vertices = std::move(vertices);
    return part_of(shape, feature_count(shape) - 1);
  };
  EXPECT_EQ(last_part(ShapeType::kSphere, {0.1, 0, 0}), 0);
  EXPECT_EQ(last_part(ShapeType::kBox, {0.1, 0.1, 0.1}), 7 / kMaxPlaneContacts);
  EXPECT_EQ(last_part(ShapeType::kCapsule, {0.1, 0.1, 0}), 1 / kMaxPlaneContacts);
  // Up to three contacts of a rim.
  EXPECT_EQ(last_part(ShapeType::kCylinder, {0.1, 0.1, 0}), 1 / (kMaxPlaneContacts / 3));
  EXPECT_EQ(
      last_part(ShapeType::kHull, Vector3::Zero(), std::vector<Vector3>(kMaxHullVertices, Vector3::Zero())),
      (kMaxHullVertices - 1) / kMaxPlaneContacts);
}

TEST(MujocoModel, ShapesCollideWithTheTerrainAlone) {
  const ModelPtr m = compile_model(scenes::world_of(scenes::quadruped()));
  const int terrain = mj_name2id(m.get(), mjOBJ_GEOM, "terrain");
  const auto collide = [&](int a, int b) {
    return (m->geom_contype[a] & m->geom_conaffinity[b]) != 0 ||
           (m->geom_contype[b] & m->geom_conaffinity[a]) != 0;
  };
  ASSERT_GT(m->ngeom, 10);
  for (int a = 0; a < m->ngeom; ++a) {
    for (int b = 0; b < a; ++b) EXPECT_EQ(collide(a, b), a == terrain || b == terrain);
  }
}

TEST(MujocoCollision, GivesOneContactPerSphereOnLevelGround) {
  WorldSpec spec = scenes::world_of(scenes::quadruped());
  spec.terrain = make_terrain("slope:angle=0,size_x=2,size_y=2");
  const auto world = engine().make(spec);
  ASSERT_EQ(world->step(scenes::home_targets(world->robot()), 500), StepStatus::kOk);
  EXPECT_EQ(world->contacts().count, 4);
}

}  // namespace
}  // namespace crossgait::mujoco
