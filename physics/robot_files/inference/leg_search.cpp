#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "physics/core/error.h"
#include "physics/robot_files/inference/five_bar_legs.h"
#include "physics/robot_files/inference/leg_frame.h"
#include "physics/robot_files/inference/leg_roles.h"
#include "physics/robot_files/inference/leg_tree.h"
#include "physics/robot_files/inference/robot_inference.h"

namespace crossgait {
namespace {

// Directions (cosines) that differ by less are alike: legs of one robot may be written by hand, or mirrored.
constexpr double kAlike = 0.1;

using Chains = std::vector<JointChain>;
using AreAlike = std::function<bool(const JointChain&, const JointChain&)>;

/// What tells two chains with equally many joints apart: the largest difference of the angles between their
/// axes, and between which joints it is.
struct Unlikeness {
  double most = 0;
  std::size_t i = 0, j = 0;
  double angle_a = 0, angle_b = 0;  // rad
};

Unlikeness unlikeness(const JointTree& tree, const std::vector<int>& a, const std::vector<int>& b) {
  Unlikeness found;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = i + 1; j < a.size(); ++j) {
      const auto cosine = [&](const std::vector<int>& chain) {
        return std::min(1.0, std::abs(tree.axis(chain[i]).dot(tree.axis(chain[j]))));
      };
      const double of_a = cosine(a), of_b = cosine(b), difference = std::abs(of_a - of_b);
      if (difference >= found.most) found = {difference, i, j, std::acos(of_a), std::acos(of_b)};
    }
  }
  return found;
}

bool have_one_shape(const JointChain& a, const JointChain& b) {
  return a.bodies.size() == b.bodies.size() && a.tips == b.tips;
}

std::vector<Chains> groups_of(const Chains& chains, const AreAlike& are_alike) {
  std::vector<Chains> groups;
  for (const JointChain& chain : chains) {
    const auto group =
        std::ranges::find_if(groups, [&](const Chains& other) { return are_alike(other.front(), chain); });
    group == groups.end() ? groups.push_back({chain}) : group->push_back(chain);
  }
  std::ranges::stable_sort(groups, [](const Chains& a, const Chains& b) {
    return a.front().bodies.size() > b.front().bodies.size();
  });
  return groups;
}

Vector3 normal_of(const JointTree& tree, const Chains& chains) {
  std::vector<int> hips;
  for (const JointChain& chain : chains) hips.push_back(chain.bodies.front());
  return normal_of_hips(tree, hips);
}

class LegFinder {
 public:
  LegFinder(const JointTree& tree, const std::string& source)
      : tree_(tree), source_(source), branches_(tree.branches()), ends_(tree.ends()) {}

  FoundLegs find() const {
    if (const auto legs = five_bars_of(tree_)) return *legs;
    refuse_eight_chains();
    const AreAlike by_directions = [this](const JointChain& a, const JointChain& b) {
      return have_one_shape(a, b) && point_alike(a, b);
    };
    const AreAlike by_angles = [this](const JointChain& a, const JointChain& b) {
      return have_one_shape(a, b) && unlikeness(tree_, a.bodies, b.bodies).most < kAlike;
    };
    if (const auto legs = first_four(groups_of(branches_, by_directions))) return *legs;
    if (const auto legs = first_four(groups_of(branches_, by_angles))) return *legs;
    // Legs in pairs on a spine: what hangs on no more than two bodies.
    if (const auto legs = first_four(groups_of(ends_, by_angles))) return *legs;
    if (const auto legs = first_four(groups_of(ends_, alike_in_their_roles()))) return *legs;
    refuse(groups_of(branches_, by_directions));
  }

 private:
  bool point_alike(const JointChain& a, const JointChain& b) const {
    for (std::size_t i = 0; i < a.bodies.size(); ++i) {
      const Vector3 difference = tree_.axis(a.bodies[i]).cwiseAbs() - tree_.axis(b.bodies[i]).cwiseAbs();
      if (difference.cwiseAbs().maxCoeff() > kAlike) return false;
    }
    return true;
  }

  /// Two legs with an ankle and two without are alike in the joints that have a role.
  AreAlike alike_in_their_roles() const {
    const Vector3 up = normal_of(tree_, ends_);
    return [this, up](const JointChain& a, const JointChain& b) {
      const auto of_a = roles_of(tree_, a, up), of_b = roles_of(tree_, b, up);
      return of_a && of_b && of_a->linkage == of_b->linkage && of_a->servos.size() == of_b->servos.size() &&
             unlikeness(tree_, of_a->servos, of_b->servos).most < kAlike;
    };
  }

  std::optional<FoundLegs> first_four(const std::vector<Chains>& groups) const {
    for (const Chains& group : groups) {
      if (group.size() != kLegCount) continue;
      if (auto legs = legs_of(group)) return legs;
    }
    return std::nullopt;
  }

  std::optional<FoundLegs> legs_of(const Chains& four) const {
    const Vector3 up = normal_of(tree_, four);
    FoundLegs legs;
    std::set<int> parents;
    for (std::size_t i = 0; i < four.size(); ++i) {
      const auto joints = four[i].tips == 1 ? roles_of(tree_, four[i], up) : std::nullopt;
      if (!joints) return std::nullopt;
      parents.insert(four[i].parent);
      legs[i] = {four[i], *joints};
    }
    if (parents.size() > 2) return std::nullopt;
    refuse_loops_between(four);
    return legs;
  }

  const std::string& first_joint(const JointChain& chain) const {
    return tree_.joint(chain.bodies.front()).name;
  }

  void refuse_eight_chains() const {
    const auto pairs = std::ranges::count_if(
        branches_, [](const JointChain& b) { return b.bodies.size() == 2 && b.tips == 1; });
    if (pairs != 2 * kLegCount) return;
    throw ConfigError(source_, "legs",
                      "in a robot.yaml beside it `legs` ((tilt,) shoulder_left, shoulder_right, elbow_left, "
                      "elbow_right) and `loops` (models/README.md)",
                      "eight chains of two joints, of which no one can tell how they make four legs");
  }

  void refuse_loops_between(const Chains& legs) const {
    const auto leg_with = [&](const std::string& link) {
      const auto found = tree_.robot().links.find(link);
      if (found == tree_.robot().links.end()) return legs.end();
      const std::vector<int> way = tree_.way_to(found->second.body);
      return std::ranges::find_if(legs, [&way](const JointChain& leg) {
        return std::ranges::find(way, leg.bodies.front()) != way.end();
      });
    };
    for (const LinkLoop& loop : tree_.robot().loops) {
      const auto a = leg_with(loop.link_a), b = leg_with(loop.link_b);
      if (a == legs.end() || b == legs.end() || a == b) continue;
      throw ConfigError(
          source_, "legs", "loops that close within a leg",
          fmt::format("'{}' from '{}' to '{}', of two legs", loop.name, loop.link_a, loop.link_b));
    }
  }

  [[noreturn]] void refuse(const std::vector<Chains>& groups) const {
    for (const Chains& group : groups) {
      if (group.size() != kLegCount) continue;
      const JointChain& leg = group.front();
      const std::string element = fmt::format("legs, from '{}'", first_joint(leg));
      if (leg.tips != 1) throw ConfigError(source_, element, "chains", "legs that branch");
      refuse_loops_between(group);
      const std::size_t joints = leg.bodies.size();
      throw ConfigError(source_, element,
                        "2 or 3 moving joints in each: (abduction,) hip, knee, the last two about parallel "
                        "axes; and at most two more, to be held",
                        joints == 2 || joints == 3 ? fmt::format("{}, of which no two are parallel", joints)
                                                   : std::to_string(joints));
    }
    throw ConfigError(source_, "legs",
                      "four branches of the base that are alike, or a robot.yaml that names them", listed());
  }

  std::string listed() const {
    std::vector<std::string> texts;
    for (const JointChain& b : branches_)
      texts.push_back(fmt::format("{} joint{} from '{}'", b.bodies.size(), b.bodies.size() == 1 ? "" : "s",
                                  first_joint(b)));
    if (texts.empty()) return "none that moves";
    return fmt::format("{}{}", fmt::join(texts, ", "), what_is_unlike());
  }

  /// Of three branches or more with equally many joints, where one differs.
  std::string what_is_unlike() const {
    for (const Chains& same : groups_of(branches_, have_one_shape)) {
      if (same.size() < kLegCount - 1 || same.front().tips != 1 || same.front().bodies.size() < 2) continue;
      for (const JointChain& other : same) {
        const Unlikeness u = unlikeness(tree_, same.front().bodies, other.bodies);
        if (u.most < kAlike) continue;
        return fmt::format("; joints {} and {} from '{}' are at {:.0f} degrees, from '{}' at {:.0f}", u.i + 1,
                           u.j + 1, first_joint(same.front()), u.angle_a * 180 / M_PI, first_joint(other),
                           u.angle_b * 180 / M_PI);
      }
    }
    return "";
  }

  const JointTree& tree_;
  const std::string& source_;
  Chains branches_, ends_;
};

std::string names_and_angles(const std::map<std::string, double>& joints) {
  std::vector<std::string> texts;
  for (const auto& [joint, angle] : joints)
    texts.push_back(angle == 0 ? joint : fmt::format("{} at {:.3g} rad", joint, angle));
  return fmt::format("{}", fmt::join(texts, ", "));
}

const char* why_a_leg(LegLinkage linkage) {
  if (linkage == LegLinkage::kFiveBar)
    return "two chains that a loop of the file joins, by the quadrant of their shoulders; left is the one "
           "behind";
  if (linkage == LegLinkage::kHipFirst)
    return "one of four alike branches of the base, by the quadrant of its hip; the joint between hip and "
           "knee "
           "turns it aside";
  if (linkage == LegLinkage::kClosedChain)
    return "one of four alike branches of the base, by the quadrant of its hip; loops of the file move its "
           "joints without a servo, by the bars beside it";
  return "one of four alike branches of the base, by the quadrant of its hip";
}

void warn_of_held(const LegSearch& search, std::vector<std::string>& warnings) {
  std::map<std::string, double> wheels, ankles;
  double radius = 0;
  for (const Leg leg : kLegs) {
    for (const auto& [joint, angle] : search.legs[leg].held) {
      const bool is_wheel = search.legs[leg].wheel && joint == search.legs[leg].wheel->joint;
      (is_wheel ? wheels : ankles)[joint] = angle;
      if (is_wheel) radius = search.legs[leg].wheel->radius;
    }
  }
  if (!wheels.empty())
    warnings.push_back(
        fmt::format("wheels do not turn: held are {}, and the feet are spheres of their radius, "
                    "{:.3g} m",
                    names_and_angles(wheels), radius));
  if (!ankles.empty())
    warnings.push_back(fmt::format("legs have more joints than abduction, hip and knee: held are {}",
                                   names_and_angles(ankles)));
}

/// Followers are held where their leaders have them, and not at all where these move. In a chain of n the
/// last one is settled after n rounds.
void place_held(const ParsedRobot& robot, LegSearch& search) {
  for (std::size_t round = 0; round < robot.couplings.size(); ++round) {
    for (const NamedCoupling& coupling : robot.couplings) {
      const auto follower = search.locked.find(coupling.follower);
      if (follower == search.locked.end()) continue;
      const auto leader = search.locked.find(coupling.leader);
      if (leader == search.locked.end()) {
        search.locked.erase(follower);
      } else {
        follower->second = JointCoupling{.coefficients = coupling.coefficients}.follower_at(leader->second);
      }
    }
  }
}

}  // namespace

double held_angle(const ParsedRobot& robot, const Joint& joint) {
  const auto home = robot.home.find(joint.name);
  return std::clamp(home == robot.home.end() ? 0.0 : home->second, joint.lower, joint.upper);
}

LegSearch find_legs(const ParsedRobot& robot, const std::string& source, const std::optional<Matrix3>& frame,
                    std::vector<Inference>& inferred, std::vector<std::string>& warnings) {
  const JointTree tree(robot);
  const FoundLegs found = LegFinder(tree, source).find();
  const PlacedLegs placed = place_legs(tree, found, frame, source, inferred, warnings);
  LegSearch search;
  search.R_BA = placed.R_BA;
  std::set<std::string> used;
  for (const Leg leg : kLegs) {
    LegJoints joints = placed.legs[leg]->joints;
    if (joints.linkage == LegLinkage::kFiveBar) put_left_behind(tree, placed.R_BA, joints);
    FoundChain& chain = search.legs[leg];
    chain.linkage = joints.linkage;
    for (const int body : joints.servos) chain.joints.push_back(tree.joint(body).name);
    for (const int body : joints.followers) chain.joints.push_back(tree.joint(body).name);
    chain.followers = joints.followers.size();
    chain.parts = joints.parts;
    used.insert(chain.joints.begin(), chain.joints.end());
    for (const int body : joints.held) {
      chain.held[tree.joint(body).name] = held_angle(robot, tree.joint(body));
      used.insert(tree.joint(body).name);
    }
    const int last = placed.legs[leg]->chain.bodies.back();
    const bool has_role = std::ranges::find(chain.joints, tree.joint(last).name) != chain.joints.end();
    const auto wheel = has_role ? std::nullopt : wheel_of(robot, last);
    if (wheel) chain.wheel = {tree.joint(last).name, tree.body(last).name, wheel->centre, wheel->radius};
    inferred.push_back({fmt::format("legs.{}", name(leg)), fmt::format("{}", fmt::join(chain.joints, ", ")),
                        why_a_leg(chain.linkage)});
  }
  warn_of_held(search, warnings);
  for (std::size_t i = 1; i < robot.bodies.size(); ++i) {
    const Joint& joint = robot.bodies[i].joint;
    if (!used.contains(joint.name)) search.locked[joint.name] = held_angle(robot, joint);
  }
  place_held(robot, search);
  if (!search.locked.empty()) {
    inferred.push_back(
        {"locked", names_and_angles(search.locked),
         "joints of no leg, held at the file's home pose, else at zero or the limit next to it"});
  }
  return search;
}

}  // namespace crossgait
