#include "physics/robot/closed_chain.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/QR>
#include <Eigen/SVD>
#include <fmt/format.h>

#include "physics/core/error.h"

namespace crossgait {
namespace {

constexpr int kIterations = 12;      // of Newton's method, which doubles its digits: from a step about three
constexpr double kClosed = 1e-12;    // m and rad
constexpr double kSettled = 1e-11;   // rad, of a last step: what is open then stays so
constexpr double kSmallStep = 0.1;   // rad, of a servo
constexpr double kLargeTurn = 0.6;   // rad, of a passive joint in one such step: next to a singularity
constexpr double kDependent = 1e-6;  // of the largest pivot: what moves nothing

std::size_t at(int i) { return static_cast<std::size_t>(i); }

}  // namespace

struct ClosedChain::Placed {
  std::array<Matrix3, kMaxLegJoints> R;
  std::array<Vector3, kMaxLegJoints> p, axis;  // in the base frame
};

ClosedChain::ClosedChain(const RobotDescription& robot, Leg leg) {
  const LegModel& model = (*robot.legs)[leg];
  const std::string element = fmt::format("legs.{}", name(leg));
  const std::vector<int> joints = model.joints();
  const auto fail = [&](const std::string& expected, const std::string& found) {
    throw ConfigError(robot.source, element, expected, found);
  };
  if (joints.size() > kMaxLegJoints)
    fail(fmt::format("at most {} joints", kMaxLegJoints), std::to_string(joints.size()));
  servos_ = static_cast<int>(model.servos.size());
  lower_ = upper_ = Angles::Zero(static_cast<Eigen::Index>(joints.size()));
  std::vector<int> order(joints.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
  std::ranges::sort(order, [&](int a, int b) { return joints[at(a)] < joints[at(b)]; });
  link_of_angle_.resize(joints.size());
  const auto link_of_body = [&](int body) {
    for (std::size_t i = 0; i < links_.size(); ++i) {
      if (joints[at(links_[i].angle)] + 1 == body) return static_cast<int>(i);
    }
    return body == 0 ? -1 : -2;
  };
  for (const int i : order) {
    const Body& body = robot.bodies[at(joints[at(i)] + 1)];
    const int parent = link_of_body(body.parent);
    if (parent == -2) fail("joints on the base or on each other", fmt::format("'{}'", body.joint.name));
    link_of_angle_[at(i)] = static_cast<int>(links_.size());
    lower_[i] = body.joint.lower, upper_[i] = body.joint.upper;
    links_.push_back({i, parent, body.X_PB.linear(), body.X_PB.translation(), body.joint.axis});
  }
  foot_link_ = link_of_body(model.foot_body);
  p_foot_ = model.p_BF;
  for (const LoopClosure& loop : robot.loops) {
    const int a = link_of_body(loop.body_a), b = link_of_body(loop.body_b);
    if (a < 0 && b < 0) continue;
    if (a == -2 || b == -2) fail("loops within the leg", fmt::format("'{}', which joins another", loop.name));
    loops_.push_back({a, b, loop.p_AP, loop.p_BP});
  }
  const auto place_of = [&](int joint) {
    const auto found = std::ranges::find(joints, joint);
    return found == joints.end() ? -1 : static_cast<int>(found - joints.begin());
  };
  for (const JointCoupling& coupling : robot.couplings) {
    const int follower = place_of(coupling.follower), leader = place_of(coupling.leader);
    if (follower < servos_) continue;  // of another leg, or two servos, which pull against each other
    if (leader < 0)
      fail("couplings within the leg", fmt::format("'{}'", robot.joint(coupling.follower).name));
    couplings_.push_back({follower, leader, coupling});
  }
  rows_ = static_cast<int>(3 * loops_.size() + couplings_.size());
  if (rows_ > kMaxRows)
    fail(fmt::format("loops and couplings of at most {} rows, 3 a loop", kMaxRows), std::to_string(rows_));
}

ClosedChain::Placed ClosedChain::place(const Angles& q) const noexcept {
  Placed placed;
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const Link& link = links_[i];
    const bool on_base = link.parent < 0;
    const Matrix3 R = on_base ? link.R : Matrix3(placed.R[at(link.parent)] * link.R);
    placed.p[i] = on_base ? link.p : Vector3(placed.p[at(link.parent)] + placed.R[at(link.parent)] * link.p);
    placed.axis[i] = R * link.axis;
    placed.R[i] = R * Eigen::AngleAxisd(q[link.angle], link.axis).toRotationMatrix();
  }
  return placed;
}

Vector3 ClosedChain::point(const Placed& placed, int link, const Vector3& p) const noexcept {
  return link < 0 ? p : Vector3(placed.p[at(link)] + placed.R[at(link)] * p);
}

ClosedChain::Rows ClosedChain::gaps(const Placed& placed, const Angles& q) const noexcept {
  Rows gaps(rows_);
  int row = 0;
  for (const Loop& loop : loops_) {
    gaps.segment<3>(row) = point(placed, loop.a, loop.p_a) - point(placed, loop.b, loop.p_b);
    row += 3;
  }
  for (const Coupling& c : couplings_) gaps[row++] = q[c.follower] - c.law.follower_at(q[c.leader]);
  return gaps;
}

template <typename ThreeRows>
void ClosedChain::add_point(const Placed& placed, int link, const Vector3& p, double sign,
                            ThreeRows rows) const noexcept {
  const Vector3 where = point(placed, link, p);
  for (int i = link; i >= 0; i = links_[at(i)].parent)
    rows.col(links_[at(i)].angle) += sign * placed.axis[at(i)].cross(where - placed.p[at(i)]);
}

ClosedChain::RowJacobian ClosedChain::gap_jacobian(const Placed& placed, const Angles& q) const noexcept {
  RowJacobian J = RowJacobian::Zero(rows_, lower_.size());
  int row = 0;
  for (const Loop& loop : loops_) {
    add_point(placed, loop.a, loop.p_a, 1, J.middleRows<3>(row));
    add_point(placed, loop.b, loop.p_b, -1, J.middleRows<3>(row));
    row += 3;
  }
  for (const Coupling& c : couplings_) {
    J(row, c.follower) += 1;
    J(row, c.leader) -= c.law.slope_at(q[c.leader]);
    ++row;
  }
  return J;
}

bool ClosedChain::close(Angles& q) const noexcept {
  const int passive = passive_count();
  for (int i = 0; i < kIterations; ++i) {
    const Placed placed = place(q);
    const Rows off = gaps(placed, q);
    if (!off.allFinite()) return false;
    if (off.size() == 0 || off.cwiseAbs().maxCoeff() < kClosed) return true;
    if (passive == 0) return false;
    const RowJacobian J = gap_jacobian(placed, q).rightCols(passive);
    const Eigen::ColPivHouseholderQR<RowJacobian> solver(J);
    const Angles step = solver.solve(off);
    const double largest = step.cwiseAbs().maxCoeff();
    if (!(largest < M_PI)) return false;
    if (largest < kSettled) return off.cwiseAbs().maxCoeff() < kLoopTolerance;
    q.tail(passive) -= step;
  }
  return false;
}

bool ClosedChain::move(const ServoAngles& servos, Angles& q) const noexcept {
  const int passive = passive_count();
  const ServoAngles way = servos - q.head(servos_);
  if (!way.allFinite()) return false;
  const double farthest = way.cwiseAbs().maxCoeff();
  const int steps = std::max(1, static_cast<int>(std::ceil(std::min(farthest, 1e3) / kSmallStep)));
  const ServoAngles start = q.head(servos_);
  for (int i = 1; i <= steps; ++i) {
    Angles next = q;
    const ServoAngles reached = i == steps ? servos : ServoAngles(start + way * (double(i) / steps));
    const ServoAngles step = reached - q.head(servos_);
    // Along the tangent first: Newton's method then starts next to its end.
    const RowJacobian J = gap_jacobian(place(q), q);
    if (rows_ > 0 && passive > 0) {
      const Eigen::ColPivHouseholderQR<RowJacobian> solver(RowJacobian(J.rightCols(passive)));
      next.tail(passive) -= solver.solve(Rows(J.leftCols(servos_) * step));
    }
    next.head(servos_) = reached;
    if (!next.allFinite() || !close(next)) return false;
    if (passive > 0 && (next - q).tail(passive).cwiseAbs().maxCoeff() > kLargeTurn) return false;
    q = next;
  }
  return true;
}

Vector3 ClosedChain::foot(const Angles& q) const noexcept { return point(place(q), foot_link_, p_foot_); }

Vector3 ClosedChain::origin(const Angles& q, int joint) const noexcept {
  return place(q).p[at(link_of_angle_[at(joint)])];
}

Vector3 ClosedChain::axis(const Angles& q, int joint) const noexcept {
  return place(q).axis[at(link_of_angle_[at(joint)])];
}

ClosedChain::FootJacobian ClosedChain::jacobian(const Angles& q) const noexcept {
  const int passive = passive_count();
  const Placed placed = place(q);
  Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kMaxJoints> of_foot =
      Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kMaxJoints>::Zero(3, lower_.size());
  add_point(placed, foot_link_, p_foot_, 1, of_foot.middleRows<3>(0));
  FootJacobian J = of_foot.leftCols(servos_);
  if (passive == 0 || rows_ == 0) return J;
  const RowJacobian rows = gap_jacobian(placed, q);
  const Eigen::ColPivHouseholderQR<RowJacobian> solver(RowJacobian(rows.rightCols(passive)));
  for (int k = 0; k < servos_; ++k)
    J.col(k) -= of_foot.rightCols(passive) * Angles(solver.solve(Rows(rows.col(k))));
  return J;
}

double ClosedChain::transmission(const Angles& q) const noexcept {
  const int passive = passive_count();
  if (passive < 2) return M_PI_2;
  RowJacobian J = gap_jacobian(place(q), q).rightCols(passive);
  for (int k = 0; k < passive; ++k) {
    const double size = J.col(k).norm();
    if (!(size > 0)) return 0;
    J.col(k) /= size;
  }
  // Two unit vectors at an angle t have the least singular value sqrt(1 - cos t) = sqrt(2) sin(t / 2).
  const double least = Eigen::JacobiSVD<RowJacobian>(J).singularValues().tail<1>().value();
  return 2 * std::asin(std::min(least / std::sqrt(2.0), std::sqrt(0.5)));
}

int ClosedChain::loose_joints(const Angles& q) const noexcept {
  const int passive = passive_count();
  if (passive == 0) return 0;
  if (rows_ == 0) return passive;
  Eigen::ColPivHouseholderQR<RowJacobian> solver;
  solver.setThreshold(kDependent);
  solver.compute(gap_jacobian(place(q), q).rightCols(passive));
  return passive - static_cast<int>(solver.rank());
}

double ClosedChain::reach() const noexcept {
  double reach = p_foot_.norm();
  for (int i = foot_link_; i >= 0 && links_[at(i)].parent >= 0; i = links_[at(i)].parent)
    reach += links_[at(i)].p.norm();
  return reach;
}

}  // namespace crossgait
