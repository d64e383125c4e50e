// Terms of environments that are functions in Python.
#pragma once

#include <nanobind/nanobind.h>

#include "env/env_config.h"
#include "env/env_extension.h"

namespace crossgait::python {

/// Returns the `crossgait.terms.running.EpisodeTerms` of an environment, None before its first episode.
nanobind::object terms_at_work(const EnvExtension& extension);

/// Binds `with_terms`, `without_terms`, `terms` and `layouts` of a configuration.
void bind_terms(nanobind::class_<EnvConfig>& config);

}  // namespace crossgait::python
