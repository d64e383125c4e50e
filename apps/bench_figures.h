// Pictures of a result of the benchmark.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "apps/plotting.h"

namespace crossgait::apps {

/// What there is of speed, accuracy, analytic and feet, by these names.
std::vector<std::pair<std::string, Figure>> bench_figures(const nlohmann::ordered_json& result);

/// Before minutes of measuring: makes `folder` if need be.
/// @throws ConfigError if there is no gnuplot or the folder cannot be written
void check_bench_figures(const std::string& folder);

/// Draws `bench_figures` into `folder`, which is made if need be.
/// @param format  svg or png  @returns the files written  @throws ConfigError as check_bench_figures
std::vector<std::string> draw_bench_figures(const nlohmann::ordered_json& result, const std::string& folder,
                                            const std::string& format = "svg");

}  // namespace crossgait::apps
