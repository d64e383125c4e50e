#include "backends/mujoco/read_model.h"

#include "physics/core/undivided.h"

namespace crossgait::mujoco {

mjModel* read_model(const mjVFS* files, char* error, int error_size) {
  const Undivided reading;
  return mj_loadXML("model.xml", files, error, error_size);
}

}  // namespace crossgait::mujoco
