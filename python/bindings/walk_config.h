// What to walk, said in Python's terms.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <nanobind/nanobind.h>

#include "study/walk_config.h"

namespace crossgait::python {

void bind_walk_config(nanobind::module_& m);

}  // namespace crossgait::python
