// Which numbers of an observation lie outside the bounds of its layout.
#pragma once

#include <span>
#include <vector>

#include <nanobind/nanobind.h>

#include "policy/layout.h"

namespace crossgait::python {

class ObservationBounds {
 public:
  /// Takes LayoutEntry::low and LayoutEntry::high.
  explicit ObservationBounds(const Layout& layout);
  /// Finds indices of those outside, replacing `outside`.
  void find(std::span<const double> observation, std::vector<std::size_t>& outside) const;
  /// Returns the entries' names, a tuple of str.
  nanobind::tuple names(const std::vector<std::size_t>& outside) const;

 private:
  std::vector<double> low_, high_;
  std::vector<std::string> names_;
};

}  // namespace crossgait::python
