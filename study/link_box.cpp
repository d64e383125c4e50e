#include "study/link_box.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "physics/engine/contact_features.h"

namespace crossgait {

void LinkOutline::add(const CollisionShape& shape) {
  constexpr int kRim = 16;
  for (const ContactFeature& feature : features_of(shape)) {
    if (feature.rim == 0) {
      balls_.push_back({shape.X_BG * feature.p_GC, feature.radius});
      continue;
    }
    const Vector3 first = feature.rim * feature.axis_G.unitOrthogonal();
    for (int i = 0; i < kRim; ++i)
      add(shape.X_BG * (feature.p_GC + Eigen::AngleAxisd(2 * M_PI * i / kRim, feature.axis_G) * first));
  }
}

double LinkOutline::length() const noexcept {
  double longest = 0;
  for (std::size_t i = 0; i < balls_.size(); ++i) {
    longest = std::max(longest, 2 * balls_[i].radius);
    for (std::size_t k = 0; k < i; ++k)
      longest = std::max(longest,
                         (balls_[i].centre - balls_[k].centre).norm() + balls_[i].radius + balls_[k].radius);
  }
  return longest;
}

LinkBox::LinkBox(const LinkOutline& outline) {
  if (outline.balls_.empty()) return;
  Vector3 mean = Vector3::Zero();
  for (const LinkOutline::Ball& ball : outline.balls_)
    mean += ball.centre / static_cast<double>(outline.balls_.size());
  Matrix3 spread = Matrix3::Zero();
  for (const LinkOutline::Ball& ball : outline.balls_)
    spread += (ball.centre - mean) * (ball.centre - mean).transpose();
  axes_ = Eigen::SelfAdjointEigenSolver<Matrix3>(spread).eigenvectors().transpose();
  for (const LinkOutline::Ball& ball : outline.balls_) {
    const Vector3 centre = axes_ * ball.centre, half = Vector3::Constant(ball.radius);
    box_.extend(Eigen::AlignedBox3d(centre - half, centre + half));
  }
}

}  // namespace crossgait
