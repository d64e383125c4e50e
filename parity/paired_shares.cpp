#include "parity/paired_shares.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "parity/distributions.h"

namespace crossgait {
namespace {

constexpr std::size_t kExact = 100;
constexpr int kShares = 200;  // of a grid over the nuisance share

// Tango's score of a table against a difference of `limit`: its distance in standard errors, with the share
// of the one discordant cell as likely as that difference allows (Tango 1998, equations 3 and 4).
double score(double n, double only_a, double only_b, double limit) {
  const double b = -only_a - only_b + (2 * n + only_a - only_b) * limit, c = -only_a * limit * (1 - limit);
  const double share = (std::sqrt(std::max(0.0, b * b - 8 * n * c)) - b) / (4 * n);
  const double variance = n * (2 * share + limit * (1 - limit)), gap = only_b - only_a - n * limit;
  if (variance <= 1e-12) return std::abs(gap) <= 1e-9 ? 0 : std::copysign(1e12, gap);
  return gap / std::sqrt(variance);
}

struct Discordant {
  std::size_t only_a, only_b;
};

// base^0 to base^most; a base that rounding takes below zero is zero.
std::vector<double> powers(double base, std::size_t most) {
  std::vector<double> result(most + 1, 1.0);
  for (std::size_t k = 1; k <= most; ++k) result[k] = result[k - 1] * std::max(0.0, base);
  return result;
}

// P value against "at most limit": of the tables that score as much or more, the probability at the limit,
// at the worst share of `a` alone.
double exact_p(std::size_t pairs, Discordant seen, double limit) {
  const auto n = static_cast<double>(pairs);
  constexpr double kTie = 1e-9;  // of scores that differ by rounding
  const double least =
      score(n, static_cast<double>(seen.only_a), static_cast<double>(seen.only_b), limit) - kTie;
  struct Table {
    Discordant seen;
    double ways;  // multinomial coefficient, 3^100 at most
  };
  std::vector<Table> tables;
  for (std::size_t a = 0; a <= pairs; ++a) {
    for (std::size_t b = 0; a + b <= pairs; ++b) {
      const auto x = static_cast<double>(a), y = static_cast<double>(b);
      if (score(n, x, y, limit) < least) continue;
      const double ways =
          std::lgamma(n + 1) - std::lgamma(x + 1) - std::lgamma(y + 1) - std::lgamma(n - x - y + 1);
      tables.push_back({{a, b}, std::exp(ways)});
    }
  }
  // Shares of `a` alone for which that of `b` alone, and of neither alone, are shares.
  const double from = std::max(0.0, -limit), to = (1 - limit) / 2;
  double worst = 0;
  for (int i = 0; i <= kShares; ++i) {
    const double share = from + (to - from) * i / kShares;
    const std::vector<double> a = powers(share, pairs), b = powers(share + limit, pairs),
                              neither = powers(1 - 2 * share - limit, pairs);
    double sum = 0;
    for (const auto& [seen_there, ways] : tables) {
      const auto [only_a, only_b] = seen_there;
      sum += ways * a[only_a] * b[only_b] * neither[pairs - only_a - only_b];
    }
    worst = std::max(worst, sum);
  }
  return std::min(1.0, worst);
}

// Where `p` of a rising function of the limit passes `tail`, between -1 and `high`.
template <typename P>
double bisect(const P& p, double tail, double high) {
  double low = -1;
  constexpr int kHalvings = 30;  // to 2e-9
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = (low + high) / 2;
    (p(middle) < tail ? low : high) = middle;
  }
  return low;
}

double wide_lower_limit(std::size_t pairs, Discordant seen, double tail) {
  return share_lower_limit(seen.only_b, pairs, tail / 2) - share_upper_limit(seen.only_a, pairs, tail / 2);
}

}  // namespace

PairedShares::PairedShares(std::size_t pairs, std::size_t only_a, std::size_t only_b)
    : pairs_(pairs), only_a_(only_a), only_b_(only_b) {}

double PairedShares::estimate() const noexcept {
  return (static_cast<double>(only_b_) - static_cast<double>(only_a_)) / static_cast<double>(pairs_);
}

double PairedShares::p_above(double limit) const {
  if (limit <= -1) return 0;
  if (limit >= 1) return 1;
  const Discordant seen{only_a_, only_b_};
  if (pairs_ <= kExact) return exact_p(pairs_, seen, limit);
  // The error at which the wide interval would begin at the limit.
  double low = 0, high = 1;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (wide_lower_limit(pairs_, seen, middle) > limit ? high : low) = middle;
  }
  return high;
}

double PairedShares::p_below(double limit) const {
  return PairedShares(pairs_, only_b_, only_a_).p_above(-limit);
}

bool PairedShares::rejects_at_most(double limit, double tail) const {
  if (pairs_ <= kExact) return p_above(limit) <= tail;
  return wide_lower_limit(pairs_, {only_a_, only_b_}, tail) > limit;
}

double PairedShares::lower_limit(double tail) const {
  if (pairs_ > kExact) return wide_lower_limit(pairs_, {only_a_, only_b_}, tail);
  return bisect([this](double limit) { return p_above(limit); }, tail, estimate());
}

Interval PairedShares::interval(double confidence) const {
  const double tail = (1 - confidence) / 2;
  return {estimate(), lower_limit(tail), -PairedShares(pairs_, only_b_, only_a_).lower_limit(tail)};
}

std::optional<std::size_t> PairedShares::enough(double margin, double tail_within, double tail_beyond) const {
  const auto n = static_cast<double>(pairs_);
  const bool inside = std::abs(estimate()) < margin;
  const auto fits = [&](std::size_t count) {
    const double times = static_cast<double>(count) / n;
    const auto a = static_cast<std::size_t>(std::lround(times * static_cast<double>(only_a_))),
               b = static_cast<std::size_t>(std::lround(times * static_cast<double>(only_b_)));
    const PairedShares up(count, a, b), down(count, b, a);
    if (inside) return up.rejects_at_most(-margin, tail_within) && down.rejects_at_most(-margin, tail_within);
    return up.rejects_at_most(margin, tail_beyond) || down.rejects_at_most(margin, tail_beyond);
  };
  for (std::size_t count = pairs_ + 1; count <= kMostStarts; count += std::max<std::size_t>(1, count / 16)) {
    if (fits(count)) return count;
  }
  return std::nullopt;
}

}  // namespace crossgait
