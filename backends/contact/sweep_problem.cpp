#include "backends/contact/sweep_problem.h"

#include <algorithm>
#include <cmath>

namespace crossgait::contact {
namespace {

constexpr int kMaxRows = 3 * kMaxContacts + kMaxBoundedRows;

}  // namespace

SweepProblem::SweepProblem(int dofs, const std::vector<std::vector<int>>& coupled, double friction,
                           double mixing)
    : friction_(friction),
      mixing_(mixing),
      reach_(static_cast<std::size_t>(dofs)),
      row_(3, dofs),
      Z_(3, (kMaxContacts + kMaxBoundedRows) * dofs),
      w_(DofVector::Zero(dofs)),
      u_(DofVector::Zero(dofs)),
      lookahead_(dofs),
      mixer_(kMaxRows),
      before_(kMaxRows),
      after_(kMaxRows) {
  const SparseSymmetric pattern(dofs, coupled);
  for (const std::vector<int>& set : coupled) {
    // Those of bodies come first: a loop is no row's.
    if (!set.empty() && reach(set).empty()) reach_[static_cast<std::size_t>(set.back())] = pattern.reach(set);
  }
}

void SweepProblem::begin(const SparseSymmetric* held) noexcept {
  columns_ = contact_count_ = bounded_count_ = 0;
  held_ = held;
}

const std::vector<int>& SweepProblem::reach(std::span<const int> dofs) const noexcept {
  static const std::vector<int> kNone;
  return dofs.empty() ? kNone : reach_[static_cast<std::size_t>(dofs.back())];
}

void SweepProblem::add_contact(std::span<const int> dofs, const PointJacobian& Z, const Vector3& R,
                               const Vector3& b) noexcept {
  SweptContact& contact = contacts_[static_cast<std::size_t>(contact_count_++)];
  contact.dofs = &reach(dofs);
  contact.first = columns_;
  contact.b = b;
  contact.x.setZero();
  for (const int dof : *contact.dofs) row_.col(dof).setZero();
  for (const int dof : dofs) row_.col(dof) = Z.col(dof);
  if (held_ != nullptr) held_->half_solve_rows(*contact.dofs, row_);
  Vector3 A = R;
  for (const int dof : *contact.dofs) {
    A += row_.col(dof).cwiseAbs2();
    Z_.col(columns_++) = row_.col(dof);
  }
  const Vector3 mixed = mixing_ * (A - R);
  contact.R = R + mixed;
  A += mixed;
  contact.normal_step = A[0] > 0 ? 1 / A[0] : 0;
  // One step size for both directions, or friction would not oppose slip.
  const double across = std::max(A[1], A[2]);
  contact.tangent_step = across > 0 ? 1 / across : 0;
}

void SweepProblem::add_bounded(std::span<const int> dofs, const DofVector& z, double R, double b,
                               const ImpulseBounds& bounds) noexcept {
  Bounded& row = bounded_[static_cast<std::size_t>(bounded_count_++)];
  row = {&reach(dofs), columns_, R, b, bounds, 0, 0};
  for (const int dof : *row.dofs) row_.col(dof).setZero();
  for (const int dof : dofs) row_(0, dof) = z[dof];
  if (held_ != nullptr) held_->half_solve_rows(*row.dofs, row_);
  double A = R;
  for (const int dof : *row.dofs) {
    A += row_(0, dof) * row_(0, dof);
    Z_.col(columns_++) = row_.col(dof);
  }
  row.step = A > 0 ? 1 / A : 0;
}

double SweepProblem::sweep_bounded(bool forward) noexcept {
  double change = 0;
  for (int i = 0; i < bounded_count_; ++i) {
    Bounded& row = bounded_[static_cast<std::size_t>(forward ? i : bounded_count_ - 1 - i)];
    double velocity = row.b + row.R * row.x;
    int column = row.first;
    for (const int dof : *row.dofs) velocity += Z_(0, column++) * w_[dof];
    const double next = std::clamp(row.x - row.step * velocity, row.bounds.lower, row.bounds.upper);
    const double by = next - row.x;
    row.x = next;
    if (by == 0) continue;
    column = row.first;
    for (const int dof : *row.dofs) w_[dof] += by * Z_(0, column++);
    change = std::max(change, std::abs(by) / row.step);
  }
  return change;
}

double SweepProblem::sweep_normals() noexcept {
  double change = 0;
  for (int i = 0; i < contact_count_; ++i) {
    SweptContact& contact = contacts_[static_cast<std::size_t>(i)];
    double velocity = contact.b[0] + contact.R[0] * contact.x[0];
    int column = contact.first;
    for (const int dof : *contact.dofs) velocity += Z_(0, column++) * w_[dof];
    const double next = std::max(0.0, contact.x[0] - contact.normal_step * velocity);
    const double by = next - contact.x[0];
    contact.x[0] = next;
    if (by == 0) continue;
    column = contact.first;
    for (const int dof : *contact.dofs) w_[dof] += by * Z_(0, column++);
    change = std::max(change, std::abs(by) / contact.normal_step);
  }
  return change;
}

double SweepProblem::sweep_tangents() noexcept {
  double change = 0;
  for (int i = 0; i < contact_count_; ++i) {
    SweptContact& contact = contacts_[static_cast<std::size_t>(i)];
    const double limit = friction_ * contact.x[0];
    if (limit == 0 && contact.x[1] == 0 && contact.x[2] == 0) continue;
    double v1 = contact.b[1] + contact.R[1] * contact.x[1], v2 = contact.b[2] + contact.R[2] * contact.x[2];
    int column = contact.first;
    for (const int dof : *contact.dofs) {
      v1 += Z_(1, column) * w_[dof];
      v2 += Z_(2, column++) * w_[dof];
    }
    double x1 = contact.x[1] - contact.tangent_step * v1, x2 = contact.x[2] - contact.tangent_step * v2;
    const double squared = x1 * x1 + x2 * x2;
    if (squared > limit * limit) {
      const double scale = limit / std::sqrt(squared);
      x1 *= scale;
      x2 *= scale;
    }
    const double by1 = x1 - contact.x[1], by2 = x2 - contact.x[2];
    contact.x[1] = x1;
    contact.x[2] = x2;
    column = contact.first;
    for (const int dof : *contact.dofs) {
      w_[dof] += by1 * Z_(1, column) + by2 * Z_(2, column);
      ++column;
    }
    if (contact.tangent_step > 0) change = std::max(change, std::abs(by1 + by2) / contact.tangent_step);
  }
  return change;
}

// With few, what is laid out for it costs as much as it saves; and results of quadrupeds on feet that are
// points keep their rounding.
bool SweepProblem::many() const noexcept { return contact_count_ >= 8; }

std::span<SweptContact> SweepProblem::swept() noexcept {
  return std::span(contacts_).first(static_cast<std::size_t>(contact_count_));
}

void SweepProblem::begin_sweeps() noexcept {
  w_.setZero();
  if (many()) lookahead_.begin(swept(), Z_, w_);
}

// Returns by how much the velocity of a row changed at most.
double SweepProblem::sweep_once(bool bounded_forward) noexcept {
  const double bounded = sweep_bounded(bounded_forward);
  const double normals = many() ? lookahead_.sweep_normals() : sweep_normals();
  const double tangents = many() ? lookahead_.sweep_tangents(friction_) : sweep_tangents();
  return std::max({bounded, normals, tangents});
}

void SweepProblem::finish() noexcept {
  u_ = w_;
  if (held_ != nullptr) held_->finish_solve(u_);
}

int SweepProblem::sweep(int max_sweeps, double enough) noexcept {
  begin_sweeps();
  int count = 0;
  while (count < max_sweeps) {
    const bool forward = count % 2 == 1;
    ++count;
    if (sweep_once(forward) <= enough) break;
  }
  if (many()) lookahead_.get_impulses(swept());
  finish();
  return count;
}

// Changes count by what they do to the robot.
void SweepProblem::begin_mixing() noexcept {
  mixer_.begin(static_cast<int>(rows()));
  Eigen::Ref<Eigen::VectorXd> weights = mixer_.weights();
  const auto weight = [](double step) { return step > 0 ? 1 / std::sqrt(step) : 0; };
  for (int i = 0; i < bounded_count_; ++i) weights[i] = weight(bounded_[static_cast<std::size_t>(i)].step);
  for (int i = 0; i < contact_count_; ++i) {
    const SweptContact& contact = contacts_[static_cast<std::size_t>(i)];
    weights.segment<3>(bounded_count_ + 3 * i) << weight(contact.normal_step), weight(contact.tangent_step),
        weight(contact.tangent_step);
  }
}

void SweepProblem::gather(Eigen::Ref<Eigen::VectorXd> impulses) const noexcept {
  for (int i = 0; i < bounded_count_; ++i) impulses[i] = bounded_[static_cast<std::size_t>(i)].x;
  for (int i = 0; i < contact_count_; ++i)
    impulses.segment<3>(bounded_count_ + 3 * i) = contacts_[static_cast<std::size_t>(i)].x;
}

// Impulses, as far as the law allows them, and what they do to the robot.
void SweepProblem::move_to(const Eigen::Ref<const Eigen::VectorXd>& impulses) noexcept {
  w_.setZero();
  for (int i = 0; i < bounded_count_; ++i) {
    Bounded& row = bounded_[static_cast<std::size_t>(i)];
    row.x = std::clamp(impulses[i], row.bounds.lower, row.bounds.upper);
    int column = row.first;
    for (const int dof : *row.dofs) w_[dof] += row.x * Z_(0, column++);
  }
  for (int i = 0; i < contact_count_; ++i) {
    SweptContact& contact = contacts_[static_cast<std::size_t>(i)];
    contact.x = impulses.segment<3>(bounded_count_ + 3 * i);
    contact.x[0] = std::max(0.0, contact.x[0]);
    const double limit = friction_ * contact.x[0], across = contact.x.tail<2>().norm();
    if (across > limit) contact.x.tail<2>() *= limit / across;
    int column = contact.first;
    for (const int dof : *contact.dofs) w_[dof] += contact.x.dot(Z_.col(column++));
  }
}

// Largest impulse of a bounded row or along a normal.
double SweepProblem::largest_push() const noexcept {
  double push = 0;
  for (int i = 0; i < bounded_count_; ++i)
    push = std::max(push, std::abs(bounded_[static_cast<std::size_t>(i)].x));
  for (int i = 0; i < contact_count_; ++i) push = std::max(push, contacts_[static_cast<std::size_t>(i)].x[0]);
  return push;
}

int SweepProblem::converge(int max_sweeps, double share) noexcept {
  begin_mixing();
  auto before = before_.head(rows()), after = after_.head(rows());
  begin_sweeps();
  int count = 0;
  gather(before);
  while (count < max_sweeps) {
    sweep_once(true);
    ++count;
    if (many()) lookahead_.get_impulses(swept());
    gather(after);
    const double change = rows() > 0 ? (after - before).cwiseAbs().maxCoeff() : 0;
    if (change <= share * largest_push()) break;
    if (mixer_.replace(before, after, change)) {
      move_to(after);
      if (many()) lookahead_.set_impulses(swept());
      gather(before);  // as the law has it
    } else {
      before = after;
    }
  }
  finish();
  return count;
}

}  // namespace crossgait::contact
