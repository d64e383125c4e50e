#include "parity/variation.h"

#include <algorithm>
#include <cmath>

#include "physics/core/find_row.h"

namespace crossgait {
namespace {

using enum Variation::Kind;

bool softens_friction(const Capabilities& c) { return c.soft_friction; }
bool softens_contact(const Capabilities& c) { return c.soft_contact; }
bool reduces_error(const Capabilities& c) { return c.error_reduction; }
bool sweeps(const Capabilities& c) { return c.sweeps; }

// Settings that people of the field vary: files of quadrupeds ask MuJoCo for an impratio of 1, 10 or 100;
// contacts twice as stiff; Bullet ships with 10 sweeps, which is a tenth of what a world has here, and its
// worlds have an error reduction of 0.1 to 0.8.
const Variation kVariations[] = {
    {.name = "as asked"},
    {.name = "half the time step", .kind = kTimeStep, .step = 0.5},
    {.name = "a quarter of the time step", .kind = kTimeStep, .step = 0.25},
    {.name = "ten times the impratio", .kind = kSetting, .impratio = 10, .concerns = softens_friction},
    {.name = "half the softness", .kind = kSetting, .softness = 0.5, .concerns = softens_contact},
    {.name = "twice the error reduction", .kind = kSetting, .erp = 2, .concerns = reduces_error},
    {.name = "a tenth of the sweeps", .kind = kSetting, .iterations = 0.1, .concerns = sweeps},
};

}  // namespace

void Variation::apply(WorldSpec& world, double physics_dt) const {
  world.lengthen_time_constants(physics_dt);
  world.physics_dt *= step;
  world.solver.iterations = std::max(1, static_cast<int>(std::lround(world.solver.iterations * iterations)));
  world.contact.impratio *= impratio;
  world.contact.softness.time_constant *= softness;
  world.contact.erp *= erp;
}

std::span<const Variation> variations() { return kVariations; }
const Variation& nominal_variation() { return kVariations[0]; }
const Variation& half_step() { return kVariations[1]; }
const Variation& quarter_step() { return kVariations[2]; }

const Variation& find_variation(std::string_view name) {
  return find_row(kVariations, name, "run", "variation");
}

}  // namespace crossgait
