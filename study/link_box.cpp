#include "study/link_box.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

namespace crossgait {

void LinkOutline::add(const CollisionShape& shape) {
  const Pose& X = shape.X_BG;
  constexpr int kRim = 16;
  switch (shape.type) {
    case ShapeType::kSphere:
      balls_.push_back({X.translation(), shape.size[0]});
      break;
    case ShapeType::kCapsule:
      for (const double z : {-shape.size[1], shape.size[1]})
        balls_.push_back({X * Vector3(0, 0, z), shape.size[0]});
      break;
    case ShapeType::kCylinder:
      for (const double z : {-shape.size[1], shape.size[1]}) {
        for (int i = 0; i < kRim; ++i) {
          const double angle = 2 * M_PI * i / kRim;
          add(X * Vector3(shape.size[0] * std::cos(angle), shape.size[0] * std::sin(angle), z));
        }
      }
      break;
    case ShapeType::kBox:
      for (int corner = 0; corner < 8; ++corner) {
        const Vector3 sign((corner & 1) != 0 ? 1 : -1, (corner & 2) != 0 ? 1 : -1,
                           (corner & 4) != 0 ? 1 : -1);
        add(X * shape.size.cwiseProduct(sign));
      }
      break;
    case ShapeType::kHull:
      for (const Vector3& vertex : shape.vertices) add(X * vertex);
      break;
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
