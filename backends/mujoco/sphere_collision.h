// Replaces MuJoCo's sphere-heightfield narrowphase by Crossgait's exact one.
#pragma once

namespace crossgait::mujoco {

/// MuJoCo collides a sphere with the prisms of a height field: two contacts on perfectly flat ground, one of
/// them tilted by 5.5 degrees. `HeightField::touch_sphere` gives the deepest point alone, the same in every
/// engine. MuJoCo's collision table is process-wide, so the replacement works for the model that its thread
/// is stepping for Crossgait (engine_call.h) and hands all others to the routine that stood in the table
/// before. Installed once, thread-safe. A routine that somebody puts into the table later is used for our
/// models too.
void install_sphere_collision();

}  // namespace crossgait::mujoco
