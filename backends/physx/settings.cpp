#include "backends/physx/settings.h"

namespace crossgait::physx {
namespace {

Settings all_off() {
  Settings settings;
  for (const auto& row : factor_table().rows) settings.*row.member = false;
  return settings;
}

Settings named(Settings settings) {
  settings.name = factor_table().name_of(settings);
  if (settings.name == "physx-temporal") settings.name = "physx:pgs";
  return settings;
}

}  // namespace

const contact::FactorTable<Settings>& factor_table() {
  using S = Settings;
  static const contact::FactorTable<Settings> kTable{
      "physx:hard",
      "physx",
      {{{"margin", "points count from 20 mm above the ground, not from a fiftieth of a body's reach", {}},
        &S::margin},
       {{"push_out", "0.8 of a penetration is undone in a step, without a bound of speed", {}}, &S::push_out},
       {{"solver", "PhysX's own rows, friction of patches and projected solver", {"push_out"}}, &S::solver},
       {{"loops",
         "loops are hard, not soft by MuJoCo's law",
         {"push_out", "solver"},
         [](const RobotDescription& robot) { return !robot.loops.empty(); }},
        &S::loops},
       {{"sweeps", "4 iterations of positions and 1 of velocities, not 255", {"push_out", "solver"}},
        &S::sweeps},
       {{"temporal",
         "positions move within a step, and friction is bounded by a disc, not a pyramid",
         {"push_out", "solver", "loops", "sweeps"}},
        &S::temporal}}};
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
  Settings end;
  if (base == factor_table().off) {
    end = all_off();
  } else if (base == "physx:pgs") {
    end.temporal = false;
  } else if (base != factor_table().on) {
    return std::nullopt;
  }
  return named(factor_table().changed(end, changes, name));
}

}  // namespace crossgait::physx
