#include "backends/mujoco/simulation.h"

#include <algorithm>
#include <utility>

#include "backends/mujoco/model_xml.h"
#include "physics/robot/actuator.h"

namespace crossgait::mujoco {
namespace {

// After MuJoCo has its inverse weights, which it has without what dampers add.
void set_armatures(mjModel& model, const WorldSpec& spec) {
  for (int i = 0; i < spec.robot->joint_count(); ++i) {
    const int joint = mj_name2id(&model, mjOBJ_JOINT, joint_name(i).c_str());
    model.dof_armature[model.jnt_dofadr[joint]] = step_armature(spec.robot->joint(i), spec.physics_dt);
  }
}

}  // namespace

KeptState::KeptState(const mjModel& model)
    : nq_(static_cast<std::size_t>(model.nq)),
      nv_(static_cast<std::size_t>(model.nv)),
      numbers_(nq_ + 2 * nv_ + 8) {}

void KeptState::clear(const mjModel& model, const mjtNum* position, const mjtNum* attitude) {
  std::fill(numbers_.begin(), numbers_.end(), 0.0);
  std::copy_n(model.qpos0, nq_, numbers_.begin());
  std::copy_n(position, 3, base_position());
  std::copy_n(attitude, 4, base_attitude());
}

void KeptState::set(const std::vector<double>& numbers) noexcept {
  std::copy_n(numbers.begin(), numbers_.size(), numbers_.begin());
}

Simulation::Simulation(ModelPtr model, const WorldSpec& spec, const Terrain& terrain)
    : model_(std::move(model)), collision_(*spec.robot, spec.fixed_base, terrain) {
  collision_.set_model(*model_, *spec.robot);
  in_mujoco(who(), [this] { data_.reset(mj_makeData(model_.get())); });
}

mjData& Simulation::query() {
  if (query_ == nullptr) {
    in_mujoco(who(), [this] {
      query_ = make_data_without_rows(*model_);
      mj_kinematics(model_.get(), query_.get());  // where the ground is
    });
  }
  return *query_;
}

void Simulation::load(const Occupant& who_is, const KeptState& state, int base_body) noexcept {
  if (occupant_ == who_is) return;
  if (spoilt_) {
    try_in_mujoco(who(), [this] { mj_resetData(model_.get(), data_.get()); });
    spoilt_ = false;
  }
  mjModel& m = *model_;
  mjData& d = *data_;
  std::copy_n(state.qpos(), m.nq, d.qpos);
  std::copy_n(state.qvel(), m.nv, d.qvel);
  std::copy_n(state.warmstart(), m.nv, d.qacc_warmstart);
  std::copy_n(state.base_position(), 3, m.body_pos + 3 * base_body);
  std::copy_n(state.base_attitude(), 4, m.body_quat + 4 * base_body);
  d.time = state.time();
  occupant_ = who_is;
}

void Simulation::store(const Occupant& now, KeptState& state) noexcept {
  const mjData& d = *data_;
  std::copy_n(d.qpos, model_->nq, state.qpos());
  std::copy_n(d.qvel, model_->nv, state.qvel());
  std::copy_n(d.qacc_warmstart, model_->nv, state.warmstart());
  state.time() = d.time;
  occupant_ = now;
}

Simulations::Simulations(const WorldSpec& spec, std::string xml, std::size_t threads)
    : spec_(spec), xml_(std::move(xml)) {
  spec_.group = nullptr;  // which owns this
  install_terrain_collision();
  ModelPtr model = compile_model(spec_, xml_);
  set_armatures(*model, spec_);
  positions_.assign(model->body_pos, model->body_pos + 3 * model->nbody);
  attitudes_.assign(model->body_quat, model->body_quat + 4 * model->nbody);
  for (std::size_t i = 1; i < threads; ++i) {
    ModelPtr copy;
    in_mujoco({model.get(), nullptr}, [&] { copy.reset(mj_copyModel(nullptr, model.get())); });
    all_.push_back(std::make_unique<Simulation>(std::move(copy), spec_, spec_.terrain));
  }
  all_.push_back(std::make_unique<Simulation>(std::move(model), spec_, spec_.terrain));
}

bool Simulations::are_of(const WorldSpec& spec, const std::string& xml) const {
  return spec.robot == spec_.robot && spec.terrain.field() == spec_.terrain.field() && xml == xml_;
}

std::shared_ptr<Simulations> Simulations::of(const WorldSpec& spec, const std::string& engine) {
  const std::string xml = model_xml(spec);
  const auto make = [&](std::size_t threads) {
    return std::shared_ptr<Simulations>(new Simulations(spec, xml, threads));
  };
  if (spec.group == nullptr) return make(1);
  const auto shared = spec.group->part<Simulations>(engine, [&] {
    auto made = make(spec.group->threads());
    made->group_ = spec.group.get();
    return made;
  });
  return shared->are_of(spec, xml) ? shared : make(1);
}

}  // namespace crossgait::mujoco
