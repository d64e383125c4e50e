// The plug-ins libcrossgait_engine_mujoco.so and, of further releases, libcrossgait_engine_mujoco@VERSION.so.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include "backends/mujoco/mjcf_compiler.h"
#include "backends/mujoco/mujoco_backend.h"
#include "backends/mujoco/version.h"
#include "physics/core/error.h"
#include "physics/engine/engine_plugin.h"

namespace crossgait::mujoco {
namespace {

// 222 is 2.2.2; from 3.5.0 on MuJoCo counts in thousands: 3005000.
std::string version_of(int number) {
  const int base = number < 1'000'000 ? 10 : 1000;
  return fmt::format("{}.{}.{}", number / (base * base), number / base % base, number % base);
}

constexpr std::string_view kName = CROSSGAIT_ENGINE_NAME;

/// Changes of the law of the loops, one after the other, as far as there are any.
std::optional<Engine> find(std::string_view name) {
  auto [base, changes] = split_factors(name);
  if (base != kName) return std::nullopt;
  bool loop_bias = true;
  while (!changes.empty()) {
    const std::string_view change = pop_modifier(changes);
    if (!kHasLoopBias) throw ConfigError("engine", kName, "no factors: it has none", change);
    if (change != (loop_bias ? "-loop_bias" : "+loop_bias")) {
      throw ConfigError("engine", kName, loop_bias ? "-loop_bias" : "+loop_bias",
                        fmt::format("\"{}\"", change));
    }
    loop_bias = !loop_bias;
  }
  return engine(loop_bias);
}

std::vector<EngineFamily> families() {
  if (!kHasLoopBias) return {};
  EngineFamily family;
  family.from = engine(false).name();
  family.to = engine(true).name();
  family.factors = {{"loop_bias",
                     "loops' accelerations count what the motion makes of them (since MuJoCo 3.7)",
                     {},
                     [](const RobotDescription& robot) { return !robot.loops.empty(); }}};
  family.with = [](const std::vector<std::string>& names) { return engine(!names.empty()); };
  return {family};
}

constexpr EnginePlugin kPlugin{
    // Further releases come last, so that who asks for no engine in particular gets the same ones with and
    // without.
    .rank = kName == "mujoco" ? 0 : 20,
    .header_version = [] { return version_of(mjVERSION_HEADER); },
    .library_version = [] { return version_of(mj_version()); },
    .engines =
        [] {
          return std::vector<OfferedEngine>{
              {engine().info, "MuJoCo: soft contact, elliptic friction cones, Newton solver"}};
        },
    .families = families,
    .find = find,
    .compile_mjcf = compile_text,
};

}  // namespace
}  // namespace crossgait::mujoco

const crossgait::EnginePlugin* crossgait_engine_plugin() { return &crossgait::mujoco::kPlugin; }
