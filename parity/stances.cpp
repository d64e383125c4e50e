#include "parity/stances.h"

namespace crossgait {

double row_end(const std::vector<double>& time, std::size_t row) {
  if (row + 1 < time.size()) return time[row + 1];
  return row > 0 ? 2 * time[row] - time[row - 1] : time[row];
}

std::vector<Stance> stances(const std::vector<double>& time, const std::vector<double>& contact,
                            double shortest) {
  std::vector<Stance> all;
  for (std::size_t i = 0; i < contact.size(); ++i) {
    if (contact[i] == 0) continue;
    // A foot that bounces off for less than `shortest` has not left.
    const bool touches_down = i == 0 || contact[i - 1] == 0;
    if (touches_down && (all.empty() || time[i] - all.back().end >= shortest))
      all.push_back({time[i], time[i]});
    all.back().end = row_end(time, i);
  }
  std::erase_if(all, [shortest](const Stance& s) { return s.end - s.begin < shortest; });
  return all;
}

}  // namespace crossgait
