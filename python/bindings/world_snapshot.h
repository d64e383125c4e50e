// A saved instant of a world as Python has it: it knows which world it is of.
#pragma once

#include <string>

#include "physics/engine/physics_backend.h"

namespace crossgait::python {

struct WorldSnapshot : Snapshot {
  std::string
      world;  ///< robot, ground, contact and time step in words, which are those of the world that takes it
};

}  // namespace crossgait::python
