// Traces read back from their files.
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "motion/trace_table.h"
#include "python/bindings/arrays.h"
#include "python/bindings/bindings.h"

namespace crossgait::python {
namespace {

std::pair<std::vector<std::string>, nb::object> read_trace(const std::string& path) {
  const TraceTable table = [&path] {
    const nb::gil_scoped_release release;
    return TraceTable(path);
  }();
  const std::size_t rows = table.rows(), width = table.names().size();
  const NewArray<double> values(rows, width);
  for (std::size_t i = 0; i < width; ++i) {
    const std::vector<double>& column = table.column(table.names()[i]);
    for (std::size_t row = 0; row < rows; ++row) values.data[row * width + i] = column[row];
  }
  return {table.names(), values.array};
}

}  // namespace

void bind_trace_file(nb::module_& m) {
  m.def("_read_trace", &read_trace, nb::arg("path"),
        nb::sig("def _read_trace(path: str) -> tuple[list[str], numpy.typing.NDArray[numpy.float64]]"),
        "Names of columns and a row per instant. Raises ConfigError.");
}

}  // namespace crossgait::python
