#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "physics/core/error.h"
#include "physics/robot_files/inference/robot_inference.h"

namespace crossgait {
namespace {

// Axes this near to a direction count as along it: files written with two or three decimals are.
constexpr double kAxisRounding = 0.02;
constexpr std::size_t kMostServos = 3;

struct Branch {
  std::vector<int> bodies;  // in the file's order: the first hangs on the base
  int tips = 0;
  std::vector<std::array<int, 3>> axes;  // |axis| in the base frame at zero angles, rounded
};

class Tree {
 public:
  explicit Tree(const ParsedRobot& robot) : robot_(robot), poses_(robot.bodies.size(), Pose::Identity()) {
    for (std::size_t i = 1; i < robot.bodies.size(); ++i)
      poses_[i] = poses_[static_cast<std::size_t>(robot.bodies[i].parent)] * robot.bodies[i].X_PB;
  }

  const Body& body(int i) const { return robot_.bodies[static_cast<std::size_t>(i)]; }
  Vector3 origin(int i) const { return poses_[static_cast<std::size_t>(i)].translation(); }
  Vector3 axis(int i) const { return poses_[static_cast<std::size_t>(i)].linear() * body(i).joint.axis; }

  std::vector<Branch> branches() const {
    std::vector<Branch> all;
    std::vector<int> of(robot_.bodies.size(), -1);  // the branch that each body belongs to
    for (std::size_t i = 1; i < robot_.bodies.size(); ++i) {
      const auto parent = static_cast<std::size_t>(robot_.bodies[i].parent);
      if (parent == 0) {
        of[i] = static_cast<int>(all.size());
        all.emplace_back();
      } else {
        of[i] = of[parent];
      }
      Branch& branch = all[static_cast<std::size_t>(of[i])];
      const auto index = static_cast<int>(i);
      branch.bodies.push_back(index);
      const Vector3 a = axis(index).cwiseAbs();
      const auto rounded = [](double v) { return static_cast<int>(std::lround(10 * v)); };
      branch.axes.push_back({rounded(a.x()), rounded(a.y()), rounded(a.z())});
      const bool has_child = std::any_of(robot_.bodies.begin(), robot_.bodies.end(),
                                         [index](const Body& other) { return other.parent == index; });
      branch.tips += !has_child;
    }
    return all;
  }

 private:
  const ParsedRobot& robot_;
  std::vector<Pose> poses_;
};

std::string listed(const Tree& tree, const std::vector<Branch>& branches) {
  std::vector<std::string> texts;
  for (const Branch& b : branches)
    texts.push_back(fmt::format("{} joint{} from '{}'", b.bodies.size(), b.bodies.size() == 1 ? "" : "s",
                                tree.body(b.bodies.front()).joint.name));
  return texts.empty() ? "none that moves" : fmt::format("{}", fmt::join(texts, ", "));
}

/// The four that are alike; of several fours those with most joints.
std::vector<Branch> four_alike(const Tree& tree, const std::string& source) {
  const std::vector<Branch> all = tree.branches();
  std::map<std::tuple<std::size_t, int, std::vector<std::array<int, 3>>>, std::vector<Branch>> groups;
  for (const Branch& b : all) groups[{b.bodies.size(), b.tips, b.axes}].push_back(b);
  const std::vector<Branch>* legs = nullptr;
  for (const auto& [signature, group] : groups) {
    if (group.size() == 4) legs = &group;  // ascending: the last one has most joints
    if (group.size() == 8 && group[0].bodies.size() == 2) {
      throw ConfigError(source, "legs",
                        "in a robot.yaml beside it `legs` (tilt, shoulder_left, shoulder_right, elbow_left, "
                        "elbow_right, foot) and `loops` (models/README.md)",
                        "eight chains of two joints, of which no one can tell how they make four legs");
    }
  }
  if (legs == nullptr) {
    throw ConfigError(source, "legs",
                      "four branches of the base that are alike, or a robot.yaml that names them",
                      listed(tree, all));
  }
  const Branch& leg = legs->front();
  const std::string first = tree.body(leg.bodies.front()).joint.name;
  if (leg.tips != 1)
    throw ConfigError(source, fmt::format("legs, from '{}'", first), "chains", "legs that branch");
  if (leg.bodies.size() < 2 || leg.bodies.size() > kMostServos) {
    throw ConfigError(source, fmt::format("legs, from '{}'", first),
                      "2 or 3 moving joints in each: (abduction,) hip, knee",
                      std::to_string(leg.bodies.size()));
  }
  return *legs;
}

/// Forward, left and up of a robot whose knees turn about `lateral` (the file's base frame).
Matrix3 frame_of(const Tree& tree, const std::vector<Branch>& legs, std::vector<Inference>& inferred) {
  const Vector3 lateral = tree.axis(legs.front().bodies.back());
  if (std::abs(std::abs(lateral.y()) - 1) < kAxisRounding) {
    inferred.push_back({"frame", "x forward, y left, z up", "knees turn about y, as REP-103 has it"});
    return Matrix3::Identity();
  }
  Vector3 middle = Vector3::Zero(), feet = Vector3::Zero();
  for (const Branch& leg : legs) {
    middle += tree.origin(leg.bodies.front()) / 4;
    feet += tree.origin(leg.bodies.back()) / 4;
  }
  Matrix3 spread = Matrix3::Zero();
  for (const Branch& leg : legs) {
    Vector3 d = tree.origin(leg.bodies.front()) - middle;
    d -= d.dot(lateral) * lateral;
    spread += d * d.transpose();
  }
  Vector3 forward = Eigen::SelfAdjointEigenSolver<Matrix3>(spread).eigenvectors().col(2);
  // Of the two signs that of the file's nearest axis: it cannot be seen.
  Eigen::Index nearest = 0;
  forward.cwiseAbs().maxCoeff(&nearest);
  if (forward[nearest] < 0) forward = -forward;
  Vector3 left = lateral;
  if (const Vector3 up = forward.cross(left); up.dot(feet - middle) > 0) left = -left;  // knees hang below
  Matrix3 R;
  R << forward, left, forward.cross(left);
  inferred.push_back(
      {"frame",
       fmt::format("forward ({:.2g}, {:.2g}, {:.2g}), up ({:.2g}, {:.2g}, {:.2g})", R(0, 0), R(1, 0), R(2, 0),
                   R(0, 2), R(1, 2), R(2, 2)),
       "knees do not turn about y: forward is along the hips' main spread; its sign is a guess"});
  return R;
}

/// What a joint's name says of the leg it belongs to: FL, LF, front_left, HL, LH, rear_left...
std::optional<Leg> leg_in_name(std::string name) {
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const auto has = [&](std::string_view part) { return name.find(part) != std::string::npos; };
  const bool front = has("front"), rear = has("rear") || has("hind") || has("back");
  if (front != rear && has("left") != has("right")) {
    if (front) return has("left") ? Leg::FL : Leg::FR;
    return has("left") ? Leg::RL : Leg::RR;
  }
  static const std::map<std::string_view, Leg> kShort{
      {"fl", Leg::FL}, {"lf", Leg::FL}, {"fr", Leg::FR}, {"rf", Leg::FR}, {"rl", Leg::RL}, {"lr", Leg::RL},
      {"hl", Leg::RL}, {"lh", Leg::RL}, {"rr", Leg::RR}, {"hr", Leg::RR}, {"rh", Leg::RR}};
  const std::string_view begin = std::string_view(name).substr(0, 2);
  const bool alone =
      name.size() == 2 || (name.size() > 2 && !std::isalpha(static_cast<unsigned char>(name[2])));
  const auto known = kShort.find(begin);
  return alone && known != kShort.end() ? std::optional(known->second) : std::nullopt;
}

}  // namespace

LegSearch find_legs(const ParsedRobot& robot, const std::string& source, std::vector<Inference>& inferred,
                    std::vector<std::string>& warnings) {
  const Tree tree(robot);
  const std::vector<Branch> branches = four_alike(tree, source);
  LegSearch search;
  search.R_BA = frame_of(tree, branches, inferred);
  Vector3 middle = Vector3::Zero();
  const auto place = [&](const Branch& b) {
    const Vector3 first = tree.origin(b.bodies.front()), knee = tree.origin(b.bodies.back());
    // Along by where the leg begins, for thighs point ahead or back at zero; across by its plane.
    const Vector3 p = search.R_BA.transpose() * first;
    return Vector3(p.x(), (search.R_BA.transpose() * knee).y(), p.z());
  };
  for (const Branch& b : branches) middle += place(b) / kLegCount;
  std::set<std::string> used;
  for (const Branch& b : branches) {
    const Vector3 p = place(b) - middle;
    const Leg leg = p.x() > 0 ? (p.y() > 0 ? Leg::FL : Leg::FR) : (p.y() > 0 ? Leg::RL : Leg::RR);
    if (!search.legs[leg].empty()) {
      throw ConfigError(source, "legs", "one leg in each quadrant around the middle of the hips",
                        fmt::format("'{}' and '{}' both {}", search.legs[leg].front(),
                                    tree.body(b.bodies.front()).joint.name, name(leg)));
    }
    for (const int body : b.bodies) {
      search.legs[leg].push_back(tree.body(body).joint.name);
      used.insert(search.legs[leg].back());
    }
    const std::optional<Leg> named = leg_in_name(search.legs[leg].front());
    if (named && *named != leg) {
      warnings.push_back(fmt::format("joint '{}' is named as of {} and stands where {} is",
                                     search.legs[leg].front(), name(*named), name(leg)));
    }
  }
  for (const Leg leg : kLegs) {
    inferred.push_back({fmt::format("legs.{}", name(leg)),
                        fmt::format("{}", fmt::join(search.legs[leg], ", ")),
                        "one of four alike branches of the base, by the quadrant of its hip"});
  }
  for (std::size_t i = 1; i < robot.bodies.size(); ++i) {
    const std::string& joint = robot.bodies[i].joint.name;
    if (used.count(joint) == 0) search.locked.insert(joint);
  }
  if (!search.locked.empty()) {
    inferred.push_back(
        {"locked", fmt::format("{}", fmt::join(search.locked, ", ")), "joints of no leg, held at zero"});
  }
  return search;
}

}  // namespace crossgait
