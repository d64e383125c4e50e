#include "physics/robot_files/inference/following_leg.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/LU>

#include "physics/robot/multibody.h"

namespace crossgait {
namespace {

constexpr int kGrid = 24;             // starts along each angle
constexpr int kIterations = 40;       // of Newton's method, from the nearest start about five are enough
constexpr double kReached = 1e-9;     // m
constexpr double kDifference = 1e-6;  // rad, of the derivative

}  // namespace

FollowingLeg::FollowingLeg(const RobotDescription& robot, Leg leg, double abduction)
    : robot_(robot), model_((*robot.legs)[leg]), count_(model_.linkage == LegLinkage::kKneeFollows ? 1 : 2) {
  searched_ = {model_.joint("hip"), model_.joint("knee")};
  state_.q = JointVector::Zero(robot.joint_count());
  state_.qd = state_.q;
  if (const int joint = model_.joint("abduction"); joint >= 0) state_.q[joint] = abduction;
}

FollowingLeg::Placed FollowingLeg::place(const Eigen::Vector2d& angles) {
  for (int i = 0; i < count_; ++i) state_.q[searched_[static_cast<std::size_t>(i)]] = angles[i];
  robot_.place_followers(state_.q);
  forward_kinematics(robot_, state_, poses_);
  const auto origin = [&](int joint) {
    return Vector3(poses_[static_cast<std::size_t>(joint) + 1].translation());
  };
  const Vector3 foot = poses_[static_cast<std::size_t>(model_.foot_body)] * model_.p_BF;
  return {foot - origin(searched_[0]), origin(searched_[1]) - origin(searched_[0])};
}

double FollowingLeg::hip_x() const {
  std::vector<Pose> poses;
  forward_kinematics(robot_, state_, poses);
  return poses[static_cast<std::size_t>(searched_[0]) + 1].translation().x();
}

LegLengths FollowingLeg::lengths() const {
  std::vector<Pose> poses;
  forward_kinematics(robot_, state_, poses);
  std::vector<Vector3> points;
  for (const char* role : {"hip", "knee", "ankle"}) {
    const int joint = model_.joint(role);
    if (joint >= 0) points.emplace_back(poses[static_cast<std::size_t>(joint) + 1].translation());
  }
  points.emplace_back(poses[static_cast<std::size_t>(model_.foot_body)] * model_.p_BF);
  LegLengths lengths;
  for (std::size_t i = 1; i < points.size(); ++i) {
    // What lies along the hip's axis, which is next to the base's y, is no length of the leg.
    const Vector3 link = points[i] - points[i - 1];
    (i == 1 ? lengths.thigh : lengths.shin) += std::hypot(link.x(), link.z());
  }
  return lengths;
}

int FollowingLeg::bend_of(const Placed& placed) const {
  return placed.knee.z() * placed.foot.x() - placed.knee.x() * placed.foot.z() > 0 ? 1 : -1;
}

bool FollowingLeg::is_within_limits() const {
  return std::ranges::all_of(model_.joints(), [this](int i) {
    return state_.q[i] >= robot_.joint(i).lower && state_.q[i] <= robot_.joint(i).upper;
  });
}

Eigen::Vector2d FollowingLeg::error(const Placed& placed, double depth, double forward) const {
  return {placed.foot.z() + depth, count_ == 1 ? 0 : placed.foot.x() - forward};
}

std::optional<Eigen::Vector2d> FollowingLeg::best_start(double depth, double forward, int bend) {
  const auto at = [this](int k, int step) {
    const Joint& joint = robot_.joint(searched_[static_cast<std::size_t>(k)]);
    const double lower = std::max(joint.lower, -M_PI), upper = std::min(joint.upper, M_PI);
    return lower + (upper - lower) * (step + 0.5) / kGrid;
  };
  std::optional<Eigen::Vector2d> best;
  double least = 0;
  for (int i = 0; i < kGrid; ++i) {
    for (int k = 0; k < (count_ == 1 ? 1 : kGrid); ++k) {
      const Eigen::Vector2d angles(at(0, i), count_ == 1 ? 0 : at(1, k));
      const Placed placed = place(angles);
      const double off = error(placed, depth, forward).norm();
      if (!is_within_limits() || bend_of(placed) != bend || (best && off >= least)) continue;
      best = angles;
      least = off;
    }
  }
  return best;
}

std::optional<std::vector<double>> FollowingLeg::stand(double depth, double forward, int bend) {
  const auto start = best_start(depth, forward, bend);
  if (!start) return std::nullopt;
  Eigen::Vector2d angles = *start;
  for (int i = 0; i < kIterations; ++i) {
    const Eigen::Vector2d off = error(place(angles), depth, forward);
    if (off.norm() < kReached / 10) break;
    Eigen::Matrix2d J = Eigen::Matrix2d::Identity();
    for (int k = 0; k < count_; ++k) {
      const Eigen::Vector2d step = kDifference * Eigen::Vector2d::Unit(k);
      J.col(k) = (error(place(angles + step), depth, forward) - error(place(angles - step), depth, forward)) /
                 (2 * kDifference);
    }
    angles -= J.inverse() * off;
  }
  if (!angles.allFinite()) return std::nullopt;
  const Placed placed = place(angles);
  if (!(error(placed, depth, forward).norm() < kReached)) return std::nullopt;
  if (!is_within_limits() || bend_of(placed) != bend) return std::nullopt;
  std::vector<double> servos;
  for (const int i : model_.servos) servos.push_back(state_.q[i]);
  return servos;
}

double FollowingLeg::forward_at(const std::vector<double>& angles) {
  for (std::size_t i = 0; i < angles.size(); ++i) state_.q[model_.servos[i]] = angles[i];
  Eigen::Vector2d searched = Eigen::Vector2d::Zero();
  for (int i = 0; i < count_; ++i) searched[i] = state_.q[searched_[static_cast<std::size_t>(i)]];
  return place(searched).foot.x();
}

}  // namespace crossgait
