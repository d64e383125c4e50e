// A physics engine as a value: its name, what it is, and how to make a world in it.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "physics/engine/physics_backend.h"

namespace crossgait {

/// Describes one engine in one mode.
struct Engine {
  EngineInfo info;
  /// Makes a world of its own. May be called from several threads at once.
  /// Throws ConfigError if the specification is invalid or the engine refuses the model.
  std::function<std::unique_ptr<PhysicsBackend>(const WorldSpec&)> make;

  const std::string& name() const noexcept { return info.name; }
};

/// The same engine, in which every world is changed before it is made.
Engine with_change(Engine engine, std::function<void(WorldSpec&)> change);

/// Splits a name from the factors behind it: "bullet:matched+surface" -> "bullet:matched" and "+surface".
std::pair<std::string_view, std::string_view> split_factors(std::string_view name);
/// Takes the first change, its sign included, off `changes`, which are not empty: "+surface-coulomb" gives
/// "+surface".
std::string_view pop_modifier(std::string_view& changes);

/// Describes one modelling choice in which two engines differ and that can be changed on its own: a factor,
/// as in a factorial experiment.
struct ModelFactor {
  std::string name, summary;
  std::vector<std::string> needs;  ///< factors without which it means nothing; they come before it
  /// Tells whether the factor can change anything of this robot's motion; null: any robot's.
  bool (*applies_to)(const RobotDescription&) = nullptr;
  /// The modelling decision that it is a half of ("rigid contact"); factors of one group stand side by side
  /// in a family. Empty: a decision of its own, which goes by the factor's name.
  std::string group = {};
};

/// Holds two engines and everything that is different between them.
struct EngineFamily {
  std::string from, to;  ///< names of the engines without and with all factors
  std::vector<ModelFactor> factors;
  /// The engine with exactly these factors, in the order of the table.
  std::function<Engine(const std::vector<std::string>& names)> with;

  /// @throws ConfigError if there are none, more than 10 (every set of them is run), or one needs what does
  /// not come before it
  void validate() const;
};

/// Drops the factors that do not concern `robot`, each of which takes part where one that needs it does.
EngineFamily family_for(EngineFamily family, const RobotDescription& robot);

}  // namespace crossgait
