// Two setups of one robot in one engine: A, as configured, and B, which is A with named changes.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "physics/engine/engine.h"

namespace crossgait {

/// Describes one thing in which B differs from A.
struct SetupChange {
  std::string name;      ///< of a quantity (world_quantities), or a part of another robot file (robot_parts)
  std::string group;     ///< what it is a part of: "gains", "mass properties", "contact"
  std::string text;      ///< "kp=x0.8"; of a file "gains of NAME@IDENTITY"
  std::string unit;      ///< of `from` and `to`
  std::string from, to;  ///< in A and in B; empty where it is no number
  std::function<void(WorldSpec&)> apply;
};

/// Lets the worlds alone differ: controller, starts and pushes are A's in both, whatever B is made of.
struct WorldSetup {
  std::string text;  ///< as asked for, files by their robot's name and the beginning of its identity
  WorldSpec a;
  WorldSpec b;
  std::vector<SetupChange> changes;  ///< in the order in which they are made: first what a robot file changes
};

/// Every set of factors is run, so there are no more of them than this.
inline constexpr std::size_t kMostSetupFactors = 8;
/// Says what is one factor of a gap between setups.
enum class SetupFactorOf {
  kChange,  ///< each change
  kGroup,   ///< all changes of one group, where there are too many
  kKind,    ///< where there are too many groups, those of servos, those of joints, and time step with gravity
};
/// Names a level: "change", "group", "kind".
std::string_view name(SetupFactorOf level) noexcept;
/// Returns the first that makes no more than kMostSetupFactors.
SetupFactorOf factors_of(const WorldSetup& setup);

/// Reads "friction=0.4,mass=x1.1,robot=other.yaml": names of world_quantities with a value or a factor, and
/// `robot`, another file of the same robot, whose parts that differ are a change each. Of contact such a file
/// changes what A has from its own file.
/// @throws ConfigError naming `source`: for unknown names, for what is named twice or changes nothing, and
/// for a world that cannot be
WorldSetup read_setup(const std::string& text, const WorldSpec& a, std::string_view source = "--against");

/// Returns `engine` with every world of it as it is under B. Its name says so: "mujoco with friction=0.4".
Engine with_setup(const Engine& engine, const WorldSetup& setup);

/// Returns the family from A to B by the factors of `factors_of`.
EngineFamily setup_family(const Engine& engine, const WorldSetup& setup);

/// Says what B changes, a line each, and what both have in common.
std::string describe(const WorldSetup& setup);
/// Writes `text`, `factor` ("change", "group" or "kind") and `changes` of `name, group, unit, from, to`.
nlohmann::ordered_json to_json(const WorldSetup& setup);

}  // namespace crossgait
