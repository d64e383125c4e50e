#include "backends/physx/coupled_joints.h"

#include <algorithm>
#include <cmath>

#include "physics/robot/multibody.h"

namespace crossgait::physx {
namespace {

constexpr int kMostTries = 12;
constexpr int kFewTries = 3;        // after which what is below is enough
constexpr double kRounding = 1e-6;  // of angles, rad, relative beyond one: eight of float32
constexpr double kClose = 0.2;      // of that: two roundings, which few tries reach where nothing touches

RobotState at_home(const RobotDescription& robot) {
  RobotState state;
  state.q = robot.home;
  state.qd = JointVector::Zero(robot.joint_count());
  return state;
}

}  // namespace

CoupledJoints::CoupledJoints(const WorldSpec& spec) : couplings_(spec.robot->couplings) {
  const auto count = static_cast<Eigen::Index>(couplings_.size());
  if (count == 0) return;
  Eigen::MatrixXd M = mass_matrix(*spec.robot, at_home(*spec.robot));
  const Eigen::Index joints = spec.robot->joint_count();
  if (spec.fixed_base) M = M.bottomRightCorner(joints, joints).eval();
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(count, M.rows());
  const Eigen::Index first = M.rows() - joints;
  for (Eigen::Index i = 0; i < count; ++i) {
    const JointCoupling& coupling = couplings_[static_cast<std::size_t>(i)];
    C(i, first + coupling.follower) = 1;
    C(i, first + coupling.leader) = -coupling.slope_at(spec.robot->home[coupling.leader]);
  }
  inverse_ = inverse_of_free_ = (std::pow(spec.physics_dt, 2) * C * M.llt().solve(C.transpose())).inverse();
  slopes_ = torques_ = best_ = gaps_of_best_ = Vector::Zero(count);
}

void CoupledJoints::forget() noexcept {
  torques_.setZero();
  inverse_ = inverse_of_free_;
}

void CoupledJoints::begin(const JointVector& angles) noexcept {
  for (Eigen::Index i = 0; i < slopes_.size(); ++i) {
    const JointCoupling& coupling = couplings_[static_cast<std::size_t>(i)];
    slopes_[i] = coupling.slope_at(angles[coupling.leader]);
  }
  tries_ = 0;
}

void CoupledJoints::add_torques(JointVector& torques) const noexcept {
  for (Eigen::Index i = 0; i < torques_.size(); ++i) {
    const JointCoupling& coupling = couplings_[static_cast<std::size_t>(i)];
    torques[coupling.follower] += torques_[i];
    torques[coupling.leader] -= slopes_[i] * torques_[i];
  }
}

bool CoupledJoints::settle(const JointVector& angles) noexcept {
  Vector gaps(torques_.size());
  for (Eigen::Index i = 0; i < gaps.size(); ++i) {
    const JointCoupling& coupling = couplings_[static_cast<std::size_t>(i)];
    gaps[i] = angles[coupling.follower] - coupling.follower_at(angles[coupling.leader]);
  }
  const double enough = kRounding * std::max(1.0, angles.lpNorm<Eigen::Infinity>());
  if (++tries_ > kMostTries ||
      gaps.lpNorm<Eigen::Infinity>() <= (tries_ > kFewTries ? enough : kClose * enough))
    return true;
  if (tries_ > 1) learn(torques_ - best_, gaps - gaps_of_best_);
  if (tries_ == 1 || gaps.squaredNorm() < gaps_of_best_.squaredNorm()) {
    best_ = torques_;
    gaps_of_best_ = gaps;
  }
  if (tries_ < kMostTries) {
    torques_ = best_ - inverse_ * gaps_of_best_;
    return false;
  }
  inverse_ = inverse_of_free_;
  if (torques_ == best_) return true;
  torques_ = best_;
  return false;
}

void CoupledJoints::save(std::vector<double>& numbers) const {
  numbers.insert(numbers.end(), torques_.begin(), torques_.end());
  numbers.insert(numbers.end(), inverse_.data(), inverse_.data() + inverse_.size());
}

void CoupledJoints::restore(const double* numbers) {
  std::copy_n(numbers, torques_.size(), torques_.begin());
  std::copy_n(numbers + torques_.size(), inverse_.size(), inverse_.data());
}

void CoupledJoints::learn(const Vector& change, const Vector& effect) noexcept {
  const Vector by_inverse = inverse_ * effect;
  const double scale = change.dot(by_inverse);
  // Where contacts come and go between two tries their difference can say nothing of the inverse.
  if (std::abs(scale) > 1e-3 * change.squaredNorm())
    inverse_ += (change - by_inverse) * (change.transpose() * inverse_) / scale;
}

}  // namespace crossgait::physx
