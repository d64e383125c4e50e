// Terms of environments that are functions in Python.
#pragma once

#include <nanobind/nanobind.h>

#include "env/env_config.h"

namespace crossgait::python {

/// Binds `with_terms`, `without_terms`, `terms` and `layouts` of a configuration.
void bind_terms(nanobind::class_<EnvConfig>& config);

}  // namespace crossgait::python
