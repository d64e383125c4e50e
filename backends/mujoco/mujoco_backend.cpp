#include "backends/mujoco/mujoco_backend.h"

#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>

#include <mujoco/mujoco.h>

#include "backends/mujoco/convert.h"
#include "backends/mujoco/model_xml.h"
#include "backends/mujoco/simulation.h"
#include "backends/mujoco/version.h"
#include "physics/robot/actuator.h"
#include "physics/robot/principal_inertia.h"

namespace crossgait::mujoco {
namespace {

Quaternion quaternion(const mjtNum* q) { return {q[0], q[1], q[2], q[3]}; }

struct ShapeOwner {
  int body = -1, leg = -1;
};

EngineInfo make_info(bool loop_bias) {
  const bool without = kHasLoopBias && !loop_bias;
  return {CROSSGAIT_ENGINE_NAME + std::string(without ? "-loop_bias" : ""),
          "MuJoCo",
          mj_versionString(),
          "soft contact, elliptic cones, Newton",
          {.contact = "mujoco",
           .loops = kHasLoopBias && loop_bias ? "mujoco with velocity bias" : "mujoco",
           .joint_friction = "mujoco",
           .joint_limits = "mujoco",
           .couplings = "mujoco",
           .implicit_servos = "implicit",
           .contact_family = "compliant"},
          {.soft_contact = true,
           .soft_friction = true,
           .turning_friction = true,
           .pyramidal_cone = true,
           .exact_field_query = true},
          {}};
}

/// The loops' rows as MuJoCo had them before it knew J' v: a_ref = -b v - k d(r) r.
void take_loop_bias_away(mjData& d) noexcept {
  for (int i = 0; i < d.ne; ++i) {
    const mjtNum* const kbip = d.efc_KBIP + 4 * i;  // stiffness, damping, impedance
    d.efc_aref[i] = -kbip[1] * d.efc_vel[i] - kbip[0] * kbip[2] * (d.efc_pos[i] - d.efc_margin[i]);
  }
}

class MujocoBackend final : public PhysicsBackend {
 public:
  /// @param loop_bias  see kHasLoopBias
  MujocoBackend(const WorldSpec& world, bool loop_bias)
      : PhysicsBackend(world),
        takes_bias_away_(kHasLoopBias && !loop_bias),
        group_(world.group),
        simulations_(Simulations::of(world, the_info(!takes_bias_away_).name)),
        kept_(simulations_->model()) {
    index_elements();
    reset();
  }

  static const EngineInfo& the_info(bool loop_bias) {
    static const EngineInfo kWith = make_info(true), kWithout = make_info(false);
    return loop_bias ? kWith : kWithout;
  }
  const EngineInfo& info() const override { return the_info(!takes_bias_away_); }

 private:
  void index_elements() {
    const mjModel& m = simulations_->model();
    owners_.resize(static_cast<std::size_t>(m.ngeom));
    bodies_.resize(robot().bodies.size());
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      bodies_[b] = mj_name2id(&m, mjOBJ_BODY, body_name(static_cast<int>(b)).c_str());
      for (std::size_t k = 0; k < robot().bodies[b].shapes.size(); ++k) {
        const int body = static_cast<int>(b), shape = static_cast<int>(k);
        for (int part = 0;; ++part) {
          const int geom = mj_name2id(&m, mjOBJ_GEOM, shape_name(body, shape, part).c_str());
          if (geom < 0) break;
          owners_[static_cast<std::size_t>(geom)] = {body, leg_of_shape(robot(), body, shape)};
        }
      }
    }
    // MuJoCo orders joints depth first, the description leg by leg.
    for (int i = 0; i < robot().joint_count(); ++i) {
      const int joint = mj_name2id(&m, mjOBJ_JOINT, joint_name(i).c_str());
      q_address_.push_back(m.jnt_qposadr[joint]);
      v_address_.push_back(m.jnt_dofadr[joint]);
      servo_tendons_.push_back(mj_name2id(&m, mjOBJ_TENDON, servo_name(i).c_str()));
    }
    servo_accelerations_.resize(static_cast<std::size_t>(m.ntendon));
    terrain_geom_ = mj_name2id(&m, mjOBJ_GEOM, "terrain");
    base_body_ = bodies_[0];
  }

  /// Returns this thread's simulation with the state of this world in it.
  Simulation& loaded() const noexcept {
    Simulation& simulation = simulations_->here();
    simulation.load({id_, revision_}, kept_, base_body_);
    return simulation;
  }

  /// Where MuJoCo's base body sits in ours.
  const Vector3& base_origin() const noexcept { return robot().bodies[0].inertia.p_BC; }

  void do_reset(const RobotState& state) override {
    kept_.clear(simulations_->model(), simulations_->position(base_body_),
                simulations_->attitude(base_body_));
    ++revision_;
    kept_.time() = state.time;
    const Quaternion q = state.q_WB.normalized();
    const std::array<mjtNum, 4> wxyz{q.w(), q.x(), q.y(), q.z()};
    const Vector3 p_BC_W = q * base_origin();
    const Vector3 p_WC = state.p_WB + p_BC_W;
    mjtNum* const qpos = kept_.qpos();
    mjtNum* const qvel = kept_.qvel();
    if (spec().fixed_base) {
      mju_copy3(kept_.base_position(), p_WC.data());
      mju_copy4(kept_.base_attitude(), wxyz.data());
    } else {
      const Vector3 w_B = q.conjugate() * state.w_WB;  // a free joint's angular velocity is in the body frame
      const Vector3 v_WC = state.v_WB + state.w_WB.cross(p_BC_W);
      mju_copy3(qpos, p_WC.data());
      mju_copy4(qpos + 3, wxyz.data());
      mju_copy3(qvel, v_WC.data());
      mju_copy3(qvel + 3, w_B.data());
    }
    for (std::size_t i = 0; i < q_address_.size(); ++i) {
      qpos[q_address_[i]] = state.q[static_cast<Eigen::Index>(i)];
      qvel[v_address_[i]] = state.qd[static_cast<Eigen::Index>(i)];
    }
  }

  void step_once(mjModel& m, mjData& d) noexcept {
    if (!takes_bias_away_ && servo_accelerations_.empty()) {
      mj_step(&m, &d);
      return;
    }
    mj_step1(&m, &d);
    if (takes_bias_away_) take_loop_bias_away(d);
    refer_to_servos(d);
    mj_step2(&m, &d);
  }

  // A row of friction gives  clamp(-(a - a_ref) / R, +-loss): with R = 1 / inertia and the bounds' middle
  // applied beside it, an implicit servo's torque.
  void set_servo_rows(mjModel& m, mjData& d) noexcept {
    mju_zero(m.tendon_frictionloss, m.ntendon);
    for (const ImplicitServo& servo : implicit_servos()) {
      const auto joint = static_cast<std::size_t>(servo.joint);
      const int row = servo_tendons_[joint];
      const double middle = (servo.lower + servo.upper) / 2;
      m.tendon_frictionloss[row] = (servo.upper - servo.lower) / 2;
      m.tendon_invweight0[row] = 1 / servo.inertia;
      servo_accelerations_[static_cast<std::size_t>(row)] = (servo.torque - middle) / servo.inertia;
      d.qfrc_applied[v_address_[joint]] += middle;
    }
  }

  // MuJoCo's own reference acceleration damps the row.
  void refer_to_servos(mjData& d) noexcept {
    for (int i = d.ne; i < d.ne + d.nf; ++i) {
      if (d.efc_type[i] == mjCNSTR_FRICTION_TENDON)
        d.efc_aref[i] = servo_accelerations_[static_cast<std::size_t>(d.efc_id[i])];
    }
  }

  StepStatus do_step(const JointVector& tau, const Wrench& base) noexcept override {
    Simulation& simulation = loaded();
    mjModel& m = simulation.model();
    mjData& d = simulation.data();
    for (std::size_t i = 0; i < v_address_.size(); ++i) {
      d.qfrc_applied[v_address_[i]] = tau[static_cast<Eigen::Index>(i)];
    }
    set_servo_rows(m, d);
    mju_copy3(d.xfrc_applied + 6 * base_body_, base.force.data());
    mju_copy3(d.xfrc_applied + 6 * base_body_ + 3, base.torque.data());
    simulation.collision().begin();
    const bool made = try_in_mujoco(simulation.who(), [this, &m, &d] { step_once(m, d); });
    // On a bad state MuJoCo warns and silently resets itself.
    if (!made || d.warning[mjWARN_BADQPOS].number > 0 || d.warning[mjWARN_BADQVEL].number > 0 ||
        d.warning[mjWARN_BADQACC].number > 0) {
      simulation.spoil();
      return StepStatus::kDiverged;
    }
    simulation.store({id_, ++revision_}, kept_);
    return StepStatus::kOk;
  }

  void do_read_state(RobotState& state) const noexcept override {
    const mjtNum* const qpos = kept_.qpos();
    const mjtNum* const qvel = kept_.qvel();
    if (spec().fixed_base) {
      state.q_WB = quaternion(kept_.base_attitude());
      state.p_WB = vector(kept_.base_position()) - state.q_WB * base_origin();
      state.v_WB.setZero();
      state.w_WB.setZero();
    } else {
      state.q_WB = quaternion(qpos + 3);
      const Vector3 p_BC_W = state.q_WB * base_origin();
      state.p_WB = vector(qpos) - p_BC_W;
      state.w_WB = state.q_WB * vector(qvel + 3);
      state.v_WB = vector(qvel) - state.w_WB.cross(p_BC_W);
    }
    for (std::size_t i = 0; i < q_address_.size(); ++i) {
      state.q[static_cast<Eigen::Index>(i)] = qpos[q_address_[i]];
      state.qd[static_cast<Eigen::Index>(i)] = qvel[v_address_[i]];
    }
  }

  // Called after a step, by its thread: what it found is still there.
  void do_read_contacts(ContactList& contacts) const noexcept override {
    Simulation& simulation = simulations_->here();
    const mjData& d = simulation.data();
    for (int i = 0; i < d.ncon; ++i) {
      const mjContact& c = d.contact[i];
      if (c.efc_address < 0) continue;
      const bool robot_first = c.geom1 != terrain_geom_;
      const ShapeOwner owner = owners_[static_cast<std::size_t>(robot_first ? c.geom1 : c.geom2)];
      const double sign = robot_first ? -1.0 : 1.0;  // MuJoCo's normal points from the first to the second
      // Contact frame: rows of the 3x3 are normal and two tangents.
      const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> frame(c.frame);
      Contact contact;
      contact.body = owner.body;
      contact.leg = owner.leg;
      contact.p_WP = vector(c.pos);
      contact.normal = sign * frame.row(0).transpose();
      contact.distance = c.dist;
      contact.force = sign * (frame.transpose() * force_in_frame(simulation.model(), d, i));
      contact.slip_speed = slip_speed(d, c);
      contacts.add(contact);
    }
    contacts.dropped = simulation.collision().dropped();
  }

  // Elliptic cones keep force and velocity in the contact's frame; of a pyramid each direction of friction
  // has two edges, of the normal plus and minus its coefficient times the tangent.
  Vector3 force_in_frame(const mjModel& m, const mjData& d, int contact) const noexcept {
    if (spec().contact.cone == FrictionCone::kElliptic)
      return vector(d.efc_force + d.contact[contact].efc_address);
    std::array<mjtNum, 6> force{};
    mj_contactForce(&m, &d, contact, force.data());
    return vector(force.data());
  }

  double slip_speed(const mjData& d, const mjContact& c) const noexcept {
    const mjtNum* const v = d.efc_vel + c.efc_address;
    if (spec().contact.cone == FrictionCone::kElliptic) return std::hypot(v[1], v[2]);
    return std::hypot((v[0] - v[1]) / (2 * c.friction[0]), (v[2] - v[3]) / (2 * c.friction[1]));
  }

  double do_terrain_height(double x, double y) const override {
    const double top = spec().terrain.field() != nullptr ? spec().terrain.field()->max() + 1 : 1;
    const std::array<mjtNum, 3> from{x, y, top}, down{0, 0, -1};
    constexpr std::array<mjtByte, 6> kTerrainOnly{1, 0, 0, 0, 0, 0};
    Simulation& simulation = loaded();
    const mjData& d = simulation.query();
    double distance = -1;
    in_mujoco(simulation.who(), [&] {
      distance = ray(&simulation.model(), &d, from.data(), down.data(), kTerrainOnly.data());
    });
    return distance < 0 ? std::numeric_limits<double>::quiet_NaN() : top - distance;
  }

  // Data for questions between steps, with the state of this world, so that asking never disturbs the
  // simulation.
  const mjData& refreshed_query() const {
    Simulation& simulation = loaded();
    mjData& d = simulation.query();
    in_mujoco(simulation.who(), [this, &d, m = &simulation.model()] {
      mju_copy(d.qpos, kept_.qpos(), static_cast<int>(m->nq));
      mj_kinematics(m, &d);
      mj_comPos(m, &d);
      find_inertia(m, &d);
    });
    return d;
  }

  Pose do_body_pose(int body) const override {
    const mjData& d = refreshed_query();
    const int id = bodies_[static_cast<std::size_t>(body)];
    const Quaternion q = quaternion(d.xquat + 4 * id);
    return make_pose(q, vector(d.xpos + 3 * id) - q * body_origin(robot(), body));
  }

  Eigen::MatrixXd do_mass_matrix() const override {
    const mjData& d = refreshed_query();
    const mjModel& m = simulations_->model();
    const int nv = static_cast<int>(m.nv), joints = robot().joint_count(), base = nv - joints;
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> M(nv, nv);
    copy_inertia(&m, &d, M.data());
    // Columns of S: MuJoCo's velocities (base: of its centre of mass, and angular in B; joints depth first)
    // per unit of ours.
    Eigen::MatrixXd S = Eigen::MatrixXd::Zero(nv, nv);
    if (base == 6) {
      const Vector3 p = state().q_WB * base_origin();
      S.topLeftCorner<3, 3>().setIdentity();
      S.block<3, 3>(0, 3) << 0, p.z(), -p.y(), -p.z(), 0, p.x(), p.y(), -p.x(), 0;  // w x p
      S.block<3, 3>(3, 3) = state().q_WB.toRotationMatrix().transpose();
    }
    for (int i = 0; i < joints; ++i) S(v_address_[static_cast<std::size_t>(i)], base + i) = 1;
    return S.transpose() * M * S;
  }

  SpatialInertia do_body_inertia(int body) const override {
    const mjModel& m = simulations_->model();
    const int id = bodies_[static_cast<std::size_t>(body)];
    return from_principal(m.body_mass[id],
                          {make_pose(quaternion(m.body_iquat + 4 * id),
                                     vector(m.body_ipos + 3 * id) + body_origin(robot(), body)),
                           vector(m.body_inertia + 3 * id)});
  }

  JointVector do_joint_friction() const override {
    const mjModel& m = simulations_->model();
    JointVector friction(robot().joint_count());
    for (std::size_t i = 0; i < v_address_.size(); ++i) {
      friction[static_cast<Eigen::Index>(i)] = m.dof_frictionloss[v_address_[i]];
    }
    return friction;
  }

  JointRanges do_joint_limits() const override {
    const mjModel& m = simulations_->model();
    JointRanges limits(robot().joint_count());
    for (int i = 0; i < robot().joint_count(); ++i) {
      const int id = m.dof_jntid[v_address_[static_cast<std::size_t>(i)]];
      if (m.jnt_limited[id] == 0) continue;
      limits.lower[i] = m.jnt_range[2 * id];
      limits.upper[i] = m.jnt_range[2 * id + 1];
    }
    return limits;
  }

  void do_save(std::vector<double>& engine) const override { engine = kept_.numbers(); }

  void do_restore(const std::vector<double>& engine) override {
    kept_.set(engine);
    ++revision_;
  }

  static std::uint64_t next_id() noexcept {
    static std::atomic<std::uint64_t> last{0};
    return ++last;
  }

  bool takes_bias_away_;
  std::shared_ptr<WorldGroup> group_;  // outlives the next, which is its part
  std::shared_ptr<Simulations> simulations_;
  KeptState kept_;
  std::uint64_t id_ = next_id(), revision_ = 0;  // of this world; grows with every change of `kept_`
  std::vector<ShapeOwner> owners_;               // per MuJoCo geom
  std::vector<int> bodies_;                      // MuJoCo body of each of ours
  std::vector<int> q_address_, v_address_;       // of each joint
  std::vector<int> servo_tendons_;               // of each joint, -1 unless its servo is implicit
  std::vector<double> servo_accelerations_;  // by tendon, rad/s^2: where its servo would make no more torque
  int terrain_geom_ = -1, base_body_ = -1;
};

}  // namespace

Engine engine(bool loop_bias) {
  return {MujocoBackend::the_info(loop_bias),
          [loop_bias](const WorldSpec& spec) { return std::make_unique<MujocoBackend>(spec, loop_bias); }};
}

}  // namespace crossgait::mujoco
