#include "conformance/card.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "physics/core/error.h"
#include "physics/core/schema.h"
#include "physics/core/table.h"

namespace crossgait::conformance {
namespace {

std::string with_unit(const Requirement& requirement) {
  return requirement.unit.empty() ? requirement.what
                                  : fmt::format("{} ({})", requirement.what, requirement.unit);
}

std::string describe(const Outcome& outcome, Precision precision) {
  const Check& check = *outcome.check;
  std::string text = fmt::format("{:7} {}: {}\n", name(outcome.status), check.name, check.statement);
  if (outcome.status == Status::kSkipped) text += fmt::format("          needs: {}\n", outcome.reason);
  if (outcome.status == Status::kFailed && !outcome.reason.empty())
    text += fmt::format("          {}\n", outcome.reason);
  for (std::size_t i = 0; i < outcome.values.size(); ++i) {
    const Requirement& requirement = check.requirements[i];
    const double value = outcome.values[i];
    text += fmt::format("        {} {:62} {:>10.4g}  {}\n", requirement.holds(value, precision) ? ' ' : '!',
                        with_unit(requirement), value, requirement.bound(precision));
  }
  return text;
}

std::string names_of(const Card& card, Status status) {
  std::vector<std::string> names;
  for (const Outcome& outcome : card.outcomes)
    if (outcome.status == status) names.push_back(outcome.check->name);
  return names.empty() ? "" : fmt::format(" ({})", fmt::join(names, ", "));
}

nlohmann::ordered_json number(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

nlohmann::ordered_json to_json(const Outcome& outcome, Precision precision) {
  const Check& check = *outcome.check;
  nlohmann::ordered_json measurements = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < outcome.values.size(); ++i) {
    const Requirement& requirement = check.requirements[i];
    const Bounds bounds = requirement.bounds(precision);
    measurements.push_back({{"what", requirement.what},
                            {"unit", requirement.unit},
                            {"value", number(outcome.values[i])},
                            {"low", number(bounds.low)},
                            {"high", number(bounds.high)},
                            {"why", requirement.reason},
                            {"holds", requirement.holds(outcome.values[i], precision)}});
  }
  return {{"name", check.name},
          {"topic", check.topic},
          {"statement", check.statement},
          {"precondition", check.precondition.what},
          {"status", name(outcome.status)},
          {"reason", outcome.reason},
          {"measurements", std::move(measurements)}};
}

std::vector<const Check*> chosen_checks(const std::vector<std::string>& only) {
  std::vector<const Check*> chosen;
  for (const Check& check : checks()) {
    if (only.empty() || std::find(only.begin(), only.end(), check.name) != only.end())
      chosen.push_back(&check);
  }
  for (const std::string& name : only) {
    const auto is_it = [&](const Check* check) { return check->name == name; };
    if (std::none_of(chosen.begin(), chosen.end(), is_it))
      throw ConfigError("conformance", "only", "names of checks (`crossgait conformance --list`)", name);
  }
  return chosen;
}

// A bar would end the cell.
std::string cell(const std::string& text) {
  std::string result;
  for (const char c : text) result += c == '|' ? std::string("\\|") : std::string(1, c);
  return result;
}

std::string rows_of(const Check& check) {
  const std::string precondition =
      check.precondition.what.empty() ? "" : fmt::format(" Needs: {}.", check.precondition.what);
  std::string rows =
      fmt::format("| `{}` | **{}.**{} | | |\n", check.name, cell(check.statement), cell(precondition));
  for (const Requirement& requirement : check.requirements)
    rows += fmt::format("| | {} | {} | {} |\n", cell(with_unit(requirement)), requirement.bound(),
                        cell(requirement.reason));
  return rows;
}

}  // namespace

int Card::count(Status status) const noexcept {
  return static_cast<int>(std::count_if(outcomes.begin(), outcomes.end(),
                                        [&](const Outcome& outcome) { return outcome.status == status; }));
}

Card check_engine(std::string_view engine, const std::vector<std::string>& only, const Progress& progress) {
  const std::vector<const Check*> chosen = chosen_checks(only);
  const Subject subject = subject_of(engine);
  Card card{subject.engine.info, {}};
  for (const Check* check : chosen) {
    card.outcomes.push_back(run_check(*check, subject));
    if (progress) progress(static_cast<double>(card.outcomes.size()) / static_cast<double>(chosen.size()));
  }
  return card;
}

std::string_view name(Status status) {
  constexpr std::array<std::string_view, 3> kNames{"passed", "failed", "skipped"};
  return kNames.at(static_cast<std::size_t>(status));
}

std::string describe(const Card& card) {
  const EngineInfo& engine = card.engine;
  const Precision precision = engine.capabilities.precision;
  std::string text = fmt::format("{}: {} {}, {}, {}\n", engine.name, engine.library, engine.version,
                                 engine.mode, name_of(precision));
  for (const Outcome& outcome : card.outcomes) text += describe(outcome, precision);
  text += fmt::format("\n{} passed", counted(static_cast<std::size_t>(card.count(Status::kPassed)), "check"));
  for (const Status status : {Status::kFailed, Status::kSkipped})
    text += fmt::format(", {} {}{}", card.count(status), name(status), names_of(card, status));
  return text + "\n";
}

nlohmann::ordered_json to_json(const Card& card) {
  const EngineInfo& engine = card.engine;
  const Precision precision = engine.capabilities.precision;
  nlohmann::ordered_json checks = nlohmann::ordered_json::array();
  for (const Outcome& outcome : card.outcomes) checks.push_back(to_json(outcome, precision));
  return with_schema("conformance", {{"engine",
                                      {{"name", engine.name},
                                       {"library", engine.library},
                                       {"version", engine.version},
                                       {"mode", engine.mode},
                                       {"contact_law", engine.laws.contact},
                                       {"loop_law", engine.laws.loops},
                                       {"joint_friction_law", engine.laws.joint_friction},
                                       {"joint_limit_law", engine.laws.joint_limits},
                                       {"coupling_law", engine.laws.couplings},
                                       {"implicit_servo_law", engine.laws.implicit_servos},
                                       {"precision", name_of(precision)}}},
                                     {"passed", card.count(Status::kPassed)},
                                     {"failed", card.count(Status::kFailed)},
                                     {"skipped", card.count(Status::kSkipped)},
                                     {"checks", std::move(checks)}});
}

std::vector<std::string> topics() {
  std::vector<std::string> found;
  for (const Check& check : checks())
    if (found.empty() || found.back() != check.topic) found.push_back(check.topic);
  return found;
}

std::string markdown_of_checks(const std::vector<std::string>& topics) {
  std::string text;
  for (const std::string& topic : topics) {
    text += text.empty() ? "" : "\n";
    text += fmt::format("## {}{}\n\n", static_cast<char>(std::toupper(topic.front())), topic.substr(1));
    text += "| check | what it proves; what is demanded | bound | why just there |\n|---|---|---|---|\n";
    for (const Check& check : checks())
      if (check.topic == topic) text += rows_of(check);
  }
  return text;
}

}  // namespace crossgait::conformance
