// Parameters of the worlds of environments: what Python sets, and what is set.
#pragma once

#include "python/bindings/batch.h"

namespace crossgait::python {

/// Changes worlds of `indices`, by names of quantities, on top of what is set. @throws ConfigError
void set_parameters(Batch& batch, const nanobind::dict& parameters, const Indices& indices);
/// Returns what is set, a dict for each environment, as `set_parameters` takes it.
nanobind::list parameters_of(const Batch& batch);

}  // namespace crossgait::python
