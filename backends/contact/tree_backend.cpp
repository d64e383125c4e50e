#include "backends/contact/tree_backend.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "physics/robot/actuator.h"

namespace crossgait::contact {
namespace {

// Squares of velocities and forces have to be numbers for every library (DART ends the process where they are
// not); nothing that walks comes near.
constexpr double kMaxVelocity = 1e9;  // m/s, rad/s
constexpr double kMaxTorque = 1e15;   // N m

BodyKinematics kinematics(const TreeDynamics& tree) {
  return {tree.X_BC(), [&tree](int body, const Vector3& p_CP) { return Vector3(tree.X_WC(body) * p_CP); },
          [&tree](int body, const Vector3& v_C) { return Vector3(tree.X_WC(body).linear() * v_C); },
          [&tree](int body, const Vector3& p_WP, PointJacobian& J) { tree.point_jacobian(body, p_WP, J); }};
}

}  // namespace

void describe_law(const LawFactors& factors, const std::string& library, EngineInfo& info) {
  info.capabilities.soft_contact = !factors.hard_normal;
  info.capabilities.soft_friction = !factors.hard_friction;
  info.capabilities.turning_friction = is_solved_by_minimum(factors);
  info.capabilities.error_reduction = has_error_reduction(factors);
  info.capabilities.exact_field_query = true;  // the ground is Crossgait's
  info.laws = {.contact = law_name(factors),
               .loops = "mujoco",
               .joint_friction = factors.hard_joint_friction ? "hard" : "mujoco",
               .joint_limits = factors.hard_joint_limits ? "hard" : "mujoco",
               .couplings = "mujoco",
               .implicit_servos = "implicit",
               .contact_family = family_name(factors)};
  info.own_parts = own_parts();
  if (factors == LawFactors{}) {
    info.mode = "MuJoCo's contact law in " + library + "'s dynamics";
  } else if (factors == kHardLaw) {
    info.mode = "hard contact, Coulomb's disc";
  } else if (factors.pyramid) {
    info.mode = "hard contact, friction pyramid along the slip";
  } else if (factors.stock) {
    info.mode = "hard contact as DART ships";
  } else {
    info.mode = "between MuJoCo's contact law and hard contact";
  }
}

TreeBackend::TreeBackend(const WorldSpec& world, EngineInfo info, const LawFactors& factors,
                         const std::function<std::unique_ptr<TreeDynamics>(const WorldSpec&)>& make,
                         std::optional<double> margin)
    : PhysicsBackend(world),
      info_(std::move(info)),
      dynamics_(make(spec())),
      bodies_(kinematics(*dynamics_)),
      features_(body_features(robot(), spec().fixed_base, dynamics_->X_BC())),
      finder_(features_, spec().terrain,
              !factors.speculative ? std::vector<double>()
              : margin             ? std::vector<double>(robot().bodies.size(), *margin)
                                   : reach_margins(features_, robot().bodies.size())),
      joints_(spec(), bodies_),
      contacts_(spec(), factors, bodies_, joints_),
      v_(DofVector::Zero(6 + robot().joint_count())) {
  reset();
}

void TreeBackend::do_reset(const RobotState& state) {
  dynamics_->renew();
  q_WB_ = state.q_WB.normalized();
  p_WC_ = state.p_WB + p_BC_W();
  q_ = state.q;
  v_.setZero();
  if (!spec().fixed_base) {
    v_.head<3>() = state.w_WB;
    v_.segment<3>(3) = state.v_WB + state.w_WB.cross(p_BC_W());
  }
  v_.tail(q_.size()) = state.qd;
  contacts_.begin_step();
  place();
}

StepStatus TreeBackend::do_step(const JointVector& tau, const Wrench& base) noexcept {
  const double push = std::max(base.force.norm(), base.torque.norm());
  const bool finite = v_.allFinite() && tau.allFinite() && std::isfinite(push);
  if (!finite || v_.lpNorm<Eigen::Infinity>() > kMaxVelocity || tau.lpNorm<Eigen::Infinity>() > kMaxTorque ||
      push > kMaxTorque) {
    return StepStatus::kDiverged;
  }
  const double h = spec().physics_dt;
  contacts_.begin_step();
  dynamics_->bare_inertia(joints_.inertia());
  dynamics_->free_impulse(h, base, joints_.inertia(), v_, free_impulse_);
  joints_.solve(v_, free_impulse_, q_, tau);
  if (!joints_.velocity().allFinite()) return StepStatus::kDiverged;
  points_.clear();
  finder_.find(bodies_, points_);
  const DofVector& after = contacts_.solve(v_, q_, points_, implicit_servos());
  if (!after.allFinite() || after.lpNorm<Eigen::Infinity>() > kMaxVelocity) return StepStatus::kDiverged;
  v_ = after;
  integrate(h);
  place();
  return StepStatus::kOk;
}

void TreeBackend::integrate(double h) noexcept {
  if (!spec().fixed_base) {
    p_WC_ += h * v_.segment<3>(3);
    const Vector3 turn = h * v_.head<3>();
    const double angle = turn.norm();
    if (angle > 0) q_WB_ = (Quaternion(Eigen::AngleAxisd(angle, turn / angle)) * q_WB_).normalized();
  }
  q_ += h * v_.tail(q_.size());
}

void TreeBackend::do_read_state(RobotState& state) const noexcept {
  const Vector3 p = p_BC_W();
  state.q_WB = q_WB_;
  state.p_WB = p_WC_ - p;
  state.w_WB = v_.head<3>();
  state.v_WB = v_.segment<3>(3) - state.w_WB.cross(p);
  state.q = q_;
  state.qd = v_.tail(q_.size());
}

double TreeBackend::do_terrain_height(double x, double y) const {
  return spec().terrain.contains(x, y) ? spec().terrain.height(x, y)
                                       : std::numeric_limits<double>::quiet_NaN();
}

Pose TreeBackend::do_body_pose(int body) const {
  return dynamics_->X_WC(body) * dynamics_->X_BC()[static_cast<std::size_t>(body)].inverse();
}

Eigen::MatrixXd TreeBackend::do_mass_matrix() const {
  JointSpaceInertia inertia(robot(), spec().fixed_base, spec().physics_dt);
  dynamics_->bare_inertia(inertia);
  const int first = inertia.first_dof();
  const Eigen::Index size = inertia.dofs() - first;
  const Eigen::MatrixXd M = inertia.bare_matrix().bottomRightCorner(size, size);
  // Columns of S: our velocities [w, v of the centre of mass, qd] per unit of [v of the origin, w, qd].
  Eigen::MatrixXd S = Eigen::MatrixXd::Identity(size, size);
  if (first == 0) {
    const Vector3 p = p_BC_W();
    S.topLeftCorner<6, 6>().setZero();
    S.block<3, 3>(0, 3).setIdentity();
    S.block<3, 3>(3, 0).setIdentity();
    S.block<3, 3>(3, 3) << 0, p.z(), -p.y(), -p.z(), 0, p.x(), p.y(), -p.x(), 0;  // w x p
  }
  Eigen::MatrixXd result = S.transpose() * M * S;
  for (int i = 0; i < robot().joint_count(); ++i)
    result(6 - first + i, 6 - first + i) += step_armature(robot().joint(i), spec().physics_dt);
  return result;
}

void TreeBackend::do_save(std::vector<double>& engine) const {
  engine = {p_WC_.x(), p_WC_.y(), p_WC_.z(), q_WB_.w(), q_WB_.x(), q_WB_.y(), q_WB_.z()};
  engine.insert(engine.end(), v_.begin(), v_.end());
  engine.insert(engine.end(), q_.begin(), q_.end());
}

void TreeBackend::do_restore(const std::vector<double>& engine) {
  dynamics_->renew();
  const double* d = engine.data();
  p_WC_ = Vector3(d[0], d[1], d[2]);
  q_WB_ = Quaternion(d[3], d[4], d[5], d[6]);
  v_ = Eigen::Map<const Eigen::VectorXd>(d + 7, v_.size());
  q_ = Eigen::Map<const Eigen::VectorXd>(d + 7 + v_.size(), robot().joint_count());
  place();
}

}  // namespace crossgait::contact
