#include "conformance/check.h"

#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "backends/registry.h"
#include "conformance/topics.h"
#include "scenes/scenes.h"

namespace crossgait::conformance {

std::unique_ptr<PhysicsBackend> Subject::make(const std::shared_ptr<const RobotDescription>& robot) const {
  return engine.make(scenes::world_of(robot));
}

Subject subject_of(std::string_view engine) {
  Subject subject{find_engine(engine), {}};
  for (const std::string& name : available_engines())
    if (name != subject.engine.name()) subject.others.push_back(find_engine(name));
  return subject;
}

namespace {

// What stands on both sides of a bound, each where it is finite.
std::string words_of(const Bounds& bounds, const std::string& low, const std::string& high) {
  if (std::isinf(bounds.low)) return std::isinf(bounds.high) ? "reported" : "<= " + high;
  return std::isinf(bounds.high) ? ">= " + low : low + " to " + high;
}

// "100 eps", "1e-11 + 100 eps".
std::string with_roundings(double bound, char sign, double roundings) {
  if (roundings == 0) return fmt::format("{:.4g}", bound);
  if (bound == 0 && sign == '+') return fmt::format("{:.6g} eps", roundings);
  return fmt::format("{:.4g} {} {:.6g} eps", bound, sign, roundings);
}

}  // namespace

Bounds Requirement::bounds(Precision precision) const noexcept {
  const double rounding = roundings * epsilon(precision);
  return {exact.low - rounding, exact.high + rounding};
}

bool Requirement::holds(double value, Precision precision) const noexcept {
  const Bounds within = bounds(precision);
  return std::isfinite(value) && value >= within.low && value <= within.high;
}

std::string Requirement::bound(Precision precision) const {
  const Bounds within = bounds(precision);
  return words_of(within, fmt::format("{:.4g}", within.low), fmt::format("{:.4g}", within.high));
}

std::string Requirement::bound() const {
  return words_of(exact, with_roundings(exact.low, '-', roundings),
                  with_roundings(exact.high, '+', roundings));
}

Requirement at_most(double bound, std::string what, std::string unit, std::string reason) {
  return {std::move(what), std::move(unit), {.high = bound}, std::move(reason)};
}

Requirement rounds_to(double roundings, std::string what, std::string unit, std::string reason) {
  return {std::move(what), std::move(unit), {.high = 0}, std::move(reason), roundings};
}

Requirement with_rounding(Requirement requirement, double roundings) {
  requirement.roundings = roundings;
  return requirement;
}

Requirement at_least(double bound, std::string what, std::string unit, std::string reason) {
  return {std::move(what), std::move(unit), {.low = bound}, std::move(reason)};
}

Requirement between(double low, double high, std::string what, std::string unit, std::string reason) {
  return {std::move(what), std::move(unit), {low, high}, std::move(reason)};
}

const std::vector<Check>& checks() {
  static const std::vector<Check> kChecks = [] {
    using Checks = std::vector<Check> (*)();
    const std::pair<const char*, Checks> topics[] = {{"model", model_checks},
                                                     {"free motion", free_motion_checks},
                                                     {"joints", joint_checks},
                                                     {"ground", ground_checks},
                                                     {"friction", friction_checks},
                                                     {"contacts", contact_checks},
                                                     {"shapes", shape_checks},
                                                     {"loops", loop_checks},
                                                     {"couplings", coupling_checks},
                                                     {"joint friction", joint_friction_checks},
                                                     {"joint limits", joint_limit_checks},
                                                     {"implicit servos", implicit_servo_checks},
                                                     {"determinism", determinism_checks},
                                                     {"parity", parity_checks}};
    std::vector<Check> all;
    for (const auto& [topic, checks_of_topic] : topics) {
      for (Check& check : checks_of_topic()) {
        check.topic = topic;
        all.push_back(std::move(check));
      }
    }
    return all;
  }();
  return kChecks;
}

Outcome run_check(const Check& check, const Subject& subject) {
  Outcome outcome{&check, Status::kFailed, {}, ""};
  if (check.precondition.is_met != nullptr && !check.precondition.is_met(subject)) {
    outcome.status = Status::kSkipped;
    outcome.reason = check.precondition.what;
    return outcome;
  }
  try {
    outcome.values = check.measure(subject);
  } catch (const std::bad_alloc&) {
    throw;  // says nothing of the engine
  } catch (const std::exception& error) {
    outcome.reason = error.what();
    return outcome;
  }
  if (outcome.values.size() != check.requirements.size())
    throw std::logic_error(fmt::format("{}: {} values for {} requirements", check.name, outcome.values.size(),
                                       check.requirements.size()));
  bool all_hold = true;
  for (std::size_t i = 0; i < outcome.values.size(); ++i)
    all_hold = all_hold && check.requirements[i].holds(outcome.values[i], subject.precision());
  if (all_hold) outcome.status = Status::kPassed;
  return outcome;
}

}  // namespace crossgait::conformance
