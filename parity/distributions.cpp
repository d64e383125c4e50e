#include "parity/distributions.h"

#include <cmath>
#include <initializer_list>

namespace crossgait {
namespace {

// Continued fraction of the incomplete beta function (Abramowitz and Stegun 26.5.8), by Lentz's method.
double beta_fraction(double x, double a, double b) {
  constexpr double kTiny = 1e-300, kSettled = 1e-15;
  const auto guard = [](double v) { return std::abs(v) < kTiny ? kTiny : v; };
  double c = 1, d = 1 / guard(1 - (a + b) * x / (a + 1)), h = d;
  for (int m = 1; m < 500; ++m) {
    for (const double numerator : {m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m)),
                                   -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1))}) {
      d = 1 / guard(1 + numerator * d);
      c = guard(1 + numerator / c);
      h *= c * d;
    }
    if (std::abs(c * d - 1) < kSettled) break;
  }
  return h;
}

double incomplete_beta(double x, double a, double b) {
  if (x <= 0 || x >= 1) return x <= 0 ? 0 : 1;
  if (x > (a + 1) / (a + b + 2)) return 1 - incomplete_beta(1 - x, b, a);  // where the fraction converges
  const double front =
      std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log1p(-x));
  return front * beta_fraction(x, a, b) / a;
}

}  // namespace

double student_tail(double t, double degrees) {
  if (t < 0) return 1 - student_tail(-t, degrees);
  return incomplete_beta(degrees / (degrees + t * t), degrees / 2, 0.5) / 2;
}

double student_quantile(double probability, double degrees) {
  if (probability < 0.5) return -student_quantile(1 - probability, degrees);
  const double tail = 1 - probability;
  double low = 0, high = 1;
  while (student_tail(high, degrees) > tail && high < 1e12) high *= 2;
  for (int i = 0; i < 200 && high - low > 1e-10 * high; ++i) {
    const double middle = (low + high) / 2;
    (student_tail(middle, degrees) > tail ? low : high) = middle;
  }
  return (low + high) / 2;
}

double binomial_tail(std::size_t successes, std::size_t trials, double share) {
  if (successes == 0) return 1;
  if (successes > trials) return 0;
  return incomplete_beta(share, static_cast<double>(successes), static_cast<double>(trials - successes) + 1);
}

double share_lower_limit(std::size_t successes, std::size_t trials, double tail) {
  if (successes == 0) return 0;
  double low = 0, high = 1;
  for (int i = 0; i < 100; ++i) {
    const double middle = (low + high) / 2;
    (binomial_tail(successes, trials, middle) < tail ? low : high) = middle;
  }
  return low;
}

double share_upper_limit(std::size_t successes, std::size_t trials, double tail) {
  return 1 - share_lower_limit(trials - successes, trials, tail);
}

}  // namespace crossgait
