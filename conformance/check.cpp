#include "conformance/check.h"

#include <cmath>
#include <stdexcept>

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

bool Requirement::holds(double value) const noexcept {
  return std::isfinite(value) && value >= low && value <= high;
}

std::string Requirement::bound() const {
  if (std::isinf(low)) return std::isinf(high) ? "reported" : fmt::format("<= {:.4g}", high);
  if (std::isinf(high)) return fmt::format(">= {:.4g}", low);
  return fmt::format("{:.4g} to {:.4g}", low, high);
}

Requirement at_most(double bound, std::string what, std::string unit, std::string reason) {
  return {std::move(what), std::move(unit), -std::numeric_limits<double>::infinity(), bound,
          std::move(reason)};
}

Requirement at_least(double bound, std::string what, std::string unit, std::string reason) {
  return {std::move(what), std::move(unit), bound, std::numeric_limits<double>::infinity(),
          std::move(reason)};
}

Requirement between(double low, double high, std::string what, std::string unit, std::string reason) {
  return {std::move(what), std::move(unit), low, high, std::move(reason)};
}

const std::vector<Check>& checks() {
  static const std::vector<Check> kChecks = [] {
    std::vector<Check> all;
    for (const auto topic :
         {model_checks, free_motion_checks, joint_checks, ground_checks, friction_checks, contact_checks,
          shape_checks, loop_checks, joint_friction_checks, determinism_checks, parity_checks}) {
      for (Check& check : topic()) all.push_back(std::move(check));
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
  } catch (const std::exception& error) {
    outcome.reason = error.what();
    return outcome;
  }
  if (outcome.values.size() != check.requirements.size())
    throw std::logic_error(fmt::format("{}: {} values for {} requirements", check.name, outcome.values.size(),
                                       check.requirements.size()));
  bool all_hold = true;
  for (std::size_t i = 0; i < outcome.values.size(); ++i)
    all_hold = all_hold && check.requirements[i].holds(outcome.values[i]);
  if (all_hold) outcome.status = Status::kPassed;
  return outcome;
}

}  // namespace crossgait::conformance
