#include "crossgait/benchmarks/mujoco/bare_mujoco.h"

#include <array>
#include <stdexcept>

#include <mujoco/mujoco.h>

#include "crossgait/backends/mujoco/model_xml.h"

namespace crossgait {

struct BareMujoco::Engine {
  mjModel* m = nullptr;
  mjData* d = nullptr;
  std::vector<int> q, v;  // addresses by joint of the description
  ~Engine() {
    mj_deleteData(d);
    mj_deleteModel(m);
  }
};

BareMujoco::BareMujoco(const WorldSpec& spec) : engine_(std::make_unique<Engine>()) {
  const std::string xml = mujoco::model_xml(spec);
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  mj_makeEmptyFileVFS(files.get(), "model.xml", static_cast<int>(xml.size()));
  xml.copy(static_cast<char*>(files->filedata[0]), xml.size());
  std::array<char, 1000> error{};
  engine_->m = mj_loadXML("model.xml", files.get(), error.data(), static_cast<int>(error.size()));
  mj_deleteVFS(files.get());
  if (engine_->m == nullptr) throw std::runtime_error(error.data());
  const RobotDescription& robot = *spec.robot;
  for (std::size_t i = 0; i < robot.loops.size(); ++i) {
    mju_copy3(engine_->m->eq_data + i * mjNEQDATA, robot.loops[i].p_AP.data());
    mju_copy3(engine_->m->eq_data + i * mjNEQDATA + 3, robot.loops[i].p_BP.data());
  }
  engine_->d = mj_makeData(engine_->m);
  for (int i = 0; i < robot.joint_count(); ++i) {
    const int joint = mj_name2id(engine_->m, mjOBJ_JOINT, mujoco::joint_name(i).c_str());
    engine_->q.push_back(engine_->m->jnt_qposadr[joint]);
    engine_->v.push_back(engine_->m->jnt_dofadr[joint]);
  }
}

BareMujoco::~BareMujoco() = default;

void BareMujoco::replay(const RobotState& state, const std::vector<JointVector>& torques) {
  mjModel* m = engine_->m;
  mjData* d = engine_->d;
  mj_resetData(m, d);
  mju_copy3(d->qpos, state.p_WB.data());
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
  return {p[0], p[1], p[2]};
}

}  // namespace crossgait
