#include "physics/robot_files/inference/leg_frame.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/robot_files/inference/leg_names.h"

namespace crossgait {
namespace {

// Axes this near to a direction count as along it: files written with two or three decimals are.
constexpr double kAxisRounding = 0.02;
constexpr double kLeastThigh = 0.1;     // of the diagonal of the hips: below it nothing is above or below
constexpr double kAboutVertical = 0.8;  // cosine: joints that turn a leg about the vertical, to 37 degrees

using Names = std::array<std::optional<Leg>, kLegCount>;

Vector3 towards_its_nearest_axis(Vector3 v) {
  Eigen::Index nearest = 0;
  v.cwiseAbs().maxCoeff(&nearest);
  return v[nearest] < 0 ? Vector3(-v) : v;
}

Eigen::SelfAdjointEigenSolver<Matrix3> spread_of(const std::vector<Vector3>& points, const Vector3& across) {
  Vector3 middle = Vector3::Zero();
  for (const Vector3& p : points) middle += p / static_cast<double>(points.size());
  Matrix3 spread = Matrix3::Zero();
  for (const Vector3& p : points) {
    Vector3 d = p - middle;
    d -= d.dot(across) * across;
    spread += d * d.transpose();
  }
  return Eigen::SelfAdjointEigenSolver<Matrix3>(spread);
}

class FrameOfLegs {
 public:
  FrameOfLegs(const JointTree& tree, const FoundLegs& legs) {
    for (const FoundLeg& leg : legs) {
      hips_.push_back(tree.origin(leg.joints.servos.front()));
      first_axes_.push_back(tree.axis(leg.joints.servos.front()));
      hips_middle_ += hips_.back() / kLegCount;
      knees_middle_ += tree.origin(leg.joints.knee()) / kLegCount;
      // The mean of the knees' axes: legs may be turned out a little, each to its side.
      const Vector3 knee = tree.axis(leg.joints.knee());
      lateral_ += knee.dot(lateral_) < 0 ? Vector3(-knee) : knee;
    }
    lateral_.normalize();
  }

  Matrix3 find(std::vector<Inference>& inferred) const {
    const auto hips = spread_of(hips_, Vector3::Zero());
    const Vector3 normal = hips.eigenvectors().col(0);
    const bool is_sprawling = std::ranges::all_of(
        first_axes_, [&](const Vector3& axis) { return std::abs(axis.dot(normal)) > kAboutVertical; });
    if (is_sprawling) return sprawling(normal, inferred);
    if (std::abs(std::abs(lateral_.y()) - 1) < kAxisRounding) {
      if (knees_are_above())
        return told(
            Vector3::UnitX(), -Vector3::UnitY(),
            "knees turn about y and lie above the hips: z points down; the sign of forward is a guess",
            inferred);
      inferred.push_back({"frame", "x forward, y left, z up", "knees turn about y, as REP-103 has it"});
      return Matrix3::Identity();
    }
    // Of the two signs of forward that of the file's nearest axis: it cannot be seen.
    const Vector3 forward = towards_its_nearest_axis(spread_of(hips_, lateral_).eigenvectors().col(2));
    Vector3 left = lateral_;
    if (forward.cross(left).dot(knees_middle_ - hips_middle_) > 0) left = -left;  // knees hang below
    return told(forward, left,
                "knees do not turn about y: forward is along the hips' main spread; its sign is a guess",
                inferred);
  }

 private:
  /// Whether knees lie up z from where legs begin, more than aside.
  bool knees_are_above() const {
    const Vector3 to_knees = knees_middle_ - hips_middle_;
    return to_knees.z() > std::max(to_knees.head<2>().norm(), kLeastThigh * spread_of_hips());
  }

  /// The diagonal of the box around where legs begin, m.
  double spread_of_hips() const {
    Vector3 low = hips_.front(), high = hips_.front();
    for (const Vector3& hip : hips_) low = low.cwiseMin(hip), high = high.cwiseMax(hip);
    return (high - low).norm();
  }

  /// Legs that turn about the normal of the hips' plane first: their knees say nothing of forward.
  Matrix3 sprawling(const Vector3& normal, std::vector<Inference>& inferred) const {
    if (std::abs(std::abs(normal.z()) - 1) < kAxisRounding) {
      inferred.push_back({"frame", "x forward, y left, z up",
                          "legs turn about z first (they sprawl), and nothing says otherwise"});
      return Matrix3::Identity();
    }
    const Vector3 up = towards_its_nearest_axis(normal);
    const Vector3 forward = towards_its_nearest_axis(spread_of(hips_, up).eigenvectors().col(2));
    return told(forward, up.cross(forward),
                "legs turn about it first (they sprawl): forward is along the hips' main spread; its sign is "
                "a guess",
                inferred);
  }

  static Matrix3 told(const Vector3& forward, const Vector3& left, const char* reason,
                      std::vector<Inference>& inferred) {
    Matrix3 R;
    R << forward, left, forward.cross(left);
    inferred.push_back({"frame",
                        fmt::format("forward ({:.2g}, {:.2g}, {:.2g}), up ({:.2g}, {:.2g}, {:.2g})", R(0, 0),
                                    R(1, 0), R(2, 0), R(0, 2), R(1, 2), R(2, 2)),
                        reason});
    return R;
  }

  std::vector<Vector3> hips_, first_axes_;
  Vector3 hips_middle_ = Vector3::Zero(), knees_middle_ = Vector3::Zero(), lateral_ = Vector3::Zero();
};

/// The quadrant of each leg around the middle of all.
std::array<Leg, kLegCount> quadrants(const JointTree& tree, const FoundLegs& legs, const Matrix3& R_BA) {
  std::array<Vector3, kLegCount> places;
  Vector3 middle = Vector3::Zero();
  for (std::size_t i = 0; i < legs.size(); ++i) {
    // Along by where the leg begins, for thighs point ahead or back at zero; across by its plane.
    const LegJoints& joints = legs[i].joints;
    const Vector3 first = R_BA.transpose() * tree.origin(joints.servos.front());
    places[i] = {first.x(), (R_BA.transpose() * tree.origin(joints.knee())).y(), 0};
    middle += places[i] / kLegCount;
  }
  std::array<Leg, kLegCount> all{};
  for (std::size_t i = 0; i < legs.size(); ++i) {
    const Vector3 p = places[i] - middle;
    all[i] = p.x() > 0 ? (p.y() > 0 ? Leg::FL : Leg::FR) : (p.y() > 0 ? Leg::RL : Leg::RR);
  }
  return all;
}

const std::string& first_joint(const JointTree& tree, const FoundLeg& leg) {
  return tree.joint(leg.joints.servos.front()).name;
}

Names names_of(const JointTree& tree, const FoundLegs& legs) {
  Names names;
  for (std::size_t i = 0; i < legs.size(); ++i) {
    for (const int joint : legs[i].chain.bodies) {
      if (!names[i]) names[i] = leg_in_name(tree.joint(joint).name);
    }
  }
  return names;
}

/// The turn about up, in right angles, that brings each leg into the quadrant that its name says; nothing if
/// no turn does.
std::optional<int> turn_of_names(const JointTree& tree, const FoundLegs& legs, const Names& names,
                                 const Matrix3& R_BA) {
  for (int turn = 0; turn < 4; ++turn) {
    const Matrix3 turned = R_BA * Eigen::AngleAxisd(turn * M_PI_2, Vector3::UnitZ()).toRotationMatrix();
    const std::array<Leg, kLegCount> places = quadrants(tree, legs, turned);
    bool all = true;
    for (std::size_t i = 0; i < legs.size(); ++i) all &= names[i] == places[i];
    if (all) return turn;
  }
  return std::nullopt;
}

}  // namespace

Vector3 normal_of_hips(const JointTree& tree, const std::vector<int>& hips) {
  std::vector<Vector3> points;
  for (const int hip : hips) points.push_back(tree.origin(hip));
  return spread_of(points, Vector3::Zero()).eigenvectors().col(0);
}

PlacedLegs place_legs(const JointTree& tree, const FoundLegs& legs, const std::optional<Matrix3>& given,
                      const std::string& source, std::vector<Inference>& inferred,
                      std::vector<std::string>& warnings) {
  PlacedLegs placed;
  placed.R_BA = given ? *given : FrameOfLegs(tree, legs).find(inferred);
  const Names names = names_of(tree, legs);
  if (const auto turn = turn_of_names(tree, legs, names, placed.R_BA); !given && turn && *turn > 0) {
    const Matrix3 turned =
        placed.R_BA * Eigen::AngleAxisd(*turn * M_PI_2, Vector3::UnitZ()).toRotationMatrix();
    // Of right angles nothing but zeros and ones.
    const Matrix3 R = turned.unaryExpr([](double v) { return std::abs(v) < 1e-15 ? 0.0 : v; });
    placed.R_BA = R;
    inferred.back() = {"frame",
                       fmt::format("forward ({:.2g}, {:.2g}, {:.2g}), up ({:.2g}, {:.2g}, {:.2g})", R(0, 0),
                                   R(1, 0), R(2, 0), R(0, 2), R(1, 2), R(2, 2)),
                       fmt::format("the names of all four legs say so, a turn of {} degrees from what their "
                                   "axes say",
                                   90 * *turn)};
  }
  const std::array<Leg, kLegCount> places = quadrants(tree, legs, placed.R_BA);
  for (std::size_t i = 0; i < legs.size(); ++i) {
    const Leg leg = places[i];
    if (placed.legs[leg] != nullptr) {
      throw ConfigError(source, "legs", "one leg in each quadrant around the middle of the hips",
                        fmt::format("'{}' and '{}' both {}", first_joint(tree, *placed.legs[leg]),
                                    first_joint(tree, legs[i]), name(leg)));
    }
    placed.legs[leg] = &legs[i];
    if (names[i] && *names[i] != leg) {
      warnings.push_back(fmt::format("joint '{}' is named as of {} and stands where {} is",
                                     first_joint(tree, legs[i]), name(*names[i]), name(leg)));
    }
  }
  return placed;
}

}  // namespace crossgait
