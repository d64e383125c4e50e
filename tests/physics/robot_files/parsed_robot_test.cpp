#include "physics/robot_files/parsed_robot.h"

#include <gtest/gtest.h>

#include "physics/robot/multibody.h"
#include "physics/robot_files/urdf/urdf_reader.h"
#include "tests/physics/robot_files/scratch_robot.h"

namespace crossgait {
namespace {

ParsedRobot default_robot() { return read_urdf(kRobotFolder + "robot.urdf"); }

RobotDescription description(const ParsedRobot& urdf) {
  RobotDescription robot;
  robot.name = "made";
  robot.bodies = urdf.bodies;
  return robot;
}

/// World poses of links with all joints at zero.
std::map<std::string, Pose> link_poses(const ParsedRobot& urdf) {
  const RobotDescription robot = description(urdf);
  RobotState state;
  state.q = JointVector::Zero(robot.joint_count());
  std::vector<Pose> poses;
  forward_kinematics(robot, state, poses);
  std::map<std::string, Pose> result;
  for (const auto& [name, link] : urdf.links)
    result[name] = poses[static_cast<std::size_t>(link.body)] * link.X_BL;
  return result;
}

Eigen::Matrix<double, 6, 6> base_inertia(const ParsedRobot& urdf) {
  const RobotDescription robot = description(urdf);
  RobotState state;
  state.q = JointVector::Zero(robot.joint_count());
  return mass_matrix(robot, state).topLeftCorner<6, 6>();
}

TEST(LockJoints, KeepsWhereLinksAreAndWhatTheyWeighAtZero) {
  const ParsedRobot free = default_robot();
  ParsedRobot with_mesh = free;
  with_mesh.mesh_vertices["FL_foot_collision_0"] = {Vector3::Zero()};
  const ParsedRobot locked =
      lock_joints(with_mesh, {{"FL_tilt", 0}, {"FL_elbow_left", 0}, {"RR_shoulder_right", 0}});
  EXPECT_EQ(locked.bodies.size(), free.bodies.size() - 3);
  const auto before = link_poses(free), after = link_poses(locked);
  ASSERT_EQ(before.size(), after.size());
  for (const auto& [name, X] : before)
    EXPECT_LT((X.matrix() - after.at(name).matrix()).norm(), 1e-14) << name;  // rounding of sums
  EXPECT_LT((base_inertia(free) - base_inertia(locked)).norm(), 1e-14);
  for (const auto& [name, link] : free.links) {
    const LinkPlacement& now = locked.links.at(name);
    ASSERT_EQ(now.shapes.size(), link.shapes.size()) << name;
    for (std::size_t i = 0; i < link.shapes.size(); ++i) {
      const auto shape = [i](const ParsedRobot& urdf, const LinkPlacement& at) {
        return urdf.bodies[static_cast<std::size_t>(at.body)].shapes[static_cast<std::size_t>(at.shapes[i])];
      };
      EXPECT_EQ(shape(locked, now).name, shape(free, link).name);
      const Pose X_LG = link.X_BL.inverse() * shape(free, link).X_BG,
                 now_LG = now.X_BL.inverse() * shape(locked, now).X_BG;
      EXPECT_LT((X_LG.matrix() - now_LG.matrix()).norm(), 1e-14);
    }
  }
}

TEST(LockJoints, OfNoneChangesNothing) {
  const ParsedRobot free = default_robot(), same = lock_joints(free, {});
  ASSERT_EQ(same.bodies.size(), free.bodies.size());
  for (std::size_t i = 0; i < free.bodies.size(); ++i) {
    EXPECT_EQ(same.bodies[i].parent, free.bodies[i].parent);
    EXPECT_EQ(same.bodies[i].X_PB.matrix(), free.bodies[i].X_PB.matrix());
  }
}

TEST(TurnBase, TurnsEverythingAboutTheBase) {
  const ParsedRobot free = default_robot();
  Matrix3 R;
  R << 0, -1, 0, 1, 0, 0, 0, 0, 1;  // forward is the file's y
  const ParsedRobot turned = turn_base(free, R);
  const auto before = link_poses(free), after = link_poses(turned);
  for (const auto& [name, X] : before) {
    EXPECT_LT((after.at(name).translation() - R.transpose() * X.translation()).norm(), 1e-15) << name;
    EXPECT_LT((after.at(name).linear() - R.transpose() * X.linear()).norm(), 1e-15) << name;
  }
  Eigen::Matrix<double, 6, 6> both = Eigen::Matrix<double, 6, 6>::Zero();
  both.topLeftCorner<3, 3>() = both.bottomRightCorner<3, 3>() = R;
  EXPECT_LT((both * base_inertia(turned) * both.transpose() - base_inertia(free)).norm(), 1e-15);
}

}  // namespace
}  // namespace crossgait
