// What an engine made of the checks, for people and for programs; and what the checks are.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "conformance/check.h"
#include "physics/core/progress.h"

namespace crossgait::conformance {

struct Card {
  EngineInfo engine;
  std::vector<Outcome> outcomes;

  int count(Status status) const noexcept;
};

/// Runs the checks of these names, or all if there are none.
/// @param progress  told after each
/// @throws ConfigError for an engine or a check that is not there
Card check_engine(std::string_view engine, const std::vector<std::string>& only, const Progress& progress);

/// Names a status: "passed", "failed", "skipped".
std::string_view name(Status status);

/// Describes every check with what it proves, every number with its bound; at the end how many passed, failed
/// and were skipped, and which.
std::string describe(const Card& card);
/// Writes a card as docs/schemas/conformance.json describes it.
nlohmann::ordered_json to_json(const Card& card);

/// Lists the topics of all checks, in their order.
std::vector<std::string> topics();
/// Tabulates the checks of these topics with proof, requirement and precondition, each topic under a heading,
/// as in docs/generated/checks-*.md.
std::string markdown_of_checks(const std::vector<std::string>& topics);

}  // namespace crossgait::conformance
