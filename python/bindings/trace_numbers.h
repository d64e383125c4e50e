// Runs as tables of numbers, which Python takes as arrays.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nanobind/nanobind.h>

#include "motion/trace.h"

namespace crossgait::python {

/// Keeps a run as a table of numbers: rows of the columns of a trace.
class TraceNumbers final : public TraceSink {
 public:
  explicit TraceNumbers(std::shared_ptr<const RobotDescription> robot) : robot_(std::move(robot)) {}

  void add(const TraceSample& sample) override;
  std::vector<std::string> names() const;
  nanobind::object table() const;

 private:
  std::shared_ptr<const RobotDescription> robot_;
  std::optional<TraceColumns> columns_;
  std::vector<double> numbers_;
};

/// Holds one for each run, or none. A job whose caller is gone may go on filling them.
using Traces = std::shared_ptr<std::vector<TraceNumbers>>;

TraceSinks sinks_of(const Traces& traces);

/// Returns (names of its columns, table) of each run; None if there is no trace.
nanobind::object to_python(const Traces& traces);

}  // namespace crossgait::python
