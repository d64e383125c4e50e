// Inside the MuJoCo backend: the compiled model, and the collision routine that it installs for the whole
// process.
#include "crossgait/backends/mujoco/model.h"

#include <array>
#include <cstring>
#include <memory>
#include <string>

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "crossgait/backends/mujoco/model_xml.h"
#include "crossgait/backends/mujoco/mujoco_backend.h"
#include "crossgait/benchmarks/scenes.h"
#include "crossgait/physics/multibody.h"

namespace crossgait::mujoco {
namespace {

/// A model that is not Crossgait's.
ModelPtr compile(const std::string& xml) {
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  mj_makeEmptyFileVFS(files.get(), "model.xml", static_cast<int>(xml.size()));
  std::memcpy(files->filedata[0], xml.data(), xml.size());
  std::array<char, 1000> error{};
  ModelPtr model(mj_loadXML("model.xml", files.get(), error.data(), static_cast<int>(error.size())));
  mj_deleteVFS(files.get());
  EXPECT_NE(model, nullptr) << error.data();
  return model;
}

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

TEST(MujocoModel, DoesNothingOnItsOwn) {
  WorldSpec spec = scenes::world_of(scenes::quadruped());
  spec.physics_dt = 5e-4;
  spec.solver.tolerance = 1e-11;
  spec.contact.impratio = 3;
  const ModelPtr m = compile_model(spec);
  EXPECT_EQ(m->opt.timestep, 5e-4);
  EXPECT_EQ(m->opt.tolerance, 1e-11);
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
    EXPECT_EQ(m->jnt_limited[i], 0);
    EXPECT_EQ(m->jnt_stiffness[i], 0);
  }
  EXPECT_NEAR(mj_getTotalmass(m.get()), spec.robot->total_mass(), 1e-15);
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

/// A model of somebody else: a sphere sunk into a height field, with or without a place for user data.
ModelPtr foreign_model(int nuserdata) {
  ModelPtr m = compile("<mujoco><size nuserdata='" + std::to_string(nuserdata) +
                       "'/><asset><hfield name='h' nrow='5' ncol='5' size='1 1 0.1 0.1'/></asset><worldbody>"
                       "<geom type='hfield' hfield='h'/><body pos='0.13 0.07 0.05'><freejoint/><geom "
                       "type='sphere' size='0.1'/></body>"
                       "</worldbody></mujoco>");
  for (int i = 0; i < 25; ++i) m->hfield_data[i] = static_cast<float>((i * 7) % 5) / 5;
  return m;
}

std::vector<double> contacts_of(const mjModel& m) {
  const DataPtr d(mj_makeData(&m));
  mj_forward(&m, d.get());
  std::vector<double> result;
  for (int i = 0; i < d->ncon; ++i) {
    result.push_back(d->contact[i].dist);
    result.insert(result.end(), d->contact[i].pos, d->contact[i].pos + 3);
    result.insert(result.end(), d->contact[i].frame, d->contact[i].frame + 9);
  }
  return result;
}

TEST(MujocoCollision, LeavesOtherModelsAlone) {
  // Of the same name as in this process before any backend was made; later tests find it replaced already.
  const ModelPtr plain = foreign_model(0), with_data = foreign_model(1);
  const std::vector<double> before = contacts_of(*plain);
  ASSERT_GT(before.size(), 12U);  // several contacts, where Crossgait's routine gives one
  engine().make(scenes::world_of(scenes::sled()));
  EXPECT_NE(mjCOLLISIONFUNC[mjGEOM_HFIELD][mjGEOM_SPHERE], nullptr);
  EXPECT_EQ(contacts_of(*plain), before);
  EXPECT_EQ(contacts_of(*with_data), before);  // user data that nobody set
}

TEST(MujocoCollision, GivesOneContactPerSphereOnLevelGround) {
  WorldSpec spec = scenes::world_of(scenes::quadruped());
  spec.terrain = make_terrain("slope:angle=0,size_x=2,size_y=2");
  const auto backend = engine().make(spec);
  ASSERT_EQ(backend->step(scenes::home_targets(backend->robot()), 500), StepStatus::kOk);
  EXPECT_EQ(backend->contacts().count, 4);
}

}  // namespace
}  // namespace crossgait::mujoco
