#include "parity/paired_test.h"

#include <algorithm>

namespace crossgait {

double PairedTest::p_beyond(double margin) const {
  return std::min(1.0, 2 * std::min(p_above(margin), p_below(-margin)));
}

double PairedTest::p_within(double margin) const { return std::max(p_above(-margin), p_below(margin)); }

}  // namespace crossgait
