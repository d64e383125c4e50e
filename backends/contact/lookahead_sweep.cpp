#include "backends/contact/lookahead_sweep.h"

#include <algorithm>
#include <cmath>

namespace crossgait::contact {
namespace {

double inverse(double step) noexcept { return step > 0 ? 1 / step : 0; }

// Joints of rows rise, as dofs do.
template <typename Row, typename Do>
void for_shared_joints(const Row& a, const Row& b, const Do& act) {
  auto j = b.joints;
  for (auto i = a.joints; i != a.joints_end; ++i) {
    while (j != b.joints_end && j->w < i->w) ++j;
    if (j == b.joints_end) return;
    if (j->w == i->w) act(*i, *j);
  }
}

template <typename Row>
double shared(const Row& now, const Row& then) {
  double asked = now.asked_z.dot(then.z);
  for_shared_joints(now, then, [&](const auto& a, const auto& b) { asked += a.asked_z * b.z; });
  return asked;
}

}  // namespace

LookaheadSweep::LookaheadSweep(int dofs) {
  const auto joints = static_cast<std::size_t>(kMaxContacts * dofs);
  normal_joints_.reserve(joints);
  tangent_joints_.reserve(joints);
}

void LookaheadSweep::begin(std::span<const SweptContact> contacts, const Eigen::Matrix3Xd& Z,
                           DofVector& w) noexcept {
  w_ = &w;
  count_ = contacts.size();
  normal_joints_.clear();
  tangent_joints_.clear();
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    set_rows(i, contacts[i], Z);
    look_back(i);
  }
  normals_[count_] = normals_[count_ + 1] = {};
  tangents_[count_] = {};
  set_impulses(contacts);
}

void LookaheadSweep::set_impulses(std::span<const SweptContact> contacts) noexcept {
  for (std::size_t i = 0; i < count_; ++i) {
    normals_[i].x = contacts[i].x[0];
    tangents_[i].x = contacts[i].x.tail<2>();
  }
}

void LookaheadSweep::get_impulses(std::span<SweptContact> contacts) const noexcept {
  for (std::size_t i = 0; i < count_; ++i) contacts[i].x << normals_[i].x, tangents_[i].x;
}

// What rows of contact i see of those before it.
void LookaheadSweep::look_back(std::size_t i) noexcept {
  NormalRow& normal = normals_[i];
  TangentRows& tangents = tangents_[i];
  Eigen::Matrix2d& asked = tangents.asked_last;
  normal.asked_last = i >= 1 ? shared(normal, normals_[i - 1]) : 0;
  normal.asked_last_but_one = i >= 2 ? shared(normal, normals_[i - 2]) : 0;
  if (i == 0) {
    asked.setZero();
    return;
  }
  const TangentRows& before = tangents_[i - 1];
  asked << tangents.asked_z1.dot(before.z1), tangents.asked_z1.dot(before.z2),
      tangents.asked_z2.dot(before.z1), tangents.asked_z2.dot(before.z2);
  for_shared_joints(tangents, before, [&](const TangentJoint& now, const TangentJoint& then) {
    asked(0, 0) += now.asked_z1 * then.z1;
    asked(0, 1) += now.asked_z1 * then.z2;
    asked(1, 0) += now.asked_z2 * then.z1;
    asked(1, 1) += now.asked_z2 * then.z2;
  });
}

void LookaheadSweep::set_rows(std::size_t i, const SweptContact& contact,
                              const Eigen::Matrix3Xd& Z) noexcept {
  const double along = -contact.normal_step, across = -contact.tangent_step;
  NormalRow& normal = normals_[i];
  TangentRows& tangents = tangents_[i];
  normal.z.setZero();
  tangents.z1.setZero();
  tangents.z2.setZero();
  normal.joints = normal_joints_.data() + normal_joints_.size();
  tangents.joints = tangent_joints_.data() + tangent_joints_.size();
  int column = contact.first;
  for (const int dof : *contact.dofs) {
    const Vector3 z = Z.col(column++);
    if (dof < 6) {
      normal.z[dof] = z[0];
      tangents.z1[dof] = z[1];
      tangents.z2[dof] = z[2];
    } else {
      double* w = &(*w_)[dof];
      normal_joints_.push_back({w, z[0], along * z[0]});
      tangent_joints_.push_back({w, z[1], z[2], across * z[1], across * z[2]});
    }
  }
  normal.joints_end = normal_joints_.data() + normal_joints_.size();
  tangents.joints_end = tangent_joints_.data() + tangent_joints_.size();
  normal.asked_z = along * normal.z;
  normal.asked_b = along * contact.b[0];
  normal.asked_R = along * contact.R[0];
  normal.inverse_step = inverse(contact.normal_step);
  tangents.asked_z1 = across * tangents.z1;
  tangents.asked_z2 = across * tangents.z2;
  tangents.asked_b = across * contact.b.tail<2>();
  tangents.asked_R = across * contact.R.tail<2>();
  tangents.inverse_step = inverse(contact.tangent_step);
}

double LookaheadSweep::sweep_normals() noexcept {
  BaseRow w = w_->head<6>();
  const auto ask = [&w](const NormalRow& row) {
    double asked = row.asked_b + row.asked_R * row.x;
    for (const NormalJoint* joint = row.joints; joint != row.joints_end; ++joint)
      asked += joint->asked_z * *joint->w;
    return asked + row.asked_z.dot(w);
  };
  double change = 0, by = 0, by_before = 0;
  NormalRow *row = normals_.data(), *const end = row + count_;
  double asked = ask(row[0]), asked_next = ask(row[1]);
  for (; row != end; ++row) {
    const double now = asked + row->asked_last_but_one * by_before + row->asked_last * by;
    asked = asked_next;
    asked_next = ask(row[2]);
    by_before = by;
    by = std::max(-row->x, now);
    row->x += by;
    w += by * row->z;
    for (const NormalJoint* joint = row->joints; joint != row->joints_end; ++joint)
      *joint->w += by * joint->z;
    change = std::max(change, std::abs(by) * row->inverse_step);
  }
  w_->head<6>() = w;
  return change;
}

double LookaheadSweep::sweep_tangents(double friction) noexcept {
  BaseRow w = w_->head<6>();
  double asked1 = 0, asked2 = 0;
  const auto ask = [&](const TangentRows& row) {
    double sum1 = row.asked_b[0] + row.asked_R[0] * row.x[0];
    double sum2 = row.asked_b[1] + row.asked_R[1] * row.x[1];
    for (const TangentJoint* joint = row.joints; joint != row.joints_end; ++joint) {
      sum1 += joint->asked_z1 * *joint->w;
      sum2 += joint->asked_z2 * *joint->w;
    }
    asked1 = sum1 + row.asked_z1.dot(w);
    asked2 = sum2 + row.asked_z2.dot(w);
  };
  double change = 0;
  const NormalRow* normal = normals_.data();
  TangentRows *row = tangents_.data(), *const end = row + count_;
  ask(*row);
  for (; row != end; ++row, ++normal) {
    const Eigen::Matrix2d& seen = row[1].asked_last;
    double by1 = asked1, by2 = asked2, x1 = row->x[0] + by1, x2 = row->x[1] + by2;
    ask(row[1]);
    const double limit = friction * normal->x, squared = x1 * x1 + x2 * x2;
    if (squared > limit * limit) {
      // What the next one sees of all of x is known before the root is, and so one number has yet to come.
      const double all1 = seen(0, 0) * x1 + seen(0, 1) * x2, all2 = seen(1, 0) * x1 + seen(1, 1) * x2;
      asked1 -= seen(0, 0) * row->x[0] + seen(0, 1) * row->x[1];
      asked2 -= seen(1, 0) * row->x[0] + seen(1, 1) * row->x[1];
      const double scale = limit / std::sqrt(squared);
      asked1 += scale * all1;
      asked2 += scale * all2;
      x1 *= scale;
      x2 *= scale;
      by1 = x1 - row->x[0];
      by2 = x2 - row->x[1];
    } else {
      asked1 += seen(0, 0) * by1 + seen(0, 1) * by2;
      asked2 += seen(1, 0) * by1 + seen(1, 1) * by2;
    }
    row->x = {x1, x2};
    w += by1 * row->z1 + by2 * row->z2;
    for (const TangentJoint* joint = row->joints; joint != row->joints_end; ++joint)
      *joint->w += by1 * joint->z1 + by2 * joint->z2;
    change = std::max(change, std::abs(by1 + by2) * row->inverse_step);
  }
  w_->head<6>() = w;
  return change;
}

}  // namespace crossgait::contact
