// What every engine is held to, as values: the tests and `crossgait conformance` run the same checks.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "physics/engine/engine.h"

/// Checks of engines through nothing but the public interface; docs/generated/checks-*.md list them.
namespace crossgait::conformance {

/// Holds the engine that is asked, and those that it may be compared with.
struct Subject {
  Engine engine;
  std::vector<Engine> others;  ///< the available ones in the order of the registry

  Precision precision() const noexcept { return engine.info.capabilities.precision; }
  std::unique_ptr<PhysicsBackend> make(const WorldSpec& spec) const { return engine.make(spec); }
  /// Makes a world of the robot that has everything else by default.
  std::unique_ptr<PhysicsBackend> make(const std::shared_ptr<const RobotDescription>& robot) const;
};

/// @throws ConfigError as find_engine
Subject subject_of(std::string_view engine);

/// Says where a number has to lie, bounds included.
struct Bounds {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
};

/// Describes a number that a check measures, and where it has to lie. One that is not finite lies nowhere.
struct Requirement {
  std::string what, unit;  ///< unit is empty for a pure number
  Bounds exact = {};       ///< in an engine that does not round
  std::string reason;      ///< why just there
  double roundings = 0;    ///< what an engine's rounding comes to at most, in epsilon() of its precision

  /// Returns the bounds of an engine of this precision: `exact` with its roundings on both sides.
  Bounds bounds(Precision precision) const noexcept;
  bool holds(double value, Precision precision) const noexcept;
  /// Returns the bound as text: "<= 1e-11", ">= 0.3", "0.48 to 0.52", "reported" if it has none.
  std::string bound(Precision precision) const;
  /// Returns the bound for engines of any precision: "<= 100 eps", "<= 1e-11 + 100 eps", "0.48 - 9 eps to
  /// 0.52 + 9 eps".
  std::string bound() const;
};

/// Requires at most so much. @param reason  why just there
Requirement at_most(double bound, std::string what, std::string unit, std::string reason);
/// Requires at most what rounding comes to. @param roundings  epsilon() of the engine's precision
Requirement rounds_to(double roundings, std::string what, std::string unit, std::string reason);
/// Returns the requirement with bounds that give way by an engine's rounding.
Requirement with_rounding(Requirement requirement, double roundings);
Requirement at_least(double bound, std::string what, std::string unit, std::string reason);
Requirement between(double low, double high, std::string what, std::string unit, std::string reason);

/// Says what an engine must declare for a check to mean anything: the only thing that one is skipped for.
struct Precondition {
  std::string what;  ///< in words: "Laws::joint_friction is not empty"; empty if there is none
  bool (*is_met)(const Subject&) = nullptr;
};

struct Check {
  std::string name;       ///< "free_fall"
  std::string statement;  ///< one sentence
  std::vector<Requirement> requirements;
  /// Measures one value for each requirement, in their order. Throws if the engine diverges or refuses.
  std::function<std::vector<double>(const Subject&)> measure;
  Precondition precondition = {};
  std::string topic = {};  ///< what it is about: "joint friction"; set by checks()
};

/// Lists all checks in an order in which a fault shows first where its cause is.
const std::vector<Check>& checks();

enum class Status { kPassed, kFailed, kSkipped };

struct Outcome {
  const Check* check = nullptr;
  Status status = Status::kFailed;
  std::vector<double> values;  ///< of the requirements; empty where nothing was measured
  std::string reason;          ///< what was thrown, or the need that is not met
};

Outcome run_check(const Check& check, const Subject& subject);

}  // namespace crossgait::conformance
