// A robot that stands: what the ground's push takes of its servos.
#include "study/stand.h"

#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "backends/registry.h"
#include "physics/core/error.h"
#include "physics/robot_files/data_path.h"

namespace crossgait {
namespace {

WorldSpec world_of(const char* robot) {
  WorldSpec world;
  world.robot = std::make_shared<const RobotDescription>(load_robot(find_robot(robot)));
  return world;
}

// At rest a servo's torque is kp (target - reached); damping does nothing.
TEST(Stand, TorquesAreThoseOfSpringsAtRest) {
  const WorldSpec world = world_of("serial_quadruped");
  for (const Standing& standing : stand(world, available_engines(), 2)) {
    EXPECT_EQ(standing.outcome, "stood") << standing.engine;
    ASSERT_EQ(standing.joints.size(), 12U);
    EXPECT_GT(standing.sag, 0) << "servos give way";
    EXPECT_LT(standing.sag, 0.1 * world.robot->home_height);
    const std::vector<int> servos = world.robot->actuated_joints();
    for (std::size_t i = 0; i < servos.size(); ++i) {
      const Joint& joint = world.robot->joint(servos[i]);
      const StandingJoint& stands = standing.joints[i];
      EXPECT_EQ(stands.name, joint.name);
      EXPECT_EQ(stands.target, world.robot->home[servos[i]]);
      // What still moves after two seconds is damped by kd; this robot's joints creep by less than 1e-3
      // rad/s.
      EXPECT_NEAR(stands.torque, joint.kp * (stands.target - stands.reached),
                  5e-3 * (joint.kd + joint.damping) + joint.friction)
          << joint.name << " in " << standing.engine;
      EXPECT_DOUBLE_EQ(stands.share_of_effort, std::abs(stands.torque) / joint.effort_limit);
    }
  }
}

// A spring beside a servo carries its part, and the servo the rest.
TEST(Stand, TorquesAreTheServosAlone) {
  WorldSpec world = world_of("serial_quadruped");
  RobotDescription sprung = *world.robot;
  for (std::size_t i = 1; i < sprung.bodies.size(); ++i) {
    sprung.bodies[i].joint.stiffness = 10;
    sprung.bodies[i].joint.friction = 0;
  }
  world.robot = std::make_shared<const RobotDescription>(sprung);
  for (const Standing& standing : stand(world, {"mujoco"}, 2)) {
    for (const StandingJoint& stands : standing.joints) {
      const Joint& joint = sprung.joint(static_cast<int>(&stands - standing.joints.data()));
      ASSERT_EQ(stands.name, joint.name);
      EXPECT_NEAR(stands.torque, joint.kp * (stands.target - stands.reached), 5e-3 * joint.kd) << joint.name;
    }
  }
}

TEST(Stand, ServosThatAreTooWeakCollapse) {
  WorldSpec world = world_of("serial_quadruped");
  RobotDescription weak = *world.robot;
  for (Body& body : weak.bodies) body.joint.effort_limit = 0.5;
  world.robot = std::make_shared<const RobotDescription>(weak);
  for (const Standing& standing : stand(world, available_engines(), 2))
    EXPECT_EQ(standing.outcome, "collapsed") << standing.engine;
  EXPECT_THROW((void)stand(world, {}, 0.1), ConfigError);
}

}  // namespace
}  // namespace crossgait
