// Does a robot that was only described walk? Two seconds of trot in every engine, and what is wrong with
// them.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "motion/motion_statistics.h"
#include "physics/robot/robot.h"

namespace crossgait {

struct TrialWalk {
  std::string engine;
  MotionSummary summary;
  double speed_ratio = 0;             ///< mean speed over the commanded one
  double torque_limit_fraction = 0;   ///< of the time, that some servo was at its torque limit
  std::vector<std::string> failures;  ///< empty if it walked well
};

struct Trial {
  double commanded_mps = 0;  ///< 0.25 sqrt(g h): what robots of any size trot at
  std::vector<TrialWalk> walks;

  bool passed() const;
};

/// Tries a robot on flat ground, as `crossgait walk` would. @throws ConfigError
Trial try_robot(std::shared_ptr<const RobotDescription> robot, const std::vector<std::string>& engines,
                double seconds = 2);

/// Takes back the advice on gains among the failures: for robots whose numbers are wrong altogether.
Trial without_advice(Trial trial);

nlohmann::ordered_json to_json(const Trial& trial);
std::string describe(const Trial& trial);

}  // namespace crossgait
