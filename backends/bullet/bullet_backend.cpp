#include "backends/bullet/bullet_backend.h"

#include <fmt/format.h>

#include "backends/bullet/collision_world.h"
#include "backends/bullet/convert.h"
#include "physics/robot/actuator.h"
#include "physics/robot/principal_inertia.h"

namespace crossgait::bullet {
namespace {

EngineInfo make_info(const ContactFactors& factors, bool own_code) {
  const int version = btGetVersion();
  EngineInfo info;
  info.library = "Bullet";
  info.version = fmt::format("{}.{:02}", version / 100, version % 100);
  info.name = own_code ? "bullet:own" : factor_table().name_of(factors);
  const bool matched = factors == ContactFactors::matched();
  info.capabilities.soft_contact = !factors.hard_normal;
  info.capabilities.soft_friction = !factors.hard_friction;
  info.capabilities.turning_friction = contact::is_solved_by_minimum(factors);
  info.capabilities.error_reduction = contact::has_error_reduction(factors);
  info.capabilities.sweeps = factors.sweeps;
  info.capabilities.allocates = factors.narrowphase;  // Bullet's own code
  const std::string way = factors.sweeps ? "/sweeps" : "", points = factors.narrowphase ? "/narrowphase" : "";
  info.laws = {.contact = contact::law_name(factors) + (factors.sweeps ? way : points),
               .loops = "mujoco",
               .joint_friction = factors.hard_joint_friction ? "hard" + way : "mujoco",
               .joint_limits = factors.hard_joint_limits ? "hard" + way : "mujoco",
               .couplings = "mujoco",
               .implicit_servos = own_code ? "" : "implicit" + way,
               .contact_family = contact::family_name(factors)};
  if (!own_code) info.own_parts = contact::own_parts();
  if (own_code) {
    info.mode = "hard contact, by Bullet's own code";
  } else if (matched) {
    info.mode = "MuJoCo's contact law in Bullet's dynamics";
  } else if (factors == ContactFactors::native()) {
    info.mode = "hard contact, projected Gauss-Seidel";
  } else {
    info.mode = "between MuJoCo's contact law and Bullet's own";
  }
  return info;
}

class BulletBackend final : public PhysicsBackend {
 public:
  BulletBackend(const WorldSpec& world, const ContactFactors& factors, bool own_code)
      : PhysicsBackend(world), factors_(factors), own_code_(own_code), info_(make_info(factors, own_code)) {
    build();
    reset();
  }

  const EngineInfo& info() const override { return info_; }

 private:
  void build() {
    world_.reset();
    solver_.reset();
    model_ = std::make_unique<MultibodyModel>(spec());
    solver_ = std::make_unique<ConstraintSolver>(spec(), factors_, own_code_, *model_);
    world_ = std::make_unique<CollisionWorld>(spec(), factors_, *model_, *solver_);
    poisoned_ = false;
  }

  btMultiBody& body() { return model_->body(); }
  const btMultiBody& body() const { return model_->body(); }

  // Bullet's base sits at its centre of mass along principal axes, and stores its orientation inverted.
  void do_reset(const RobotState& state) override {
    if (poisoned_) build();
    const Pose X_WP = make_pose(state.q_WB.normalized(), state.p_WB) * model_->X_BP(0);
    const Vector3 p_BC_W = X_WP.translation() - state.p_WB;
    btMultiBody& b = body();
    b.setBasePos(vector(Vector3(X_WP.translation())));
    b.setWorldToBaseRot(quaternion(Quaternion(X_WP.linear()).conjugate()));
    const bool fixed = spec().fixed_base;
    b.setBaseVel(fixed ? btVector3(0, 0, 0) : vector(Vector3(state.v_WB + state.w_WB.cross(p_BC_W))));
    b.setBaseOmega(fixed ? btVector3(0, 0, 0) : vector(state.w_WB));
    for (int i = 0; i < b.getNumLinks(); ++i) {
      b.setJointPos(i, state.q[i]);
      b.setJointVel(i, state.qd[i]);
    }
    world_->robot_moved();
  }

  StepStatus do_step(const JointVector& tau, const Wrench& base) noexcept override {
    solver_->begin_step(tau, implicit_servos());
    body().addBaseForce(vector(base.force));
    body().addBaseTorque(vector(base.torque));
    world_->step();
    poisoned_ = !solver_->finite();
    return poisoned_ ? StepStatus::kDiverged : StepStatus::kOk;
  }

  void do_read_state(RobotState& state) const noexcept override {
    const btMultiBody& b = body();
    const Quaternion q_WP = quaternion(b.getWorldToBaseRot()).conjugate();
    const Pose& X_BP = model_->X_BP(0);
    state.q_WB = q_WP * Quaternion(X_BP.linear()).conjugate();
    const Vector3 p_BC_W = state.q_WB * Vector3(X_BP.translation());
    state.p_WB = vector(b.getBasePos()) - p_BC_W;
    state.w_WB = vector(b.getBaseOmega());
    state.v_WB = vector(b.getBaseVel()) - state.w_WB.cross(p_BC_W);
    for (int i = 0; i < b.getNumLinks(); ++i) {
      state.q[i] = b.getJointPos(i);
      state.qd[i] = b.getJointVel(i);
    }
  }

  void do_read_contacts(ContactList& contacts) const noexcept override {
    contacts = solver_->contact_stage().contacts();
  }

  double do_terrain_height(double x, double y) const override { return world_->terrain_height(x, y); }

  Pose do_body_pose(int index) const override {
    const int link = index - 1;
    Pose X_WP = Pose::Identity();
    X_WP.linear() = matrix(body().localFrameToWorld(link, btMatrix3x3::getIdentity()));
    X_WP.translation() = vector(body().localPosToWorld(link, btVector3(0, 0, 0)));
    return X_WP * model_->X_BP(index).inverse();
  }

  // Inverts the response to unit forces of Bullet's articulated-body algorithm, so that this is the inertia
  // Bullet steps with and not the one Crossgait's joint stage computes.
  Eigen::MatrixXd do_mass_matrix() const override {
    btMultiBody& b = model_->body();
    const int n = 6 + b.getNumLinks(), first = b.hasFixedBase() ? 6 : 0;
    btAlignedObjectArray<btScalar> r;
    btAlignedObjectArray<btVector3> v;
    btAlignedObjectArray<btMatrix3x3> m;
    b.clearForcesAndTorques();
    b.computeAccelerationsArticulatedBodyAlgorithmMultiDof(0, r, v, m, false, false, false);
    Eigen::MatrixXd inverse(n, n);
    for (int c = 0; c < n; ++c) {
      Eigen::VectorXd force = Eigen::VectorXd::Unit(n, c);
      b.calcAccelerationDeltasMultiDof(force.data(), inverse.col(c).data(), r, v);
    }
    const int size = n - first;
    const Eigen::MatrixXd M = inverse.bottomRightCorner(size, size).inverse();
    // Columns of S: Bullet's velocities [w, v of the centre of mass, qd] per unit of [v of the origin, w,
    // qd].
    Eigen::MatrixXd S = Eigen::MatrixXd::Identity(size, size);
    if (first == 0) {
      const Vector3 p = state().q_WB * Vector3(model_->X_BP(0).translation());
      S.topLeftCorner<6, 6>().setZero();
      S.block<3, 3>(0, 3).setIdentity();
      S.block<3, 3>(3, 0).setIdentity();
      S.block<3, 3>(3, 3) << 0, p.z(), -p.y(), -p.z(), 0, p.x(), p.y(), -p.x(), 0;  // w x p
    }
    Eigen::MatrixXd result = S.transpose() * M * S;
    for (int i = 0; i < b.getNumLinks(); ++i)
      result(size - b.getNumLinks() + i, size - b.getNumLinks() + i) +=
          step_armature(spec().robot->joint(i), spec().physics_dt);
    return result;
  }

  SpatialInertia do_body_inertia(int index) const override {
    const btMultiBody& b = body();
    const Pose& X_BP = model_->X_BP(index);
    if (index == 0) return from_principal(b.getBaseMass(), {X_BP, vector(b.getBaseInertia())});
    const btMultibodyLink& link = b.getLink(index - 1);
    Pose X = X_BP;
    X.translation() = X_BP.linear() * vector(link.m_dVector);
    return from_principal(link.m_mass, {X, vector(link.m_inertiaLocal)});
  }

  JointVector do_joint_friction() const override { return solver_->contact_stage().joint_friction(); }
  JointRanges do_joint_limits() const override { return solver_->contact_stage().joint_limits(); }

  void do_save(std::vector<double>& engine) const override {
    const btMultiBody& b = body();
    const btVector3& p = b.getBasePos();
    const btQuaternion& q = b.getWorldToBaseRot();  // raw: a trip through btTransform would round
    engine = {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()};
    const double* v = b.getVelocityVector();
    engine.insert(engine.end(), v, v + 6 + b.getNumLinks());
    for (int i = 0; i < b.getNumLinks(); ++i) engine.push_back(b.getJointPos(i));
  }

  void do_restore(const std::vector<double>& engine) override {
    if (poisoned_) build();
    btMultiBody& b = body();
    const double* d = engine.data();
    b.setBasePos(btVector3(d[0], d[1], d[2]));
    b.setWorldToBaseRot(btQuaternion(d[3], d[4], d[5], d[6]));
    b.setBaseOmega(btVector3(d[7], d[8], d[9]));
    b.setBaseVel(btVector3(d[10], d[11], d[12]));
    const int links = b.getNumLinks();
    for (int i = 0; i < links; ++i) {
      b.setJointVel(i, d[13 + i]);
      b.setJointPos(i, d[13 + links + i]);
    }
    world_->robot_moved();
  }

  ContactFactors factors_;
  bool own_code_;
  EngineInfo info_;
  // Declared in order of dependence: each holds references to the ones before.
  std::unique_ptr<MultibodyModel> model_;
  std::unique_ptr<ConstraintSolver> solver_;
  std::unique_ptr<CollisionWorld> world_;
  bool poisoned_ = false;
};

Engine engine_of(const ContactFactors& factors, bool own_code = false) {
  return {make_info(factors, own_code), [factors, own_code](const WorldSpec& spec) {
            return std::make_unique<BulletBackend>(spec, factors, own_code);
          }};
}

}  // namespace

Engine matched_engine(std::string_view changes) {
  const std::string name = fmt::format("bullet:matched{}", changes);
  return engine_of(factor_table().changed(ContactFactors::matched(), changes, name));
}

Engine native_engine(std::string_view changes) {
  const std::string name = fmt::format("bullet{}", changes);
  return engine_of(factor_table().changed(ContactFactors::native(), changes, name));
}

Engine own_engine() { return engine_of(ContactFactors::native(), true); }

std::optional<Engine> find(std::string_view name) {
  const auto [base, changes] = split_factors(name);
  if (base == "bullet:matched") return matched_engine(changes);
  if (name == "bullet:own") return own_engine();
  if (base == "bullet" || base == "bullet:native") return native_engine(changes);
  return std::nullopt;
}

EngineFamily family() { return contact::family_of(factor_table(), find); }

}  // namespace crossgait::bullet
