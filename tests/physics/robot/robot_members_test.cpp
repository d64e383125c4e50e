// No member of a robot is forgotten: by its identity, by checks, by what files may say.
#include "physics/robot/robot_members.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <span>
#include <utility>

#include <gtest/gtest.h>

#include "physics/core/sha256.h"
#include "physics/robot/robot_identity.h"
#include "physics/robot_files/data_path.h"
#include "tests/physics/core/config_error.h"

namespace crossgait {
namespace {

/// A robot that has everything: visuals, a hull, loops, couplings, legs.
RobotDescription full_robot() {
  RobotDescription robot = load_robot(find_robot("scara_quadruped"));
  CollisionShape hull;
  hull.name = "hull";
  hull.type = ShapeType::kHull;
  hull.vertices = {{0, 0, 0}, {.01, 0, 0}, {0, .01, 0}, {0, 0, .01}};
  robot.bodies[0].shapes.push_back(hull);
  VisualShape visual;
  visual.mesh = "trunk.stl";
  visual.rgba = Eigen::Vector4d(.1, .2, .3, 1);
  robot.bodies[0].visuals.push_back(visual);
  const auto shoulder = [&robot](Leg leg) { return (*robot.legs)[leg].joint("shoulder_left"); };
  robot.couplings.push_back({.follower = shoulder(Leg::RR), .leader = shoulder(Leg::FL)});
  robot.contact = all_settings(ContactSpec());
  robot.validate();
  return robot;
}

void change(double& value) { value = std::nextafter(value, 1e300); }  // its last bit
void change(int& value) { ++value; }
void change(bool& value) { value = !value; }
void change(std::string& value) { value += 'x'; }
template <typename Enum>
requires std::is_enum_v<Enum>
void change(Enum& value) { value = static_cast<Enum>(static_cast<int>(value) + 1); }

/// Calls `visit(path, robot)` with one leaf after the other changed, which is as it was afterwards.
template <typename Visit>
void with_each_leaf_changed(RobotDescription robot, Visit visit) {
  for_each_leaf(robot, [&](const MemberPath& path, auto& leaf) {
    const auto before = leaf;
    change(leaf);
    visit(path.text(), std::as_const(robot));
    leaf = before;
  });
}

TEST(RobotIdentity, ChangesWithEveryMemberButNameSourceAndLooks) {
  RobotDescription robot = full_robot();
  robot.bodies.resize(3);  // all others are alike
  robot.bodies[0].visuals.erase(robot.bodies[0].visuals.begin(), robot.bodies[0].visuals.end() - 1);
  for (Body& body : std::span(robot.bodies).subspan(1)) body.visuals.clear();
  const std::string before = identity_text(robot);
  std::set<std::string> left_out;
  std::size_t changed = 0;
  with_each_leaf_changed(robot, [&](const std::string& path, const RobotDescription& other) {
    if (identity_text(other) != before) {
      ++changed;
    } else {
      left_out.insert(path.substr(0, path.find_last_not_of("0123456789]") + 1));
    }
  });
  EXPECT_GT(changed, 200U);  // 3 bodies with 50 numbers each, their shapes, loops, legs and the home pose
  EXPECT_EQ(left_out, (std::set<std::string>{"name", "source", "bodies[0].visuals[0].type",
                                             "bodies[0].visuals[0].size[", "bodies[0].visuals[0].mesh",
                                             "bodies[0].visuals[0].scale[", "bodies[0].visuals[0].X_BG[",
                                             "bodies[0].visuals[0].rgba["}));
  EXPECT_EQ(identity_hash(robot), sha256_hex(before));
}

TEST(RobotIdentity, TellsTextsAndListsApart) {
  RobotDescription robot = full_robot(), other = robot;
  // A name that holds what another line would say.
  other.bodies[1].name = "a\nbodies[2].name=1:b";
  EXPECT_NE(identity_text(robot), identity_text(other));
  other = robot;
  other.bodies[0].shapes.pop_back();
  EXPECT_NE(identity_text(robot), identity_text(other));
  other = robot;
  other.legs.reset();
  EXPECT_NE(identity_text(robot), identity_text(other));
}

TEST(RobotChecks, RefuseEveryNumberThatIsNone) {
  RobotDescription robot = full_robot();
  std::size_t numbers = 0;
  for_each_leaf(robot, [&](const MemberPath& path, auto& leaf) {
    if constexpr (std::is_same_v<decltype(leaf), double&>) {
      if (path.text().starts_with("bodies[5]") || !path.text().starts_with("bodies[")) {
        const double before = leaf;
        leaf = std::numeric_limits<double>::quiet_NaN();
        EXPECT_THROW(robot.validate(), ConfigError) << path.text();
        leaf = before;
        ++numbers;
      }
    }
  });
  EXPECT_GT(numbers, 100U);
  EXPECT_NO_THROW(robot.validate());
}

/// Where the members of a struct lie, as its visitor says.
template <typename T>
std::map<std::ptrdiff_t, std::pair<std::size_t, std::size_t>> layout_of(T& value) {
  std::map<std::ptrdiff_t, std::pair<std::size_t, std::size_t>> members;
  for_each_member(value, [&](std::string_view name, auto& member) {
    const auto at = reinterpret_cast<const char*>(&member) - reinterpret_cast<const char*>(&value);
    EXPECT_TRUE(members.emplace(at, std::pair(sizeof(member), alignof(decltype(member)))).second) << name;
  });
  return members;
}

/// From one member to the next there is nothing but what the next one's alignment needs.
template <typename T>
void expect_whole(const char* name) {
  T value{};
  std::size_t end = 0;
  const auto aligned = [](std::size_t at, std::size_t to) { return (at + to - 1) / to * to; };
  for (const auto& [at, member] : layout_of(value)) {
    const auto& [size, alignment] = member;
    EXPECT_EQ(static_cast<std::size_t>(at), aligned(end, alignment))
        << name << ": a member before byte " << at << " is not visited";
    end = static_cast<std::size_t>(at) + size;
  }
  EXPECT_EQ(sizeof(T), aligned(end, alignof(T))) << name << ": its last member is not visited";
}

TEST(RobotMembers, AreAllVisited) {
  expect_whole<SpatialInertia>("SpatialInertia");
  expect_whole<CollisionShape>("CollisionShape");
  expect_whole<VisualShape>("VisualShape");
  expect_whole<Joint>("Joint");
  expect_whole<Body>("Body");
  expect_whole<LoopClosure>("LoopClosure");
  expect_whole<JointCoupling>("JointCoupling");
  expect_whole<LegModel>("LegModel");
  expect_whole<Softness>("Softness");
  expect_whole<ContactSettings>("ContactSettings");
  expect_whole<RobotDescription>("RobotDescription");
}

TEST(JointNumbers, HaveANameAndAMemberEach) {
  std::set<std::string_view> names;
  const Joint joint;
  std::set<const double*> members;
  for (const JointNumber& number : kJointNumbers) {
    EXPECT_TRUE(names.insert(number.name).second) << number.name;
    EXPECT_TRUE(members.insert(&(joint.*number.member)).second) << number.name;
    EXPECT_FALSE(number.unit.empty()) << number.name;
    EXPECT_GT(number.most, 0) << number.name;
  }
}

TEST(JointNumbers, AreCheckedOneByOne) {
  Joint servo;
  servo.name = "j";
  servo.actuated = true;
  servo.effort_limit = 1;
  EXPECT_NO_THROW(check_joint(servo, "test"));
  for (const JointNumber& number : kJointNumbers) {
    for (const double wrong : {-1.0, 2 * number.most}) {
      Joint joint = servo;
      joint.*number.member = wrong;
      const ConfigError error = config_error([&] { check_joint(joint, "test"); });
      EXPECT_EQ(error.element(), "joint 'j'");
      EXPECT_NE(error.expected().find(number.words.empty() ? number.name : number.words), std::string::npos)
          << error.what();
      // What a servo alone has means nothing of a passive joint.
      joint.actuated = false;
      if (number.of == JointNumberOf::kJoint) {
        EXPECT_THROW(check_joint(joint, "test"), ConfigError) << number.name;
      } else {
        EXPECT_NO_THROW(check_joint(joint, "test")) << number.name;
      }
    }
  }
}

}  // namespace
}  // namespace crossgait
