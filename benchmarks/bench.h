// The benchmark across engines: everything that is measured, as one JSON object.
//
// The object's keys are described in docs/benchmarks.md. Tables, figures and comparisons are made from it, so
// that they can be made of a stored result, too.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "parity/comparison.h"
#include "scenes/scenes.h"

namespace crossgait::benchmarks {

/// Returns the names speed, accuracy, analytic, feet.
const std::vector<std::string>& bench_sections();

struct BenchOptions {
  std::vector<std::string> engines;              ///< the first one is what times are compared to
  std::vector<std::string> sections;             ///< empty: all
  bool quick = false;                            ///< fewer repetitions and shorter standing
  scenes::RobotPtr robot = scenes::quadruped();  ///< of all sections but analytic
};

/// Runs sections; if `progress` throws Interrupted, returns the finished ones, and "interrupted": true.
/// @throws ConfigError for an unknown or repeated section or engine, or none, and for a robot without legs
/// @throws std::runtime_error if an engine diverges where it must not
nlohmann::ordered_json run_bench(const BenchOptions& options, const Progress& progress);

/// Reads a result that `crossgait bench --json` wrote. @throws ConfigError if it is not one
nlohmann::ordered_json read_bench(const std::string& path);

/// Describes a result as tables.
std::string describe_bench(const nlohmann::ordered_json& result);

}  // namespace crossgait::benchmarks
