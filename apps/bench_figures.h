// Pictures of a result of the benchmark.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace crossgait::apps {

/// Draws what there is of speed.svg, accuracy.svg, analytic.svg and feet.svg into `folder`, which is made if
/// need be. @returns the files written
/// @throws ConfigError if there is no gnuplot or the folder cannot be written
std::vector<std::string> draw_bench_figures(const nlohmann::ordered_json& result, const std::string& folder);

}  // namespace crossgait::apps
