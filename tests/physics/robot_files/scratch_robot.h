// Copies of the default robot's files with something changed, and simple robots built in code.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "physics/core/text.h"
#include "physics/robot/robot.h"
#include "tests/physics/core/kept_inputs.h"

namespace crossgait {

inline const std::string kRobotFolder = CROSSGAIT_SOURCE_DIR "/models/robots/scara_quadruped/";

/// Copies the default robot into a folder, named after the running test and removed with this object.
class ScratchRobot {
 public:
  ScratchRobot() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    std::string name = std::string(test->test_suite_name()) + "." + test->name();
    for (char& c : name) c = c == '/' ? '_' : c;
    folder_ =
        std::filesystem::temp_directory_path() / ("crossgait-" + name + "-" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
    for (const char* file : {"robot.urdf", "robot.yaml"})
      write(file, read_text_file(kRobotFolder + file, kUrdfBudget));
  }
  ~ScratchRobot() { std::filesystem::remove_all(folder_); }
  ScratchRobot(const ScratchRobot&) = delete;
  ScratchRobot& operator=(const ScratchRobot&) = delete;

  std::string path(const std::string& file) const { return (folder_ / file).string(); }
  void write(const std::string& file, const std::string& text) const {
    keep_input(file, text);
    std::ofstream(folder_ / file, std::ios::binary) << text;
  }
  /// Replaces the first occurrence of `from`, which has to be there.
  void replace(const std::string& file, const std::string& from, const std::string& to) const {
    std::string text = read_text_file(path(file), kUrdfBudget);
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << "'" << from << "' is not in " << file;
    write(file, text.replace(at, from.size(), to));
  }

 private:
  std::filesystem::path folder_;
};

/// Makes a body of 1 kg hanging on `parent` by a joint about y, its centre of mass `length` below the joint.
inline Body pendulum_body(const std::string& name, int parent, const Vector3& p_PJ, double length) {
  Body body;
  body.name = name;
  body.parent = parent;
  body.X_PB.translation() = p_PJ;
  body.inertia = {1.0, {0, 0, -length}, Vector3(0.02, 0.03, 0.04).asDiagonal()};
  if (parent >= 0) {
    body.joint.name = name + "_joint";
    body.joint.axis = Vector3::UnitY();
  }
  return body;
}

/// Makes a base with `joints` pendulums, each hanging 0.5 m below the one before; centres of mass 0.3 m below
/// the joints.
inline RobotDescription pendulum_chain(int joints) {
  RobotDescription robot;
  robot.name = "pendulums";
  robot.bodies.push_back(pendulum_body("base", -1, Vector3::Zero(), 0));
  for (int i = 0; i < joints; ++i) {
    const Vector3 p_PJ = i == 0 ? Vector3::Zero() : Vector3(0, 0, -0.5);
    robot.bodies.push_back(pendulum_body("link_" + std::to_string(i + 1), i, p_PJ, 0.3));
  }
  robot.home = JointVector::Zero(std::min(joints, kMaxJoints));
  return robot;
}

}  // namespace crossgait
