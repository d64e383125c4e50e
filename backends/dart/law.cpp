#include "backends/dart/law.h"

namespace crossgait::dart {

const contact::FactorTable<DartFactors>& factor_table() {
  static const contact::FactorTable<DartFactors> kTable{"dart:matched", "dart", contact::law_factor_rows()};
  return kTable;
}

std::optional<DartFactors> find_factors(std::string_view name) {
  const auto [base, changes] = split_factors(name);
  if (base == "dart:matched") return factor_table().changed(kMatched, changes, name);
  if (base != "dart") return std::nullopt;
  if (changes == "+pyramid") return kPyramid;
  if (changes == "+stock") return kStock;
  return factor_table().changed(kHard, changes, name);
}

std::string name_of(const DartFactors& factors) {
  if (factors.pyramid) return "dart+pyramid";
  if (factors.stock) return "dart+stock";
  return factor_table().name_of(factors);
}

}  // namespace crossgait::dart
