#include "physics/engine/step_equations.h"

#include "physics/robot/actuator.h"

namespace crossgait {
namespace {

// How bodies accelerate where u' is zero: the point of the joint, and the turning.
struct Drift {
  Vector3 a, alpha;
};

}  // namespace

StepEquations::StepEquations(const WorldSpec& spec, double margin)
    : spec_(spec), margin_(margin), features_(contact_features(*spec.robot, spec.fixed_base)) {
  const RobotDescription& robot = *spec.robot;
  const std::vector<double> bodies = translational_inverse_weights(robot, spec.fixed_base);
  for (const LoopClosure& loop : robot.loops)
    of_loops_.push_back(
        {SoftLaw(robot.loop_softness, spec.physics_dt),
         bodies[static_cast<std::size_t>(loop.body_a)] + bodies[static_cast<std::size_t>(loop.body_b)]});
  const JointVector joints = joint_inverse_weights(robot, spec.fixed_base);
  for (const JointCoupling& coupling : robot.couplings)
    of_couplings_.push_back(
        {SoftLaw(coupling.softness, spec.physics_dt), joints[coupling.follower] + joints[coupling.leader]});
}

// Rows of the point's velocity and of the turning; the base's velocity is that of its centre of mass.
Eigen::MatrixXd StepEquations::full_jacobian(int body, const Vector3& p_BP) const {
  Eigen::MatrixXd J = point_jacobian(*spec_.robot, poses_, body, p_BP);
  // As point_jacobian has it, so that a push at the base's centre of mass has no lever to the last digit.
  const Vector3 arm = poses_[0] * spec_.robot->bodies[0].inertia.p_BC - poses_[0].translation();
  J.middleCols<3>(3) += J.leftCols<3>() * cross_matrix(arm);  // v_WB = v_WC - w x arm
  return J;
}

Eigen::MatrixXd StepEquations::jacobian(int body, const Vector3& p_WP) const {
  return full_jacobian(body, poses_[static_cast<std::size_t>(body)].inverse() * p_WP).topRows<3>();
}

void StepEquations::update(const RobotState& state) {
  const RobotDescription& robot = *spec_.robot;
  forward_kinematics(robot, state, poses_);
  forward_velocities(robot, state, poses_, velocities_);
  const Eigen::Index size = 6 + robot.joint_count();
  u_.resize(size);
  u_ << state.v_WB + state.w_WB.cross(poses_[0].linear() * robot.bodies[0].inertia.p_BC), state.w_WB,
      state.qd;
  M_.setZero(size, size);
  A_.setZero(size, size);
  bias_.setZero(size);
  b_.setZero(size);
  add_bodies(state);
  add_loops(state.q);
  find_points();
}

void StepEquations::add_bodies(const RobotState& state) {
  const RobotDescription& robot = *spec_.robot;
  std::vector<Drift> drifts(robot.bodies.size());
  for (std::size_t i = 0; i < robot.bodies.size(); ++i) {
    const Body& body = robot.bodies[i];
    const SpatialInertia& inertia = body.inertia;
    const Vector3 w = velocities_[i].w, way_C = poses_[i].linear() * inertia.p_BC;
    if (i == 0) {
      drifts[0] = {-w.cross(w.cross(way_C)), Vector3::Zero()};  // its centre of mass does not accelerate
    } else {
      const auto parent = static_cast<std::size_t>(body.parent);
      const Vector3 way = poses_[i].translation() - poses_[parent].translation(), w_P = velocities_[parent].w;
      const double rate = state.qd[static_cast<Eigen::Index>(i) - 1];
      drifts[i].a = drifts[parent].a + drifts[parent].alpha.cross(way) + w_P.cross(w_P.cross(way));
      drifts[i].alpha = drifts[parent].alpha + w_P.cross(poses_[i].linear() * body.joint.axis) * rate;
    }
    const Vector3 a_C = drifts[i].a + drifts[i].alpha.cross(way_C) + w.cross(w.cross(way_C));
    const Matrix3 I_W = poses_[i].linear() * inertia.I_C * poses_[i].linear().transpose();
    const Eigen::MatrixXd J = full_jacobian(static_cast<int>(i), inertia.p_BC);
    const auto J_v = J.topRows<3>(), J_w = J.bottomRows<3>();
    M_.noalias() += inertia.mass * J_v.transpose() * J_v + J_w.transpose() * I_W * J_w;
    bias_.noalias() += J_v.transpose() * (inertia.mass * (a_C - spec_.gravity)) +
                       J_w.transpose() * (I_W * drifts[i].alpha + w.cross(I_W * w));
    if (i > 0)
      M_(static_cast<Eigen::Index>(i) + 5, static_cast<Eigen::Index>(i) + 5) +=
          step_armature(body.joint, spec_.physics_dt);
  }
}

void StepEquations::add_soft_row(const SoftRow& row, const Eigen::MatrixXd& J, const Eigen::VectorXd& gap) {
  const double imp = row.law.impedance(gap.norm()), R = SoftLaw::regularization(imp, row.inverse_weight);
  if (!(R > 0)) return;  // nothing of it can move
  const Eigen::VectorXd speed = J * u_, wanted = row.law.target_velocity(speed, imp, gap);
  A_.noalias() += J.transpose() * J / R;
  b_.noalias() += J.transpose() * wanted / R;
}

void StepEquations::add_loops(const JointVector& q) {
  const RobotDescription& robot = *spec_.robot;
  for (std::size_t i = 0; i < of_loops_.size(); ++i) {
    const LoopClosure& loop = robot.loops[i];
    const Vector3 p_WA = poses_[static_cast<std::size_t>(loop.body_a)] * loop.p_AP,
                  p_WB = poses_[static_cast<std::size_t>(loop.body_b)] * loop.p_BP;
    const Eigen::MatrixXd J = full_jacobian(loop.body_a, loop.p_AP) - full_jacobian(loop.body_b, loop.p_BP);
    add_soft_row(of_loops_[i], J.topRows<3>(), p_WA - p_WB);
  }
  for (std::size_t i = 0; i < of_couplings_.size(); ++i) {
    const JointCoupling& coupling = robot.couplings[i];
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(1, u_.size());
    J(0, 6 + coupling.follower) = 1;
    J(0, 6 + coupling.leader) = -coupling.slope_at(q[coupling.leader]);
    const double gap = q[coupling.follower] - coupling.follower_at(q[coupling.leader]);
    add_soft_row(of_couplings_[i], J, Eigen::VectorXd::Constant(1, gap));
  }
}

// docs/adding-an-engine.md, "Contact": below the ground as touch_sphere has them, above it to the margin.
void StepEquations::find_points() {
  points_.clear();
  for (const ContactFeature& feature : features_) {
    const Body& body = spec_.robot->bodies[static_cast<std::size_t>(feature.body)];
    const Pose X_WG = poses_[static_cast<std::size_t>(feature.body)] *
                      body.shapes[static_cast<std::size_t>(feature.shape)].X_BG;
    const SphereCentres centres =
        sphere_centres(feature, X_WG * feature.p_GC, X_WG.linear() * feature.axis_G, spec_.terrain, margin_);
    for (int i = 0; i < centres.count; ++i) {
      const Vector3& centre = centres.points[static_cast<std::size_t>(i)];
      SphereContact touch;
      if (spec_.terrain.touch_sphere(centre, feature.radius, touch)) {
        points_.add({feature.body, feature.leg, touch.position, touch.normal, touch.distance});
      } else if (spec_.terrain.touch_sphere(centre, feature.radius + margin_, touch)) {
        const double distance = touch.distance + margin_;
        points_.add({feature.body, feature.leg, centre - (feature.radius + distance / 2) * touch.normal,
                     touch.normal, distance});
      }
    }
  }
}

}  // namespace crossgait
