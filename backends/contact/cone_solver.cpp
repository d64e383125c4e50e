#include "backends/contact/cone_solver.h"

#include <algorithm>
#include <cmath>

namespace crossgait::contact {
namespace {

bool in_cone(const Vector3& x, double friction) noexcept {
  return x[0] >= 0 && std::hypot(x[1], x[2]) <= friction * x[0];
}

// Along the ray d(theta) = (1, mu cos, mu sin) the best multiple is s = N / D, worth N^2 / (2 D), where N =
// -g.d and D = d'Hd. The solution on the cone's surface is the ray of greatest worth.
struct Ray {
  double N, D, slope, curvature;  // slope and curvature of the worth, up to positive factors
  Vector3 d;
};

Ray evaluate(const Matrix3& H, const Vector3& g, double mu, double theta) noexcept {
  const double c = mu * std::cos(theta), s = mu * std::sin(theta);
  const Vector3 d(1, c, s), d1(0, -s, c), d2(0, -c, -s);
  const Vector3 Hd = H * d;
  const double N = -g.dot(d), N1 = -g.dot(d1), N2 = -g.dot(d2);
  const double D = d.dot(Hd), D1 = 2 * d1.dot(Hd), D2 = 2 * (d1.dot(H * d1) + d2.dot(Hd));
  return {N, D, 2 * N1 * D - N * D1, 2 * N2 * D + N1 * D1 - N * D2, d};
}

double worth(const Ray& ray) noexcept { return ray.N > 0 ? ray.N * ray.N / ray.D : 0; }

double best_sample(const Matrix3& H, const Vector3& g, double mu, int samples) noexcept {
  double best_theta = 0, best = -1;
  for (int i = 0; i < samples; ++i) {
    const double theta = 2 * M_PI * i / samples;
    if (const double w = worth(evaluate(H, g, mu, theta)); w > best) {
      best = w;
      best_theta = theta;
    }
  }
  return best_theta;
}

// Newton's method for the stationary ray from a good guess. @returns false where it does not settle.
bool polish(const Matrix3& H, const Vector3& g, double mu, double theta, Ray& ray) noexcept {
  constexpr double kSettled = 1e-14;  // rad, the rounding of an angle of a few radians
  for (int i = 0; i < 12; ++i) {
    ray = evaluate(H, g, mu, theta);
    if (ray.N <= 0 || ray.curvature >= 0) return false;
    const double step = -ray.slope / ray.curvature;
    if (std::abs(step) > 1) return false;
    if (std::abs(step) < kSettled) return true;
    theta += step;
  }
  return false;
}

// Where the slope changes from rising to falling between two angles: Newton's method kept inside by
// bisection.
Ray climb(const Matrix3& H, const Vector3& g, double mu, double low, double high) noexcept {
  Ray ray = evaluate(H, g, mu, (low + high) / 2);
  double theta = (low + high) / 2;
  for (int i = 0; i < 100 && high - low > 1e-16; ++i) {
    (ray.slope > 0 ? low : high) = theta;
    double next = theta - ray.slope / ray.curvature;
    if (!(next > low && next < high)) next = (low + high) / 2;
    if (next == theta) break;
    theta = next;
    ray = evaluate(H, g, mu, theta);
  }
  return ray;
}

// A minimum over the solid cone, not of its surface alone: the gradient points inwards.
bool is_solution(const Matrix3& H, const Vector3& g, const Ray& ray) noexcept {
  const Vector3 gradient = H * (ray.N / ray.D * ray.d) + g;
  return ray.N > 0 && gradient[0] >= -1e-12 * g.norm();
}

}  // namespace

Vector3 solve_cone_block(const Matrix3& H, const Vector3& g, double friction, const Vector3& start) noexcept {
  if (g[0] >= friction * std::hypot(g[1], g[2])) return Vector3::Zero();  // pushing apart already
  if (friction == 0) return {std::max(0.0, -g[0] / H(0, 0)), 0, 0};
  Vector3 free = -(H.inverse() * g);
  if (in_cone(free, friction)) return free;

  const bool warm = start[1] != 0 || start[2] != 0;
  const double guess = warm ? std::atan2(start[2], start[1]) : best_sample(H, g, friction, 8);
  Ray ray{};
  if (polish(H, g, friction, guess, ray) && is_solution(H, g, ray)) return ray.N / ray.D * ray.d;
  // The worth of a ray can have a narrow peak beside a broad one: look closer until the highest is found.
  for (const int samples : {32, 512, 8192}) {
    const double theta = best_sample(H, g, friction, samples), spacing = 2 * M_PI / samples;
    ray = climb(H, g, friction, theta - spacing, theta + spacing);
    if (is_solution(H, g, ray)) break;
  }
  return std::max(0.0, ray.N / ray.D) * ray.d;
}

ConeProblem::Sweep ConeProblem::sweep() noexcept {
  const Eigen::Index rows = 3 * contacts;
  Sweep result;
  for (int c = 0; c < contacts; ++c) {
    const Eigen::Index i = 3 * c;
    const Matrix3 H = A.block<3, 3>(i, i);
    const Vector3 old = x.segment<3>(i);
    Vector3 g = b.segment<3>(i) - H * old;
    // A is symmetric: its columns are contiguous, its rows are not.
    for (int k = 0; k < 3; ++k) g[k] += A.col(i + k).head(rows).dot(x.head(rows));
    const Vector3 next = solve_cone_block(H, g, friction, old);
    x.segment<3>(i) = next;
    result.change = std::max(result.change, (next - old).lpNorm<Eigen::Infinity>());
    result.largest = std::max(result.largest, next.lpNorm<Eigen::Infinity>());
  }
  return result;
}

ConeProblem::Sweep ConeProblem::sweep_coulomb() noexcept {
  const Eigen::Index rows = 3 * contacts;
  // A is symmetric: its columns are contiguous, its rows are not.
  const auto gradient = [&](Eigen::Index i) { return b[i] + A.col(i).head(rows).dot(x.head(rows)); };
  Sweep result;
  for (Eigen::Index i = 0; i < rows; i += 3) {
    const Vector3 old = x.segment<3>(i);
    x[i] = std::max(0.0, x[i] - gradient(i) / A(i, i));
    if (bound == FrictionBound::kDisc) {
      // One step size for both directions, or friction would not oppose slip.
      const double step = 1 / std::max(A(i + 1, i + 1), A(i + 2, i + 2));
      const double u = x[i + 1] - step * gradient(i + 1), v = x[i + 2] - step * gradient(i + 2);
      const double limit = friction * x[i], size = std::hypot(u, v);
      const double scale = size > limit ? limit / size : 1;
      x[i + 1] = scale * u;
      x[i + 2] = scale * v;
    } else {
      const bool given = bound == FrictionBound::kFrictionlessPyramid;
      const double limit = friction * (given ? frictionless_[static_cast<std::size_t>(i / 3)] : x[i]);
      for (Eigen::Index k = i + 1; k < i + 3; ++k)
        x[k] = std::clamp(x[k] - gradient(k) / A(k, k), -limit, limit);
    }
    result.change = std::max(result.change, (x.segment<3>(i) - old).lpNorm<Eigen::Infinity>());
    result.largest = std::max(result.largest, x.segment<3>(i).lpNorm<Eigen::Infinity>());
  }
  return result;
}

int ConeProblem::solve(double tolerance, int max_sweeps) noexcept {
  x.head(3 * contacts).setZero();
  for (int count = 1; count <= max_sweeps; ++count) {
    const auto [change, largest] = sweep();
    if (change <= tolerance * largest) return count;
  }
  return max_sweeps;
}

void ConeProblem::begin_coulomb(double tolerance, int max_sweeps) noexcept {
  if (bound != FrictionBound::kFrictionlessPyramid) return;
  frictionless_.fill(0);
  for (int count = 0; count < max_sweeps; ++count) {
    Sweep swept;
    for (int c = 0; c < contacts; ++c) {
      double gradient = b[3 * c];
      for (int k = 0; k < contacts; ++k)
        gradient += A(3 * k, 3 * c) * frictionless_[static_cast<std::size_t>(k)];
      double& impulse = frictionless_[static_cast<std::size_t>(c)];
      const double next = std::max(0.0, impulse - gradient / A(3 * c, 3 * c));
      swept.change = std::max(swept.change, std::abs(next - impulse));
      swept.largest = std::max(swept.largest, next);
      impulse = next;
    }
    if (swept.change <= tolerance * swept.largest) return;
  }
}

int ConeProblem::solve_coulomb(double tolerance, int max_sweeps) noexcept {
  x.head(3 * contacts).setZero();
  begin_coulomb(tolerance, max_sweeps);
  for (int count = 1; count <= max_sweeps; ++count) {
    const auto [change, largest] = sweep_coulomb();
    if (change <= tolerance * largest) return count;
  }
  return max_sweeps;
}

}  // namespace crossgait::contact
