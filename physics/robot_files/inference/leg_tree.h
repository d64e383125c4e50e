// The moving joints of a robot's file as it has them, and the chains that they make. Private to inference.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "physics/robot_files/parsed_robot.h"

namespace crossgait {

/// Lists bodies in a row, each hanging on the one before.
struct JointChain {
  std::vector<int> bodies;  ///< in the file's order: the first hangs on `parent`
  int parent = 0;           ///< index of the body that it hangs on
  int tips = 1;             ///< bodies of it on which nothing hangs: of a chain one
};

/// Says where the joints are and point, in the base frame of the file, at the angles at which the file has
/// its bodies: zero unless it says otherwise. Left out of branches and ends are twigs: bodies that hang on a
/// chain beside its next one and follow its joints, and bars, which a loop joins to it. Of the two ways
/// around a loop the bar is the one that does not reach as far.
class JointTree {
 public:
  explicit JointTree(const ParsedRobot& robot);

  const ParsedRobot& robot() const { return robot_; }
  const Body& body(int i) const { return robot_.bodies[static_cast<std::size_t>(i)]; }
  const Joint& joint(int i) const { return body(i).joint; }
  Vector3 origin(int i) const { return poses_[static_cast<std::size_t>(i)].translation(); }
  Vector3 axis(int i) const { return poses_[static_cast<std::size_t>(i)].linear() * body(i).joint.axis; }

  /// Tells whether a body's joint moves with another one and has no servo of its own: by a coupling or a
  /// loop.
  bool follows(int i) const {
    return follows_[static_cast<std::size_t>(i)] || is_moved_by_loop_[static_cast<std::size_t>(i)];
  }
  /// Tells whether a loop moves a body's joint: those without an actuator where the file has any; else two of
  /// each loop, which are the bar's, but for the first of two or more (a crank), and then the leg's last
  /// ones.
  bool is_moved_by_loop(int i) const { return is_moved_by_loop_[static_cast<std::size_t>(i)]; }
  /// Returns the bars that loops join to these bodies, and to each other, in the file's order.
  std::vector<int> bars_of(const std::vector<int>& bodies) const;

  /// Returns how far a body, or anything that hangs on it, reaches from its joint, m.
  double reach_of(int body) const { return reach_of(body, origin(body), -1); }
  /// Returns the bodies from the base to this one, without the base.
  std::vector<int> way_to(int body) const;
  /// Returns where a point of a link is, or nothing of a link that is not there.
  std::optional<Vector3> point_of(const std::string& link, const Vector3& p) const;

  /// Returns what hangs on the base, each with all that hangs on it: a chain only if it has one tip.
  std::vector<JointChain> branches() const;
  /// Returns chains from each tip up to where something else branches off, or the base.
  std::vector<JointChain> ends() const;

 private:
  struct Bar {
    std::vector<int> bodies;  // from where they part from the leg outwards, with all that hangs on them
    std::vector<int> beside;  // the leg's, likewise
  };

  std::size_t children_of(int body) const;
  void find_twigs();
  void find_bars();
  /// Likewise from a point, and without what hangs on `excluded`.
  double reach_of(int root, const Vector3& from, int excluded) const;
  bool hangs_on(int body, int on) const;
  bool reach_alike(int a, int b) const;
  /// Takes from the way along a leg what goes on behind where the leg itself goes on to its foot.
  std::vector<int> take_rods(std::vector<int>& leg) const;
  void move_by_loop(const std::vector<int>& bar, const std::vector<int>& leg);

  const ParsedRobot& robot_;
  std::vector<Pose> poses_;
  std::vector<bool> follows_, is_moved_by_loop_;
  std::vector<Bar> bars_;
  std::vector<bool> is_twig_;  ///< bodies beside a chain that only move along with it: bars of a linkage
};

}  // namespace crossgait
