// The plug-in libcrossgait_engine_mujoco.so.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include "crossgait/backends/mujoco/mjcf_compiler.h"
#include "crossgait/backends/mujoco/mujoco_backend.h"
#include "crossgait/physics/engine_plugin.h"
#include "crossgait/physics/error.h"

namespace crossgait::mujoco {
namespace {

// 222 is 2.2.2; from 3.5.0 on MuJoCo counts in thousands: 3005000.
std::string version_of(int number) {
  const int base = number < 1'000'000 ? 10 : 1000;
  return fmt::format("{}.{}.{}", number / (base * base), number / base % base, number % base);
}

std::optional<Engine> find(std::string_view name) {
  const auto [base, changes] = split_factors(name);
  if (base != "mujoco") return std::nullopt;
  if (!changes.empty()) throw ConfigError("engine", "mujoco", "no factors: it has none", changes);
  return engine();
}

constexpr EnginePlugin kPlugin{
    .rank = 0,
    .header_version = [] { return version_of(mjVERSION_HEADER); },
    .library_version = [] { return version_of(mj_version()); },
    .engines =
        [] {
          return std::vector<OfferedEngine>{
              {engine().info, "MuJoCo: soft contact, elliptic friction cones, Newton solver"}};
        },
    .families = [] { return std::vector<EngineFamily>(); },
    .find = find,
    .compile_mjcf = compile_text,
};

}  // namespace
}  // namespace crossgait::mujoco

const crossgait::EnginePlugin* crossgait_engine_plugin() { return &crossgait::mujoco::kPlugin; }
