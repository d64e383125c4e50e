// Environments as Python holds them.
#pragma once

#include <nanobind/nanobind.h>

#include "crossgait/env/quadruped_env.h"

namespace crossgait::python {

/// One environment with room for what its steps write.
struct Environment {
  std::shared_ptr<const EnvModel> model;
  std::unique_ptr<QuadrupedEnv> env;
  std::vector<double> action;  ///< of float32
};

/// A layout as names, units and bounds.
nanobind::object layout(const Layout& layout);

/// `info` of the last step: what Python's environments return beside observation and reward.
nanobind::dict info(const QuadrupedEnv& env);

}  // namespace crossgait::python
