#include "backends/bullet/composite_inertia.h"

#include "backends/bullet/convert.h"

namespace crossgait::bullet {
namespace {

Matrix3 cross_matrix(const Vector3& v) {
  Matrix3 m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

}  // namespace

CompositeInertia::CompositeInertia(const btMultiBody& body) : body_(body) {
  for (int i = 0; i < body.getNumLinks(); ++i) parent_link_[static_cast<std::size_t>(i)] = body.getParent(i);
}

void CompositeInertia::update(contact::JointSpaceInertia& inertia) noexcept {
  accumulate_composites();
  fill(inertia);
  inertia.factor();
}

void CompositeInertia::accumulate_composites() noexcept {
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

  const int links = body_.getNumLinks();
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

void CompositeInertia::fill(contact::JointSpaceInertia& M) const noexcept {
  // Base block [w, v] about the reference point: [I, c x; -c x, m].
  const Composite& all = composite_[0];
  const Matrix3 cx = cross_matrix(all.moment);
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) {
      M.bare(r, c) = all.inertia(r, c);
      M.bare(3 + r, c) = -cx(r, c);
      M.bare(3 + r, 3 + c) = r == c ? all.mass : 0.0;
    }
  }
  for (int i = 0; i < body_.getNumLinks(); ++i) {
    const std::size_t k = static_cast<std::size_t>(i);
    const Composite& c = composite_[k + 1];
    // Momentum of the composite when joint i turns at unit speed.
    const Vector3 linear = c.mass * axis_v_[k] + axis_w_[k].cross(c.moment);
    const Vector3 angular = c.inertia * axis_w_[k] + c.moment.cross(axis_v_[k]);
    for (int r = 0; r < 3; ++r) {
      M.bare(6 + i, r) = angular[r];
      M.bare(6 + i, 3 + r) = linear[r];
    }
    for (int j = i; j >= 0; j = parent_link_[static_cast<std::size_t>(j)]) {
      const std::size_t a = static_cast<std::size_t>(j);
      M.bare(6 + i, 6 + j) = axis_w_[a].dot(angular) + axis_v_[a].dot(linear);
    }
  }
}

void CompositeInertia::point_jacobian(int link, const Vector3& p_WP, PointJacobian& J) const noexcept {
  J.setZero(3, 6 + body_.getNumLinks());
  const Vector3 r = p_WP - reference_;
  if (!body_.hasFixedBase()) {
    J.leftCols<3>() = -cross_matrix(r);
    J.middleCols<3>(3).setIdentity();
  }
  for (int i = link; i >= 0; i = parent_link_[static_cast<std::size_t>(i)]) {
    const std::size_t k = static_cast<std::size_t>(i);
    J.col(6 + i) = axis_v_[k] + axis_w_[k].cross(r);
  }
}

}  // namespace crossgait::bullet
