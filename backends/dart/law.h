// What contact, joint friction and joint limits of `dart` are made of, piece by piece.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "backends/contact/law_factors.h"

namespace crossgait::dart {

/// Holds MuJoCo's law in DART if all are off; if all are on, hard contact with a disc, to convergence.
using DartFactors = contact::LawFactors;
inline constexpr DartFactors kMatched{};
inline constexpr DartFactors kHard = contact::kHardLaw;
inline constexpr DartFactors kPyramid{true, true, true, true, true, true, true, true};
inline constexpr DartFactors kStock{true, true, true, true, false, true, true, false, true};

/// Returns the factors from "dart:matched" to "dart".
const contact::FactorTable<DartFactors>& factor_table();

/// Reads a name: an end with changes behind it, "dart+pyramid" (friction bounded by a pyramid along the slip)
/// or "dart+stock" (contact as DART ships: no point above the ground counts). Nothing for a name of others.
/// @throws ConfigError if a change is invalid
std::optional<DartFactors> find_factors(std::string_view name);
/// Returns the shortest name.
std::string name_of(const DartFactors& factors);

}  // namespace crossgait::dart
