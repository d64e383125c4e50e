#include "dynamics.h"

#include <crossgait/physics/robot/actuator.h>

namespace crossgait::skeleton {

Dynamics::Dynamics(const RobotDescription& robot, double physics_dt)
    : robot_(robot), physics_dt_(physics_dt), links_(robot.bodies.size()) {
  const Eigen::Index dofs = 6 + robot.joint_count();
  velocity_.setZero(dofs);
  bias_.setZero(dofs);
  M_.setZero(dofs, dofs);
}

void Dynamics::update(const RobotState& state, const Vector3& gravity) noexcept {
  place(state);
  compute_mass_matrix();
  compute_bias(gravity);
}

void Dynamics::place(const RobotState& state) noexcept {
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const Body& body = robot_.bodies[i];
    Link& link = links_[i];
    link.X_WB = i == 0 ? state.X_WB()
                       : links_[parent(i)].X_WB * body.X_PB *
                             Eigen::AngleAxisd(state.q[static_cast<Eigen::Index>(i) - 1], body.joint.axis);
    const Matrix3 R = link.X_WB.linear();
    link.centre = link.X_WB * body.inertia.p_BC;
    link.axis = R * body.joint.axis;
    link.inertia = R * body.inertia.I_C * R.transpose();
    link.point = i == 0 ? link.centre : Vector3(link.X_WB.translation());
  }
  velocity_ << state.v_WB + state.w_WB.cross(base_centre() - state.p_WB), state.w_WB, state.qd;
}

// What unit velocity of a link's joint gives to it: the velocity at C, and the turning.
Dynamics::Vector6 Dynamics::motion(const Link& link) const {
  Vector6 result;
  result << link.axis.cross(base_centre() - link.point), link.axis;
  return result;
}

// Composite-rigid-body algorithm (Featherstone, Rigid Body Dynamics Algorithms, 2008, section 6.2).
void Dynamics::compute_mass_matrix() noexcept {
  for (std::size_t i = 0; i < links_.size(); ++i) {
    Link& link = links_[i];
    const double mass = robot_.bodies[i].inertia.mass;
    const Matrix3 c = cross_matrix(link.centre - base_centre());
    link.composite << mass * Matrix3::Identity(), -mass * c, mass * c, link.inertia - mass * c * c;
  }
  for (std::size_t i = links_.size() - 1; i > 0; --i) {
    links_[parent(i)].composite += links_[i].composite;
    const Vector6 force = links_[i].composite * motion(links_[i]);
    M_.block<1, 6>(dof(i), 0) = force.transpose();
    for (std::size_t j = i; j > 0; j = parent(j)) M_(dof(i), dof(j)) = motion(links_[j]).dot(force);
    M_(dof(i), dof(i)) += step_armature(robot_.bodies[i].joint, physics_dt_);
  }
  M_.topLeftCorner<6, 6>() = links_[0].composite;
  M_.triangularView<Eigen::StrictlyUpper>() = M_.transpose();
}

// Recursive Newton-Euler algorithm (the same, section 5.3), with the velocities kept as they are.
void Dynamics::compute_bias(const Vector3& gravity) noexcept {
  for (std::size_t i = 0; i < links_.size(); ++i) {
    Link& link = links_[i];
    if (i == 0) {
      link.w = velocity_.segment<3>(3);
      link.alpha = link.a = Vector3::Zero();
    } else {
      const Link& on = links_[parent(i)];
      const Vector3 turning = velocity_[dof(i)] * link.axis, r = link.point - on.point;
      link.w = on.w + turning;
      link.alpha = on.alpha + on.w.cross(turning);
      link.a = on.a + on.alpha.cross(r) + on.w.cross(on.w.cross(r));
    }
    const Vector3 r = link.centre - link.point;
    const Vector3 a = link.a + link.alpha.cross(r) + link.w.cross(link.w.cross(r));
    link.force = robot_.bodies[i].inertia.mass * (a - gravity);
    link.moment = link.inertia * link.alpha + link.w.cross(link.inertia * link.w) +
                  (link.centre - base_centre()).cross(link.force);
  }
  for (std::size_t i = links_.size() - 1; i > 0; --i) {
    const Link& link = links_[i];
    bias_[dof(i)] = link.axis.dot(link.moment - (link.point - base_centre()).cross(link.force));
    links_[parent(i)].force += link.force;
    links_[parent(i)].moment += link.moment;
  }
  bias_.head<6>() << links_[0].force, links_[0].moment;
}

PointJacobian Dynamics::jacobian(int body, const Vector3& p_WP) const noexcept {
  PointJacobian J = PointJacobian::Zero(3, velocity_.size());
  J.leftCols<3>().setIdentity();
  J.middleCols<3>(3) = -cross_matrix(p_WP - base_centre());
  for (auto i = static_cast<std::size_t>(body); i > 0; i = parent(i))
    J.col(dof(i)) = links_[i].axis.cross(p_WP - links_[i].point);
  return J;
}

}  // namespace crossgait::skeleton
