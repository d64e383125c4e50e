#include "physics/robot/robot_identity.h"

#include <concepts>
#include <type_traits>

#include <fmt/format.h>

#include "physics/core/sha256.h"
#include "physics/robot/robot_members.h"

namespace crossgait {
namespace {

// No result depends on these: where a robot was found, what it is called, what it looks like.
bool tells_robots_apart(const MemberPath& path) {
  for (const MemberPath* part = &path; part != nullptr; part = part->outer) {
    if (part->name == "visuals") return false;
  }
  const bool of_the_robot = path.outer != nullptr && path.outer->outer == nullptr;
  return !(of_the_robot && (path.name == "name" || path.name == "source"));
}

// Robots keep the identity that they had before there were these: where they are off they say nothing.
bool was_added_later(const MemberPath& path) {
  return path.name == "implicit_stiffness" || path.name == "implicit_damping" ||
         path.name == "implicit_joint_damping";
}

}  // namespace

std::string identity_text(const RobotDescription& robot) {
  std::string text;
  for_each_leaf(robot, [&text](const MemberPath& path, const auto& leaf) {
    if (!tells_robots_apart(path)) return;
    using Leaf = std::remove_cvref_t<decltype(leaf)>;
    if constexpr (std::same_as<Leaf, double>) {
      if (leaf == 0 && was_added_later(path)) return;
    }
    if constexpr (std::same_as<Leaf, std::string>) {
      text +=
          fmt::format("{}={}:{}\n", path.text(), leaf.size(), leaf);  // its length: it may hold a line's end
    } else {
      text += fmt::format("{}={:.17g}\n", path.text(), static_cast<double>(leaf));
    }
  });
  return text;
}

std::string identity_hash(const RobotDescription& robot) { return sha256_hex(identity_text(robot)); }

}  // namespace crossgait
