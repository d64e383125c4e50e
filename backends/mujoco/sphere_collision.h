// Replaces MuJoCo's sphere-heightfield narrowphase by Crossgait's exact one.
#pragma once

#include <mujoco/mujoco.h>

#include "crossgait/physics/terrain.h"

namespace crossgait::mujoco {

/// MuJoCo collides a sphere with the prisms of a height field: two contacts on perfectly flat ground, one of
/// them tilted by 5.5 degrees. `HeightField::touch_sphere` gives the deepest point alone, the same in every
/// engine. MuJoCo's collision table is process-wide, so the replacement looks for the terrain in
/// `d->userdata` and leaves models of other libraries (nuserdata == 0) to MuJoCo's own routine. Installed
/// once, thread-safe.
void install_sphere_collision();

/// Tells the routine which terrain `d` stands on. mj_resetData forgets it. The terrain must outlive `d`.
void set_terrain(const mjModel* m, mjData* d, const Terrain* terrain);

}  // namespace crossgait::mujoco
