// Reads a robot's file, says what was inferred, and lets it trot at 0.4 m/s: 04_your_robot [FILE].
#include <cstdio>

#include "crossgait/backends/registry.h"
#include "crossgait/gait/scale.h"
#include "crossgait/parity/report.h"
#include "crossgait/physics/robot_files/data_path.h"
#include "crossgait/physics/robot_files/robot_report.h"
#include "crossgait/study/walk.h"

int main(int count, char** arguments) {
  crossgait::WalkConfig config;
  config.robot = count > 1 ? arguments[1] : "serial_quadruped";
  const auto [robot, report] = crossgait::load_robot_with_report(crossgait::find_robot(config.robot));
  for (const auto& [what, value, reason] : report.inferred)
    std::printf("%s: %s (%s)\n", what.c_str(), value.c_str(), reason.c_str());
  const crossgait::VelocityCommand command{0.4, 0, 0};
  config.gait = crossgait::choose_gait("trot", {}, command, crossgait::gait_scale(robot));
  config.timing.seconds = 2;
  const auto result = compare_walks(config, crossgait::available_engines());
  std::puts(crossgait::describe(result.comparison).c_str());
}
