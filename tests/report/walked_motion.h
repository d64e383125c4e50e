// Walks, and what a page holds of them.
#pragma once

#include <bit>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "backends/registry.h"
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

inline RecordedRun walk_in(const std::string& engine, const WalkConfig& config) {
  const LoadedWalk walk(config);
  TraceRecorder recorder;
  record_walk(*find_engine(engine).make(walk.world), config.setup(), {}, &recorder);
  return {engine, "", recorder.take()};
}

inline WalkConfig short_rough_walk() {
  WalkConfig config;
  config.terrain = "rough:size_x=4,size_y=4";
  config.timing.seconds = 0.6;
  return config;
}

}  // namespace crossgait
