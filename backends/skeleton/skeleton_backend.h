// A small engine in plain code, to be read and copied.
#pragma once

#include <string>

#include "crossgait/physics/engine/engine.h"

namespace crossgait::skeleton {

/// @param version  that it says it has
Engine engine(const std::string& version);

}  // namespace crossgait::skeleton
