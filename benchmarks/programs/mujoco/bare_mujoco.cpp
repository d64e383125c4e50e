#include "benchmarks/programs/mujoco/bare_mujoco.h"

#include <array>

#include <mujoco/mujoco.h>

#include "backends/mujoco/model.h"
#include "backends/mujoco/model_xml.h"

namespace crossgait {

struct BareMujoco::Engine {
  mujoco::ModelPtr m;
  mujoco::DataPtr d;
  std::vector<int> q, v;  // addresses by joint of the description
  Vector3 p_BC;           // where MuJoCo's base body sits in ours
};

BareMujoco::BareMujoco(const WorldSpec& spec) : engine_(std::make_unique<Engine>()) {
  engine_->m = mujoco::compile_model(spec);
  engine_->d.reset(mj_makeData(engine_->m.get()));
  engine_->p_BC = spec.robot->bodies[0].inertia.p_BC;
  for (int i = 0; i < spec.robot->joint_count(); ++i) {
    const int joint = mj_name2id(engine_->m.get(), mjOBJ_JOINT, mujoco::joint_name(i).c_str());
    engine_->q.push_back(engine_->m->jnt_qposadr[joint]);
    engine_->v.push_back(engine_->m->jnt_dofadr[joint]);
  }
}

BareMujoco::~BareMujoco() = default;

void BareMujoco::replay(const RobotState& state, const std::vector<JointVector>& torques) {
  mjModel* m = engine_->m.get();
  mjData* d = engine_->d.get();
  mj_resetData(m, d);
  const Vector3 p_WC = state.p_WB + state.q_WB * engine_->p_BC;
  mju_copy3(d->qpos, p_WC.data());
  const std::array<mjtNum, 4> q{state.q_WB.w(), state.q_WB.x(), state.q_WB.y(), state.q_WB.z()};
  mju_copy4(d->qpos + 3, q.data());
  for (std::size_t i = 0; i < engine_->q.size(); ++i)
    d->qpos[engine_->q[i]] = state.q[static_cast<Eigen::Index>(i)];
  for (const JointVector& tau : torques) {
    for (std::size_t i = 0; i < engine_->v.size(); ++i) {
      d->qfrc_applied[engine_->v[i]] = tau[static_cast<Eigen::Index>(i)];
    }
    mj_step(m, d);
  }
}

Vector3 BareMujoco::position() const {
  const mjtNum* p = engine_->d->qpos;
  return Vector3(p[0], p[1], p[2]) - Quaternion(p[3], p[4], p[5], p[6]) * engine_->p_BC;
}

}  // namespace crossgait
