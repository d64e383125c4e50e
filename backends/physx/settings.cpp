#include "backends/physx/settings.h"

namespace crossgait::physx {

const contact::FactorTable<Settings>& factor_table() {
  static const contact::FactorTable<Settings> kTable{
      "physx:pgs",
      "physx",
      {{{"temporal", "positions move within a step, and friction is bounded by a disc, not a pyramid", {}},
        &Settings::temporal}}};
  return kTable;
}

std::optional<Settings> find_settings(std::string_view name) {
  // What stands beside these in files that train (step, decimation, gains, restitution, limits of speed) is
  // the world's or the robot's here, or off.
  for (const Settings& preset :
       {Settings{
            .name = "physx+isaacgym", .velocity_iterations = 0, .contact_offset = 0.01, .depenetration = 1},
        Settings{.name = "physx+isaaclab", .velocity_iterations = 0, .depenetration = 1}}) {
    if (preset.name == name) return preset;
  }
  const auto [base, changes] = split_factors(name);
  if (base != factor_table().off && base != factor_table().on) return std::nullopt;
  Settings settings =
      factor_table().changed({.name = {}, .temporal = base == factor_table().on}, changes, name);
  settings.name = factor_table().name_of(settings);
  return settings;
}

}  // namespace crossgait::physx
