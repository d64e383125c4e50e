#include "backends/contact/anderson_mixing.h"

#include <Eigen/Cholesky>

namespace crossgait::contact {

void AndersonMixing::begin(int size) noexcept {
  size_ = size;
  count_ = until_ = 0;
  plain_ = kPlain;
  size_before_ = 0;
}

bool AndersonMixing::replace(const Eigen::Ref<const Eigen::VectorXd>& before,
                             Eigen::Ref<Eigen::VectorXd> after, double size) noexcept {
  if (size_before_ > 0 && size > kShorter * size_before_) {
    after = kept_.head(size_);
    count_ = 0;
    plain_ *= 2;
    until_ = plain_;
    size_before_ = 0;
    return true;
  }
  size_before_ = 0;
  const int column = count_++ % kPoints;
  ends_.col(column).head(size_) = after;
  steps_.col(column).head(size_) = weights_.head(size_).cwiseProduct(after - before);
  if (--until_ > 0 || count_ < kPoints) return false;
  until_ = plain_;
  kept_.head(size_) = after;
  if (!mix(after)) return false;
  size_before_ = size;
  return true;
}

bool AndersonMixing::mix(Eigen::Ref<Eigen::VectorXd> point) const noexcept {
  // Shares that add up to one and leave the least square: proportional to the inverse of the steps' products,
  // applied to ones.
  const auto steps = steps_.topRows(size_);
  Eigen::Matrix<double, kPoints, kPoints> products;
  for (int i = 0; i < kPoints; ++i) {
    for (int j = 0; j <= i; ++j) products(i, j) = products(j, i) = steps.col(i).dot(steps.col(j));
  }
  constexpr double kRounding = 1e-12;  // of the smallest square: steps may be multiples of each other
  products.diagonal().array() += kRounding * products.diagonal().minCoeff();
  using Shares = Eigen::Matrix<double, kPoints, 1>;
  Shares shares = products.ldlt().solve(Shares::Ones());
  shares /= shares.sum();
  if (!shares.allFinite()) return false;
  point.setZero();
  for (int i = 0; i < kPoints; ++i) point += shares[i] * ends_.col(i).head(size_);
  return true;
}

}  // namespace crossgait::contact
