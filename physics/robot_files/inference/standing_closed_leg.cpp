#include "physics/robot_files/inference/standing_closed_leg.h"

#include <algorithm>
#include <cmath>
#include <deque>

#include <Eigen/LU>
#include <fmt/format.h>

#include "physics/core/error.h"

namespace crossgait {
namespace {

constexpr int kMostSteps = 60;
constexpr double kStands = 1e-9;       // m
constexpr double kLargestStep = 0.2;   // rad
constexpr double kLeastTurned = 1e-9;  // m^2/rad^2: the foot cannot be moved both ways

}  // namespace

StandingClosedLeg::StandingClosedLeg(const RobotDescription& robot, Leg leg, double abduction)
    : model_((*robot.legs)[leg]), chain_(robot, leg) {
  const auto fail = [&](const std::string& expected, const std::string& found) {
    throw ConfigError(robot.source, fmt::format("legs.{}", name(leg)), expected, found);
  };
  zero_ = Angles::Zero(static_cast<Eigen::Index>(model_.joints().size()));
  hip_ = model_.place("hip"), knee_ = model_.place("knee");
  if (!chain_.close(zero_))
    fail("loops that close next to zero angles, or `home` in a robot.yaml", "open ones");
  if (const int loose = chain_.loose_joints(zero_); loose > 0)
    fail("loops that move every joint without a servo", fmt::format("{} that would move by itself", loose));
  const int turned = model_.place("abduction");
  for (int i = 0; i < chain_.servo_count() && searched_.size() < 2; ++i) {
    if (i != turned) searched_.push_back(i);
  }
  if (turned < 0 || turned >= chain_.servo_count()) return;
  ClosedChain::ServoAngles servos = zero_.head(chain_.servo_count());
  servos[turned] = abduction;
  chain_.move(servos, zero_);
}

double StandingClosedLeg::hip_x() const { return chain_.origin(zero_, hip_).x(); }

LegLengths StandingClosedLeg::lengths() const {
  const Vector3 hip = chain_.origin(zero_, hip_), knee = chain_.origin(zero_, knee_);
  const auto across = [](const Vector3& link) { return std::hypot(link.x(), link.z()); };
  LegLengths lengths{across(knee - hip), 0};
  Vector3 from = knee;
  if (model_.joint("ankle") >= 0) {
    const Vector3 ankle = chain_.origin(zero_, model_.place("ankle"));
    lengths.shin += across(ankle - from);
    from = ankle;
  }
  lengths.shin += across(chain_.foot(zero_) - from);
  return lengths;
}

Vector3 StandingClosedLeg::foot_from_hip(const Angles& q) const {
  return chain_.foot(q) - chain_.origin(q, hip_);
}

Eigen::Vector2d StandingClosedLeg::error(const Angles& q, double depth, double forward) const {
  const Vector3 foot = foot_from_hip(q);
  return {foot.z() + depth, searched_.size() == 1 ? 0 : foot.x() - forward};
}

int StandingClosedLeg::bend_of(const Angles& q) const {
  const Vector3 foot = foot_from_hip(q), knee = chain_.origin(q, knee_) - chain_.origin(q, hip_);
  return knee.z() * foot.x() - knee.x() * foot.z() > 0 ? 1 : -1;
}

double StandingClosedLeg::cell_angle(int searched, int cell) const {
  const int servo = searched_[static_cast<std::size_t>(searched)];
  const double lower = std::max(chain_.lower()[servo], -M_PI), upper = std::min(chain_.upper()[servo], M_PI);
  return lower + (upper - lower) * (cell + 0.5) / kGrid;
}

bool StandingClosedLeg::move_to(int u, int v, Angles& q) const {
  ClosedChain::ServoAngles servos = q.head(chain_.servo_count());
  servos[searched_[0]] = cell_angle(0, u);
  if (searched_.size() > 1) servos[searched_[1]] = cell_angle(1, v);
  return chain_.move(servos, q);
}

// From cell to cell next to it, as far as the loops follow.
void StandingClosedLeg::explore() {
  explored_ = true;
  const int across = searched_.size() > 1 ? kGrid : 1;
  cells_.resize(static_cast<std::size_t>(kGrid * across));
  const auto cell = [this](int u, int v) -> std::optional<Angles>& {
    return cells_[static_cast<std::size_t>(u + kGrid * v)];
  };
  const auto nearest = [this](int searched) {
    int best = 0;
    for (int i = 0; i < kGrid; ++i) {
      if (std::abs(cell_angle(searched, i)) < std::abs(cell_angle(searched, best))) best = i;
    }
    return best;
  };
  std::deque<std::array<int, 2>> next;
  const std::array<int, 2> first{nearest(0), across > 1 ? nearest(1) : 0};
  Angles start = zero_;
  if (!move_to(first[0], first[1], start)) return;
  cell(first[0], first[1]) = start;
  next.push_back(first);
  while (!next.empty()) {
    const auto [u, v] = next.front();
    next.pop_front();
    for (const auto& [du, dv] : {std::array{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      const int to_u = u + du, to_v = v + dv;
      if (to_u < 0 || to_u >= kGrid || to_v < 0 || to_v >= across || cell(to_u, to_v)) continue;
      Angles q = *cell(u, v);
      if (!move_to(to_u, to_v, q)) continue;
      cell(to_u, to_v) = q;
      next.push_back({to_u, to_v});
    }
  }
}

std::optional<ClosedChain::Angles> StandingClosedLeg::best_start(double depth, double forward,
                                                                 int bend) const {
  std::optional<Angles> best;
  double least = 0;
  for (const auto& q : cells_) {
    if (!q || !chain_.is_within_limits(*q) || bend_of(*q) != bend) continue;
    const double off = error(*q, depth, forward).norm();
    if (best && off >= least) continue;
    best = q;
    least = off;
  }
  return best;
}

std::optional<ClosedChain::Angles> StandingClosedLeg::settle(Angles q, double depth, double forward) const {
  for (int i = 0; i < kMostSteps; ++i) {
    const Eigen::Vector2d off = error(q, depth, forward);
    if (off.norm() < kStands / 10) return q;
    const ClosedChain::FootJacobian of_foot = chain_.jacobian(q);
    Eigen::Matrix2d J = Eigen::Matrix2d::Identity();
    for (std::size_t k = 0; k < searched_.size(); ++k) {
      const auto column = static_cast<Eigen::Index>(k);
      J(0, column) = of_foot(2, searched_[k]);
      J(1, column) = searched_.size() == 1 ? 0 : of_foot(0, searched_[k]);
    }
    if (std::abs(J.determinant()) < kLeastTurned) return std::nullopt;
    Eigen::Vector2d step = J.inverse() * off;
    step *= std::min(1.0, kLargestStep / step.cwiseAbs().maxCoeff());
    ClosedChain::ServoAngles servos = q.head(chain_.servo_count());
    for (std::size_t k = 0; k < searched_.size(); ++k)
      servos[searched_[k]] -= step[static_cast<Eigen::Index>(k)];
    if (!chain_.move(servos, q)) return std::nullopt;
  }
  return error(q, depth, forward).norm() < kStands ? std::optional(q) : std::nullopt;
}

std::optional<std::vector<double>> StandingClosedLeg::stand(double depth, double forward, int bend) {
  if (!explored_) explore();
  const auto start = best_start(depth, forward, bend);
  const auto q = start ? settle(*start, depth, forward) : std::nullopt;
  if (!q || !chain_.is_within_limits(*q) || bend_of(*q) != bend) return std::nullopt;
  return std::vector<double>(q->begin(), q->end());
}

double StandingClosedLeg::forward_at(const std::vector<double>& angles) const {
  return foot_from_hip(
             Eigen::Map<const Eigen::VectorXd>(angles.data(), static_cast<Eigen::Index>(angles.size())))
      .x();
}

}  // namespace crossgait
