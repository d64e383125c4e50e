#include "crossgait/backends/mujoco/sphere_collision.h"

#include <mutex>

#include <mujoco/mujoco.h>

#include "crossgait/backends/mujoco/engine_call.h"

namespace crossgait::mujoco {
namespace {

mjfCollision& field_sphere_entry() { return mjCOLLISIONFUNC[mjGEOM_HFIELD][mjGEOM_SPHERE]; }

mjfCollision original_routine = nullptr;

int collide(const mjModel* m, const mjData* d, mjContact* contact, int field, int sphere, mjtNum margin) {
  const Terrain* terrain = terrain_of(m);
  if (terrain == nullptr) return original_routine(m, d, contact, field, sphere, margin);

  const mjtNum* p = d->geom_xpos + 3 * sphere;
  SphereContact touch;
  if (!terrain->touch_sphere(Vector3(p[0], p[1], p[2]), m->geom_size[3 * sphere], touch)) return 0;
  contact->dist = touch.distance;
  mju_copy3(contact->pos, touch.position.data());
  mju_copy3(contact->frame, touch.normal.data());
  mju_zero3(contact->frame + 3);  // MuJoCo completes the tangents
  return 1;
}

}  // namespace

void install_sphere_collision() {
  static std::once_flag once;
  std::call_once(once, [] {
    original_routine = field_sphere_entry();
    field_sphere_entry() = collide;
  });
}

}  // namespace crossgait::mujoco
