// What contact and joint friction of `dart` are made of, piece by piece.
#pragma once

#include "crossgait/backends/contact/law_factors.h"

namespace crossgait::dart {

/// All off: MuJoCo's law in DART's dynamics. All on: hard contact with Coulomb's disc, solved to convergence.
using DartFactors = contact::LawFactors;
inline constexpr DartFactors kMatched{};
inline constexpr DartFactors kHard{true, true, true, true, true, true};

/// From "dart:matched" to "dart".
const contact::FactorTable<DartFactors>& factor_table();

}  // namespace crossgait::dart
