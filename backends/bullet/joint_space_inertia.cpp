#include "crossgait/backends/bullet/joint_space_inertia.h"

#include <cmath>

#include "crossgait/backends/bullet/convert.h"

namespace crossgait::bullet {
namespace {

Matrix3 cross_matrix(const Vector3& v) {
  Matrix3 m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

}  // namespace

JointSpaceInertia::JointSpaceInertia(const btMultiBody& body, const JointVector& armature)
    : body_(body), armature_(armature), n_(6 + body.getNumLinks()), first_(body.hasFixedBase() ? 6 : 0) {
  for (int i = 0; i < 6; ++i) parent_[static_cast<std::size_t>(i)] = i - 1;
  for (int i = 0; i < body.getNumLinks(); ++i) {
    const int parent = body.getParent(i);
    parent_link_[static_cast<std::size_t>(i)] = parent;
    // Links hang on the base's last dof; under a fixed base they are roots.
    parent_[static_cast<std::size_t>(6 + i)] = parent >= 0 ? 6 + parent : (first_ == 6 ? -1 : 5);
  }
}

void JointSpaceInertia::update() noexcept {
  accumulate_composites();
  fill_matrix();
  factor();
}

void JointSpaceInertia::accumulate_composites() noexcept {
  const auto place = [this](Composite& c, double mass, const btVector3& moments, const Matrix3& R,
                            const Vector3& p_WC) {
    const Vector3 r = p_WC - reference_;
    c.mass = mass;
    c.moment = mass * r;
    c.inertia.noalias() = R * vector(moments).asDiagonal() * R.transpose();
    c.inertia += mass * (r.squaredNorm() * Matrix3::Identity() - r * r.transpose());
  };
  reference_ = vector(body_.getBasePos());
  const Matrix3 R_base = Quaternion(quaternion(body_.getWorldToBaseRot()).conjugate()).toRotationMatrix();
  place(composite_[0], body_.getBaseMass(), body_.getBaseInertia(), R_base, reference_);

  const int links = n_ - 6;
  for (int i = 0; i < links; ++i) {
    const btMultibodyLink& link = body_.getLink(i);
    const btTransform& X = link.m_cachedWorldTransform;
    const Matrix3 R = matrix(X.getBasis());
    const Vector3 p_WC = vector(X.getOrigin());
    const std::size_t k = static_cast<std::size_t>(i);
    place(composite_[k + 1], link.m_mass, link.m_inertiaLocal, R, p_WC);
    axis_w_[k] = R * vector(link.m_axes[0].m_topVec);
    const Vector3 pivot = p_WC - R * vector(link.m_dVector);
    axis_v_[k] = axis_w_[k].cross(reference_ - pivot);
  }
  for (int i = links - 1; i >= 0; --i) {
    Composite& parent = composite_[static_cast<std::size_t>(parent_link_[static_cast<std::size_t>(i)] + 1)];
    const Composite& own = composite_[static_cast<std::size_t>(i) + 1];
    parent.mass += own.mass;
    parent.moment += own.moment;
    parent.inertia += own.inertia;
  }
}

void JointSpaceInertia::fill_matrix() noexcept {
  // Base block [w, v] about the reference point: [I, c x; -c x, m].
  const Composite& all = composite_[0];
  const Matrix3 cx = cross_matrix(all.moment);
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) {
      H(r, c) = all.inertia(r, c);
      H(3 + r, c) = -cx(r, c);
      H(3 + r, 3 + c) = r == c ? all.mass : 0.0;
    }
  }
  for (int i = 0; i < n_ - 6; ++i) {
    const std::size_t k = static_cast<std::size_t>(i);
    const Composite& c = composite_[k + 1];
    // Momentum of the composite when joint i turns at unit speed.
    const Vector3 linear = c.mass * axis_v_[k] + axis_w_[k].cross(c.moment);
    const Vector3 angular = c.inertia * axis_w_[k] + c.moment.cross(axis_v_[k]);
    for (int r = 0; r < 3; ++r) {
      H(6 + i, r) = angular[r];
      H(6 + i, 3 + r) = linear[r];
    }
    for (int j = i; j >= 0; j = parent_link_[static_cast<std::size_t>(j)]) {
      const std::size_t a = static_cast<std::size_t>(j);
      H(6 + i, 6 + j) = axis_w_[a].dot(angular) + axis_v_[a].dot(linear);
    }
  }
  bare_ = H_;
  for (int i = 0; i < n_ - 6; ++i) H(6 + i, 6 + i) += armature_[i];
}

void JointSpaceInertia::factor() noexcept {
  for (int k = n_ - 1; k >= first_; --k) {
    const double d = H(k, k);
    sqrt_inverse_d_[static_cast<std::size_t>(k)] = 1 / std::sqrt(d);
    for (int i = parent_[static_cast<std::size_t>(k)]; i >= 0; i = parent_[static_cast<std::size_t>(i)]) {
      const double a = H(k, i) / d;
      for (int j = i; j >= 0; j = parent_[static_cast<std::size_t>(j)]) H(i, j) -= a * H(k, j);
      H(k, i) = a;
    }
  }
}

void JointSpaceInertia::multiply_bare(const DofVector& x, DofVector& y) const noexcept {
  const auto bare = [this](int r, int c) { return bare_[static_cast<std::size_t>(r * kMaxDofs + c)]; };
  y.setZero(n_);
  for (int i = first_; i < n_; ++i) {
    y[i] += bare(i, i) * x[i];
    for (int j = parent_[static_cast<std::size_t>(i)]; j >= 0; j = parent_[static_cast<std::size_t>(j)]) {
      y[i] += bare(i, j) * x[j];
      y[j] += bare(i, j) * x[i];
    }
  }
}

void JointSpaceInertia::half_solve(Eigen::Ref<DofVector> x) const noexcept {
  for (int i = n_ - 1; i >= first_; --i) {
    const double xi = x[i];
    if (xi == 0) continue;  // rows of one leg leave the others untouched
    for (int j = parent_[static_cast<std::size_t>(i)]; j >= 0; j = parent_[static_cast<std::size_t>(j)]) {
      x[j] -= H(i, j) * xi;
    }
    x[i] = xi * sqrt_inverse_d_[static_cast<std::size_t>(i)];
  }
  for (int i = 0; i < first_; ++i) x[i] = 0;
}

void JointSpaceInertia::finish_solve(DofVector& x) const noexcept {
  for (int i = first_; i < n_; ++i) {
    double xi = x[i] * sqrt_inverse_d_[static_cast<std::size_t>(i)];
    for (int j = parent_[static_cast<std::size_t>(i)]; j >= 0; j = parent_[static_cast<std::size_t>(j)]) {
      xi -= H(i, j) * x[j];
    }
    x[i] = xi;
  }
}

void JointSpaceInertia::point_jacobian(int link, const Vector3& p_WP, PointJacobian& J) const noexcept {
  J.setZero(3, n_);
  const Vector3 r = p_WP - reference_;
  if (first_ == 0) {
    J.leftCols<3>() = -cross_matrix(r);
    J.middleCols<3>(3).setIdentity();
  }
  for (int i = link; i >= 0; i = parent_link_[static_cast<std::size_t>(i)]) {
    const std::size_t k = static_cast<std::size_t>(i);
    J.col(6 + i) = axis_v_[k] + axis_w_[k].cross(r);
  }
}

Eigen::MatrixXd JointSpaceInertia::bare_matrix() const {
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(n_, n_);
  for (int i = 0; i < n_; ++i) {
    for (int j = i; j >= 0; j = parent_[static_cast<std::size_t>(j)]) {
      M(i, j) = M(j, i) = bare_[static_cast<std::size_t>(i * kMaxDofs + j)];
    }
  }
  return M;
}

}  // namespace crossgait::bullet
