// The checks of conformance/ as tests: with the figures that they measured.
#pragma once

#include <string>
#include <vector>

#include "conformance/check.h"

namespace crossgait::conformance {

std::vector<std::string> names_of_checks();

/// @throws std::logic_error for a name that no check has
const Check& check_of(const std::string& name);

/// Runs the check of this name, which there has to be, in the engine; skips the test if the engine does not
/// declare what the check needs.
void expect_holds(const std::string& name, const std::string& engine);

}  // namespace crossgait::conformance
