// The moving joints of a robot's file at zero angles, and the chains that they make. Private to inference.
#pragma once

#include <vector>

#include "physics/robot_files/parsed_robot.h"

namespace crossgait {

/// Lists bodies in a row, each hanging on the one before.
struct JointChain {
  std::vector<int> bodies;  ///< in the file's order: the first hangs on `parent`
  int parent = 0;           ///< index of the body that it hangs on
  int tips = 1;             ///< bodies of it on which nothing hangs: of a chain one
};

/// Says where the joints are and point, twigs (bodies that hang on a chain beside its next one and follow its
/// joints) being left out of branches and ends, in the base frame of the file, all angles being zero.
class JointTree {
 public:
  explicit JointTree(const ParsedRobot& robot);

  const ParsedRobot& robot() const { return robot_; }
  const Body& body(int i) const { return robot_.bodies[static_cast<std::size_t>(i)]; }
  const Joint& joint(int i) const { return body(i).joint; }
  Vector3 origin(int i) const { return poses_[static_cast<std::size_t>(i)].translation(); }
  Vector3 axis(int i) const { return poses_[static_cast<std::size_t>(i)].linear() * body(i).joint.axis; }

  /// Tells whether a body's joint moves with another one and has no servo of its own.
  bool follows(int i) const { return follows_[static_cast<std::size_t>(i)]; }

  /// Returns what hangs on the base, each with all that hangs on it: a chain only if it has one tip.
  std::vector<JointChain> branches() const;
  /// Returns chains from each tip up to where something else branches off, or the base.
  std::vector<JointChain> ends() const;

 private:
  std::size_t children_of(int body) const;
  void find_twigs();

  const ParsedRobot& robot_;
  std::vector<Pose> poses_;
  std::vector<bool> follows_;
  std::vector<bool> is_twig_;  ///< bodies beside a chain that only move along with it: bars of a linkage
};

}  // namespace crossgait
