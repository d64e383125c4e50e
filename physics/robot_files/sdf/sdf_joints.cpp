#include "physics/robot_files/sdf/sdf_joints.h"

#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "physics/core/error.h"

namespace crossgait {
namespace {

std::string quoted_type(const SdfJoint& joint) {
  return fmt::format("'{}'", printable_text(joint.type, 200));
}

bool moves(const SdfJoint& joint) { return joint.type == "revolute" || joint.type == "continuous"; }

bool is_loop_joint(const SdfJoint& joint) {
  if (joint.type == "ball") return true;
  const SdfElement* at = joint.element;
  for (const char* below : {"physics", "simbody", "must_be_loop_joint"})
    if (at != nullptr) at = at->find(below);
  return at != nullptr && (at->text == "true" || at->text == "1");
}

/// Whether it says what a joint of a loop could not be: limits, damping, friction or springs of its axis.
bool says_how_it_turns(const SdfJoint& joint) {
  const SdfElement* axis = joint.element->find("axis");
  return axis != nullptr && (axis->find("limit") != nullptr || axis->find("dynamics") != nullptr);
}

/// Of several joints of a link the one that holds it in the tree, whatever their order in the file; of alike
/// ones the first. By the link.
std::map<std::string, const SdfJoint*> holding_joints(const SdfModel& model) {
  std::map<std::string, const SdfJoint*> holding;
  const auto add_if = [&](const auto& takes) {
    for (const SdfJoint& joint : model.joints)
      if (!joint.parent.empty() && takes(joint)) holding.emplace(joint.child, &joint);
  };
  add_if([](const SdfJoint& j) { return !is_loop_joint(j) && says_how_it_turns(j); });
  add_if([](const SdfJoint& j) { return !is_loop_joint(j); });
  add_if(is_loop_joint);
  return holding;
}

/// Follows the joints of a tree up from a link.
std::string root_of(const std::string& link, const std::map<std::string, const SdfJoint*>& holding) {
  std::string here = link;
  for (std::size_t steps = 0; steps <= holding.size(); ++steps) {
    const auto joint = holding.find(here);
    if (joint == holding.end()) return here;
    here = joint->second->parent;
  }
  fail_at(*holding.at(link)->element, "a tree of links, in which a further joint of a link closes a loop",
          "joints in a cycle");
}

}  // namespace

SdfJoints sort_joints(const SdfModel& model, const std::string& main_file, ReaderWarnings& warnings) {
  SdfJoints joints;
  const std::map<std::string, const SdfJoint*> holding = holding_joints(model);
  for (const bool takes_loops : {false, true}) {
    for (const SdfJoint& joint : model.joints) {
      if (is_loop_joint(joint) != takes_loops) continue;
      if (joint.parent.empty()) {
        if (joint.type != "fixed")
          fail_at(*joint.element, "a base that floats", "a joint that moves it on the world");
        joint.element->pass_over("axis");
        warnings.count("left out ", " joint(s) that fix the robot to the world: its base is free",
                       sdf_place(*joint.element, main_file));
      } else if (joint.parent == joint.child) {
        fail_at(*joint.element, "two links", fmt::format("'{}' twice", printable_text(joint.child, 200)));
      } else if (holding.at(joint.child) == &joint) {
        if (!moves(joint) && joint.type != "fixed")
          fail_at(*joint.element, "type revolute, continuous or fixed", quoted_type(joint));
        joints.of_tree.push_back(&joint);
      } else {
        if (!moves(joint) && joint.type != "ball")
          fail_at(
              *joint.element,
              fmt::format(
                  "type revolute, continuous or ball of a further joint of link '{}', which closes a loop",
                  printable_text(joint.child, 200)),
              quoted_type(joint));
        joints.of_loops.push_back(&joint);
      }
    }
  }
  std::set<std::string> roots;
  for (const SdfJoint* joint : joints.of_tree)
    if (moves(*joint)) roots.insert(root_of(joint->child, holding));
  if (roots.empty()) fail_at(*model.models.front(), "joints that move", "none");
  if (roots.size() > 1)
    fail_at(*model.models.front(), "one robot: one link on which all joints hang",
            fmt::format("'{}'", fmt::join(roots, "', '")));
  joints.root = *roots.begin();
  return joints;
}

}  // namespace crossgait
