#include "physics/robot_files/inference/five_bar_legs.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace crossgait {
namespace {

constexpr double kParallel = 0.999;  // cosine: to 2.6 degrees
constexpr double kOneAxis = 1e-6;    // m, of shoulders of which neither is behind

struct HalfLeg {
  int shoulder = 0, elbow = 0, parent = 0;
};

// The chain that ends in the body of a link: what it hangs on in steps of one joint.
std::optional<HalfLeg> half_of(const JointTree& tree, const std::string& link) {
  const auto placed = tree.robot().links.find(link);
  if (placed == tree.robot().links.end() || placed->second.body == 0) return std::nullopt;
  const int elbow = placed->second.body, shoulder = tree.body(elbow).parent;
  if (shoulder <= 0) return std::nullopt;
  return HalfLeg{shoulder, elbow, tree.body(shoulder).parent};
}

/// Whether a lower link ends where it is joined to the other one, as at a foot: a shin goes on behind its
/// rod.
bool ends_at(const JointTree& tree, const HalfLeg& half, const std::string& link, const Vector3& joined) {
  constexpr double kFoot = 1.35;  // of the way from the elbow: with a foot's radius
  const double way = (tree.point_of(link, joined).value() - tree.origin(half.elbow)).norm();
  return tree.reach_of(half.elbow) < kFoot * way;
}

std::optional<FoundLeg> five_bar_of(const JointTree& tree, const LinkLoop& loop) {
  const auto a = half_of(tree, loop.link_a), b = half_of(tree, loop.link_b);
  if (!a || !b || a->parent != b->parent || a->shoulder == b->shoulder) return std::nullopt;
  if (!ends_at(tree, *a, loop.link_a, loop.p_a) || !ends_at(tree, *b, loop.link_b, loop.p_b))
    return std::nullopt;
  for (const int body : {a->elbow, b->shoulder, b->elbow}) {
    if (std::abs(tree.axis(a->shoulder).dot(tree.axis(body))) < kParallel) return std::nullopt;
  }
  FoundLeg leg;
  leg.joints.linkage = LegLinkage::kFiveBar;
  leg.joints.servos = {a->shoulder, b->shoulder};
  leg.joints.followers = {a->elbow, b->elbow};
  if (a->parent != 0) {
    if (tree.body(a->parent).parent != 0) return std::nullopt;
    leg.joints.servos.insert(leg.joints.servos.begin(), a->parent);
  }
  leg.chain.bodies = leg.joints.servos;
  leg.chain.bodies.insert(leg.chain.bodies.end(), leg.joints.followers.begin(), leg.joints.followers.end());
  leg.chain.tips = 2;
  return leg;
}

/// How far ahead an elbow is of its shoulder, m.
double elbow_ahead(const JointTree& tree, const Matrix3& R_BA, int shoulder, int elbow) {
  const Joint& joint = tree.joint(shoulder);
  const auto home = tree.robot().home.find(joint.name);
  const double angle = home == tree.robot().home.end() ? (joint.lower + joint.upper) / 2 : home->second;
  const Vector3 upper = tree.origin(elbow) - tree.origin(shoulder);
  return R_BA.col(0).dot(Eigen::AngleAxisd(angle, tree.axis(shoulder)) * upper);
}

}  // namespace

std::optional<FoundLegs> five_bars_of(const JointTree& tree) {
  if (tree.robot().loops.size() != kLegCount) return std::nullopt;
  FoundLegs legs;
  std::set<int> used;
  for (std::size_t i = 0; i < legs.size(); ++i) {
    const auto leg = five_bar_of(tree, tree.robot().loops[i]);
    if (!leg || (i > 0 && leg->joints.servos.size() != legs[0].joints.servos.size())) return std::nullopt;
    for (const int body : leg->chain.bodies) {
      if (!used.insert(body).second) return std::nullopt;
    }
    legs[i] = *leg;
  }
  return legs;
}

void put_left_behind(const JointTree& tree, const Matrix3& R_BA, LegJoints& joints) {
  int &left = *(joints.servos.end() - 2), &right = joints.servos.back();
  int &elbow_left = joints.followers.front(), &elbow_right = joints.followers.back();
  double ahead = R_BA.col(0).dot(tree.origin(left) - tree.origin(right));
  if (std::abs(ahead) < kOneAxis)
    ahead = elbow_ahead(tree, R_BA, left, elbow_left) - elbow_ahead(tree, R_BA, right, elbow_right);
  if (ahead <= 0) return;
  std::swap(left, right);
  std::swap(elbow_left, elbow_right);
}

}  // namespace crossgait
