// The smallest engine: its robots are of stone.
#pragma once

#include <string>

#include "crossgait/physics/engine/engine.h"

namespace statue {

/// @param name  that it is chosen by  @param version  of the library behind it
crossgait::Engine engine(const std::string& name, const std::string& version);

}  // namespace statue
