#include "python/bindings/trace_numbers.h"

#include <algorithm>

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "python/bindings/arrays.h"

namespace crossgait::python {

void TraceNumbers::add(const TraceSample& sample) {
  if (!columns_) columns_.emplace(*robot_, sample);
  columns_->append(sample, numbers_);
}

std::vector<std::string> TraceNumbers::names() const {
  return columns_ ? columns_->names() : std::vector<std::string>();
}

nb::object TraceNumbers::table() const {
  const std::size_t width = columns_ ? columns_->names().size() : 1;
  const NewArray<double> table(numbers_.size() / width, width);
  std::copy(numbers_.begin(), numbers_.end(), table.data);
  return table.array;
}

TraceSinks sinks_of(const Traces& traces) {
  TraceSinks sinks;
  for (TraceNumbers& trace : *traces) sinks.push_back(&trace);
  return sinks;
}

nb::object to_python(const Traces& traces) {
  if (traces->empty()) return nb::none();
  nb::list runs;
  for (const TraceNumbers& trace : *traces) runs.append(nb::make_tuple(trace.names(), trace.table()));
  return runs;
}

}  // namespace crossgait::python
