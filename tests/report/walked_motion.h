// Walks, and what a page holds of them.
#pragma once

#include <bit>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "physics/robot/robot.h"
#include "report/motion_document.h"
#include "study/walk.h"

namespace crossgait {

inline std::vector<double> floats(const PageNumbers& numbers, const nlohmann::ordered_json& reference) {
  const std::size_t at = reference.at("at"), count = reference.at("count");
  std::vector<double> values;
  for (std::size_t i = at; i < at + count; ++i) values.push_back(std::bit_cast<float>(numbers.words().at(i)));
  return values;
}

struct Walked {
  std::vector<TraceSample> samples;
  TraceTable trace;
};

inline Walked walk_in(const std::string& engine, const WalkConfig& config,
                      const std::shared_ptr<const RobotDescription>& robot) {
  RunRecorder recorder(robot);
  std::vector<TraceSample> samples;
  walk(config, engine, {}, [&](std::size_t, const TraceSample& sample) {
    recorder.add(sample);
    samples.push_back(sample);
  });
  return {samples, recorder.take(engine)};
}

inline WalkConfig short_rough_walk() {
  WalkConfig config;
  config.terrain = "rough:size_x=4,size_y=4";
  config.timing.seconds = 0.6;
  return config;
}

}  // namespace crossgait
