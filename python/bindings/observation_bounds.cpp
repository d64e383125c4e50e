#include "python/bindings/observation_bounds.h"

#include "physics/core/check_size.h"

namespace crossgait::python {

namespace nb = nanobind;

void ObservationBounds::set(const Layout& layout, std::span<const double> low, std::span<const double> high) {
  check_size("environment", "observation bounds", low.size(), layout.size());
  check_size("environment", "observation bounds", high.size(), layout.size());
  low_.assign(low.begin(), low.end());
  high_.assign(high.begin(), high.end());
  names_ = layout.names();
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
