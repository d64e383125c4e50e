// Whether a robot walks that was only described.
#include "study/trial_walk.h"

#include <cmath>

#include <gtest/gtest.h>

#include "backends/registry.h"
#include "physics/robot_files/data_path.h"

namespace crossgait {
namespace {

TEST(TrialWalk, IsAtTheSpeedThatRobotsOfAnySizeTrotAt) {
  for (const char* name : {"scara_quadruped", "serial_quadruped"}) {
    const auto robot = std::make_shared<const RobotDescription>(load_robot(find_robot(name)));
    const Trial trial = try_robot(robot, available_engines(), 1);
    EXPECT_DOUBLE_EQ(trial.commanded_mps, 0.25 * std::sqrt(9.81 * robot->standing_height)) << name;
    ASSERT_EQ(trial.walks.size(), available_engines().size());
    for (std::size_t k = 0; k < trial.walks.size(); ++k) {
      const TrialWalk& walk = trial.walks[k];
      EXPECT_EQ(walk.engine, available_engines()[k]);
      EXPECT_DOUBLE_EQ(walk.speed_ratio, walk.summary.mean_speed_mps / trial.commanded_mps);
      EXPECT_GT(walk.speed_ratio, 0.5) << name << " in " << walk.engine;
      EXPECT_GE(walk.torque_limit_fraction, 0);
      EXPECT_LE(walk.torque_limit_fraction, 1);
    }
  }
}

}  // namespace
}  // namespace crossgait
