// The kinematics of one leg, whichever kind of leg it is, in one vocabulary.
#pragma once

#include <array>
#include <concepts>
#include <memory>
#include <span>
#include <string_view>
#include <variant>

#include "ik/closed_chain_leg.h"
#include "ik/five_bar_leg.h"
#include "ik/least_squares_leg.h"
#include "ik/serial_leg.h"

namespace crossgait {

enum class LegKind { kFiveBar, kSerial, kLeastSquares, kClosedChain };

/// Names a kind of leg: "five_bar", "serial", "least_squares", "closed_chain".
std::string_view name(LegKind kind) noexcept;

/// Angles of the driven joints, in the order tilt (if any), shoulder_left, shoulder_right or abduction (if
/// any), hip, knee (hip, abduction, knee where the hip comes first), and of the passive ones, elbow_left and
/// elbow_right, the knee and ankle that follow, or none; of a closed chain in that of LegModel; rad. Inline
/// storage.
using ServoVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3, 1>;
using PassiveVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxLegJoints, 1>;

struct LegPosture {
  ServoVector servos;
  PassiveVector passive;
};

/// Says which of the postures that put the foot on a target a leg takes. A leg goes by what it has: a
/// five-bar by `mode`, others by `knee`.
struct LegBranch {
  WorkingMode mode = kDefaultMode;
  KneeBranch knee = KneeBranch::kBackward;
};

struct LegInverse {
  IkStatus status = IkStatus::kOk;
  LegPosture posture;
};

struct LegForward {
  bool closed = true;              ///< false: the loops of the leg cannot be closed at these angles
  Vector3 foot = Vector3::Zero();  ///< foot centre in the leg frame, m
  PassiveVector passive;           ///< rad
};

/// d foot / d servos, m/rad, rows x, y, z of the leg frame, a column for each servo.
using LegJacobian = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 3>;

/// Holds the kinematics of a leg of any kind, as a value. Its functions are those of the kind (solve_leg,
/// solve_serial, solve_least_squares and so on), which say what they promise; `noexcept` and without
/// allocation. Vectors that are given have `servo_count` and `passive_count` numbers.
class LegKinematics {
 public:
  /// Makes the kinematics of a leg alone, without a robot: joints are numbered in the order of their roles.
  LegKinematics(const FiveBarGeometry& geometry, const LegModel& model = {}, LegBranch home = {});
  LegKinematics(const SerialLegGeometry& geometry, const SerialLegJoints& joints, LegBranch home = {})
      : LegKinematics(Kind(geometry), joints, home) {}
  LegKinematics(const LeastSquaresLegGeometry& geometry, const SerialLegJoints& joints, LegBranch home = {})
      : LegKinematics(Kind(geometry), joints, home) {}
  LegKinematics(const ClosedChainGeometry& geometry, const LegModel& model, LegBranch home = {});

  LegKind kind() const noexcept { return static_cast<LegKind>(leg_.index()); }
  /// Returns the geometry of its kind, or nullptr: `as<FiveBarGeometry>()`.
  template <typename Geometry>
  const Geometry* as() const noexcept {
    if constexpr (std::same_as<Geometry, ClosedChainGeometry>) {
      const auto* shared = std::get_if<SharedClosedChain>(&leg_);
      return shared == nullptr ? nullptr : shared->get();
    } else {
      return std::get_if<Geometry>(&leg_);
    }
  }

  /// Returns p_BL: origin of the leg frame in the base frame, m.
  const Vector3& origin() const noexcept;

  /// Returns the branch of the robot's home posture: what `inverse` and `forward` take unless told otherwise.
  LegBranch home_branch() const noexcept { return home_; }

  int servo_count() const noexcept { return servo_count_; }
  int passive_count() const noexcept { return passive_count_; }
  /// Returns indices into joint vectors, in the order of ServoVector and PassiveVector.
  std::span<const int> servo_joints() const noexcept {
    return {joints_.data(), static_cast<std::size_t>(servo_count_)};
  }
  std::span<const int> passive_joints() const noexcept {
    return {joints_.data() + servo_count_, static_cast<std::size_t>(passive_count_)};
  }

  /// @param target  foot centre in the leg frame (x forward, y left, z up: negative below the hip), m
  [[nodiscard]] LegInverse inverse(const Vector3& target, LegBranch branch) const noexcept;
  [[nodiscard]] LegInverse inverse(const Vector3& target) const noexcept { return inverse(target, home_); }
  /// @param branch  only a five-bar's `mode` counts: which way its linkage closes
  [[nodiscard]] LegForward forward(const ServoVector& servos, LegBranch branch) const noexcept;
  [[nodiscard]] LegForward forward(const ServoVector& servos) const noexcept {
    return forward(servos, home_);
  }
  LegJacobian jacobian(const LegPosture& posture) const noexcept;
  LegMargins margins(const LegPosture& posture) const noexcept;

 private:
  // Copies share it: it has vectors, and copying must not allocate.
  using SharedClosedChain = std::shared_ptr<const ClosedChainGeometry>;
  using Kind = std::variant<FiveBarGeometry, SerialLegGeometry, LeastSquaresLegGeometry,
                            SharedClosedChain>;  // as LegKind

  LegKinematics(const Kind& kind, const SerialLegJoints& joints, LegBranch home);

  // Of a five-bar, likewise.
  ServoAngles five_bar_servos(const ServoVector& servos) const noexcept {
    return servo_count_ == 3 ? ServoAngles{servos[0], servos[1], servos[2]}
                             : ServoAngles{0, servos[0], servos[1]};
  }
  LegAngles five_bar_angles(const LegPosture& posture) const noexcept {
    const ServoAngles servos = five_bar_servos(posture.servos);
    return {servos.tilt, servos.shoulder_left, servos.shoulder_right, posture.passive[0], posture.passive[1]};
  }
  // Of a serial leg: without an abduction joint its angle is zero and has no place in ServoVector.
  SerialAngles serial_angles(const ServoVector& servos) const noexcept {
    return servo_count_ == 3 ? SerialAngles{servos[0], servos[1], servos[2]}
                             : SerialAngles{0, servos[0], servos[1]};
  }
  LegJointAngles joint_angles(const ServoVector& servos) const noexcept {
    return {servos[0], servos[1], servo_count_ == 3 ? servos[2] : 0};
  }

  PassiveVector following_angles(const LegJointAngles& servos) const noexcept {
    const auto& g = *as<LeastSquaresLegGeometry>();
    PassiveVector angles(passive_count_);
    for (int i = 0; i < passive_count_; ++i) angles[i] = g.angle(servo_count_ + i, servos);
    return angles;
  }

  static ClosedChain::Angles all_angles(const LegPosture& posture) noexcept {
    ClosedChain::Angles angles(posture.servos.size() + posture.passive.size());
    angles << posture.servos, posture.passive;
    return angles;
  }

  Kind leg_;
  LegBranch home_;
  std::array<int, kMaxLegJoints> joints_{0, 1, 2, 3, 4, 5, 6, 7, 8, 9};  // servos, then passive joints
  int servo_count_ = 0, passive_count_ = 0;
};

/// Makes the kinematics of a leg of `robot`: a five-bar's; a serial leg's in closed form if its axes allow
/// (`is_serial_leg`), else, as a closed chain's, by least squares from the home posture. @throws ConfigError
/// as `five_bar_geometry`, `serial_leg_geometry`, `least_squares_leg_geometry` and `closed_chain_geometry`,
/// or if the robot has no legs
LegKinematics make_leg_kinematics(const RobotDescription& robot, Leg leg);
/// Makes those of a serial leg of a robot that does not say where its legs are.
LegKinematics make_leg_kinematics(const RobotDescription& robot, Leg leg, const SerialLegJoints& joints);

/// Makes the kinematics of all legs.
LegArray<LegKinematics> make_leg_kinematics(const RobotDescription& robot);

/// Returns p_BL of every leg: where gaits and velocity commands take the legs to be, m.
LegArray<Vector3> leg_origins(const LegArray<LegKinematics>& legs);
LegArray<Vector3> leg_origins(const RobotDescription& robot);

inline const Vector3& LegKinematics::origin() const noexcept {
  switch (kind()) {
    case LegKind::kFiveBar:
      return as<FiveBarGeometry>()->p_BL;
    case LegKind::kSerial:
      return as<SerialLegGeometry>()->p_BL;
    case LegKind::kClosedChain:
      return as<ClosedChainGeometry>()->p_BL;
    default:
      return as<LeastSquaresLegGeometry>()->p_BL;
  }
}

inline LegInverse LegKinematics::inverse(const Vector3& target, LegBranch branch) const noexcept {
  LegInverse result;
  result.posture.servos.resize(servo_count_);
  result.posture.passive.resize(passive_count_);
  ServoVector& servos = result.posture.servos;
  switch (kind()) {
    case LegKind::kFiveBar: {
      const auto [status, q] = solve_leg(*as<FiveBarGeometry>(), target, branch.mode);
      result.status = status;
      if (servo_count_ == 3) {
        servos << q.tilt, q.shoulder_left, q.shoulder_right;
      } else {
        servos << q.shoulder_left, q.shoulder_right;
      }
      result.posture.passive << q.elbow_left, q.elbow_right;
      break;
    }
    case LegKind::kSerial: {
      const auto [status, q] = solve_serial(*as<SerialLegGeometry>(), target, branch.knee);
      result.status = status;
      if (servo_count_ == 3) {
        servos << q.abduction, q.hip, q.knee;
      } else {
        servos << q.hip, q.knee;
      }
      break;
    }
    case LegKind::kLeastSquares: {
      const LeastSquaresSolution s = solve_least_squares(*as<LeastSquaresLegGeometry>(), target, branch.knee);
      result.status = s.status;
      servos = s.angles.head(servo_count_);
      result.posture.passive = following_angles(s.angles);
      break;
    }
    case LegKind::kClosedChain: {
      const ClosedChainSolution s = solve_closed_chain(*as<ClosedChainGeometry>(), target);
      result.status = s.status;
      servos = s.angles.head(servo_count_);
      result.posture.passive = s.angles.tail(passive_count_);
      break;
    }
  }
  return result;
}

inline LegForward LegKinematics::forward(const ServoVector& servos, LegBranch branch) const noexcept {
  LegForward result;
  result.passive.resize(passive_count_);
  switch (kind()) {
    case LegKind::kFiveBar: {
      const auto [tilt, left, right] = five_bar_servos(servos);
      const LegPosition p = forward_leg(*as<FiveBarGeometry>(), tilt, left, right, branch.mode);
      result.closed = p.closed;
      result.foot = p.foot;
      result.passive << p.elbow_left, p.elbow_right;
      break;
    }
    case LegKind::kSerial:
      result.foot = forward_serial(*as<SerialLegGeometry>(), serial_angles(servos));
      break;
    case LegKind::kLeastSquares:
      result.foot = forward_least_squares(*as<LeastSquaresLegGeometry>(), joint_angles(servos));
      result.passive = following_angles(joint_angles(servos));
      break;
    case LegKind::kClosedChain: {
      const auto& g = *as<ClosedChainGeometry>();
      const auto angles = follow_servos(g, servos);
      result.closed = angles.has_value();
      result.foot = g.chain.foot(angles.value_or(g.home)) - g.p_BL;
      result.passive = angles.value_or(g.home).tail(passive_count_);
      break;
    }
  }
  return result;
}

inline LegJacobian LegKinematics::jacobian(const LegPosture& posture) const noexcept {
  const ServoVector& q = posture.servos;
  switch (kind()) {
    case LegKind::kFiveBar:
      return leg_jacobian(*as<FiveBarGeometry>(), five_bar_angles(posture)).rightCols(servo_count_);
    case LegKind::kSerial:
      return serial_jacobian(*as<SerialLegGeometry>(), serial_angles(q)).rightCols(servo_count_);
    case LegKind::kClosedChain:
      return as<ClosedChainGeometry>()->chain.jacobian(all_angles(posture));
    default:
      return least_squares_jacobian(*as<LeastSquaresLegGeometry>(), joint_angles(q)).leftCols(servo_count_);
  }
}

inline LegMargins LegKinematics::margins(const LegPosture& posture) const noexcept {
  const ServoVector& q = posture.servos;
  switch (kind()) {
    case LegKind::kFiveBar:
      return leg_margins(*as<FiveBarGeometry>(), five_bar_angles(posture));
    case LegKind::kSerial:
      return serial_margins(*as<SerialLegGeometry>(), serial_angles(q));
    case LegKind::kClosedChain:
      return closed_chain_margins(*as<ClosedChainGeometry>(), all_angles(posture));
    default:
      return least_squares_margins(*as<LeastSquaresLegGeometry>(), joint_angles(q));
  }
}

}  // namespace crossgait
