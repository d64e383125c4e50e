#include "crossgait/backends/dart/law.h"

namespace crossgait::dart {

const contact::FactorTable<DartFactors>& factor_table() {
  static const contact::FactorTable<DartFactors> kTable{"dart:matched", "dart", contact::law_factor_rows()};
  return kTable;
}

}  // namespace crossgait::dart
