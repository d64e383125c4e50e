#include "python/bindings/observation_bounds.h"

namespace crossgait::python {

namespace nb = nanobind;

ObservationBounds::ObservationBounds(const Layout& layout) : names_(layout.names()) {
  for (const LayoutEntry& entry : layout.entries) {
    low_.push_back(entry.low());
    high_.push_back(entry.high());
  }
}

void ObservationBounds::find(std::span<const double> observation, std::vector<std::size_t>& outside) const {
  outside.clear();
  // Hardly ever is there one: without a branch first.
  bool any = false;
  for (std::size_t i = 0; i < low_.size(); ++i)
    any |= (observation[i] < low_[i]) | (observation[i] > high_[i]);
  if (!any) return;
  for (std::size_t i = 0; i < low_.size(); ++i) {
    if (observation[i] < low_[i] || observation[i] > high_[i]) outside.push_back(i);
  }
}

nb::tuple ObservationBounds::names(const std::vector<std::size_t>& outside) const {
  nb::list names;
  for (const std::size_t i : outside) names.append(names_[i].c_str());
  return nb::tuple(names);
}

}  // namespace crossgait::python
