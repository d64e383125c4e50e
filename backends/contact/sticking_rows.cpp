#include "backends/contact/sticking_rows.h"

#include <algorithm>
#include <cmath>

namespace crossgait::contact {

int StickingRows::solve(const Eigen::Matrix3Xd& Z, DofVector& w, int most, double enough) noexcept {
  const std::span rows(rows_.data(), static_cast<std::size_t>(count_));
  const DofVector before = w;
  DofVector change(w.size());
  double last = 0;  // of the preconditioned square
  for (int step = 0; step < most; ++step) {
    double square = 0, largest = 0;
    for (const Row& row : rows) {
      square += row.step * row.left * row.left;
      largest = std::max(largest, row.step * std::abs(row.left));
    }
    if (largest <= enough) return step;
    const double ratio = step > 0 ? square / last : 0;
    last = square;

    change.setZero();
    double curvature = 0;
    for (Row& row : rows) {
      row.along = row.step * row.left + ratio * row.along;
      curvature += row.R * row.along * row.along;
      for (std::size_t k = 0; k < row.dofs.size(); ++k)
        change[row.dofs[k]] += row.along * Z(row.lane, row.first + static_cast<Eigen::Index>(k));
    }
    curvature += change.squaredNorm();
    if (!(curvature > 0)) break;
    const double by = square / curvature;
    w += by * change;
    for (Row& row : rows) {
      *row.x += by * row.along;
      double velocity = row.R * row.along;
      for (std::size_t k = 0; k < row.dofs.size(); ++k)
        velocity += change[row.dofs[k]] * Z(row.lane, row.first + static_cast<Eigen::Index>(k));
      row.left -= by * velocity;
    }
  }
  w = before;
  for (const Row& row : rows) *row.x = row.before;
  return most;
}

}  // namespace crossgait::contact
