// A quadruped's MJCF, made to measure, and a fixture that reads it.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "backends/registry.h"
#include "physics/robot_files/mjcf/mjcf_reader.h"
#include "physics/robot_files/robot_report.h"
#include "tests/physics/core/config_error.h"
#include "tests/physics/core/scratch_folder.h"

namespace crossgait {

/// Describes a quadruped of hips and knees about y: hips at x = +-0.2 and y = +-0.1 m, links of 0.2 m down,
/// angles in degrees where the compiler says nothing.
struct MadeMjcf {
  std::string compiler, defaults, asset, sections;
  std::string trunk_joint = "<freejoint/>";
  std::string trunk = R"(<inertial pos="0 0 0" mass="8" diaginertia=".02 .03 .04"/>)";
  std::string world;        ///< beside the trunk
  std::string hip_joint;    ///< more attributes of the hips' joints
  std::string thigh, shin;  ///< more elements of FL's
  std::string thigh_inertial = R"(<inertial pos="0 0 -.1" mass="1" diaginertia=".02 .03 .04"/>)";

  std::string text() const {
    std::string out = "<mujoco model=\"made\">" + compiler + "<default>" + defaults + "</default><asset>" +
                      asset + "</asset>\n<worldbody>" + world + "\n<body name=\"trunk\" pos=\"0 0 1\">" +
                      trunk_joint + trunk;
    for (const Leg leg : kLegs) {
      const bool first = leg == Leg::FL;
      out += fmt::format(
          "\n<body name=\"{0}_thigh\" pos=\"{1} {2} 0\">{3}<joint name=\"{0}_hip\" axis=\"0 1 0\" {4}/>{5}"
          "\n<body name=\"{0}_shin\" pos=\"0 0 -.2\"><inertial pos=\"0 0 -.1\" mass=\"1\" diaginertia=\".02 "
          ".03 .04\"/>"
          "<joint name=\"{0}_knee\" axis=\"0 2 0\"/>{6}<geom name=\"{0}_foot\" pos=\"0 0 -.2\" size=\".02\"/>"
          "</body></body>",
          name(leg), is_front(leg) ? 0.2 : -0.2, 0.1 * side_sign(leg),
          first ? thigh_inertial : MadeMjcf().thigh_inertial, hip_joint, first ? thigh : "",
          first ? shin : "");
    }
    return out + "</body></worldbody>\n" + sections + "</mujoco>\n";
  }
};

class MjcfReader : public ScratchFolder {
 protected:
  void SetUp() override {
    if (!compiles_mjcf()) GTEST_SKIP() << "no available engine compiles MJCF";
    ScratchFolder::SetUp();
  }
  void TearDown() override {
    if (!folder_.empty()) ScratchFolder::TearDown();
  }
  std::string file(const MadeMjcf& mjcf) const { return write("made.xml", mjcf.text()); }
  ParsedRobot tree(const MadeMjcf& mjcf) const { return read_mjcf(file(mjcf)); }
  LoadedRobot load(const MadeMjcf& mjcf) const { return load_robot_with_report(file(mjcf)); }
  ConfigError refusal(const MadeMjcf& mjcf) const {
    return config_error([&] { (void)load_robot(file(mjcf)); });
  }
  static const Body& body(const ParsedRobot& robot, const std::string& name) {
    return robot.bodies[static_cast<std::size_t>(robot.links.at(name).body)];
  }
  static bool warns(const std::vector<std::string>& warnings, const std::string& of) {
    return std::any_of(warnings.begin(), warnings.end(),
                       [&of](const std::string& w) { return w.find(of) != std::string::npos; });
  }
};

}  // namespace crossgait
