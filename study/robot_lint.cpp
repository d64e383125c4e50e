#include "study/robot_lint.h"

#include <algorithm>
#include <cctype>
#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "physics/core/error.h"
#include "physics/core/read_budget.h"
#include "physics/core/schema.h"
#include "physics/core/text.h"
#include "study/robot_quantities.h"
#include "study/trial_walk.h"
#include "study/version.h"

namespace crossgait {
namespace {

using nlohmann::ordered_json;

std::string key_of(std::string_view file, std::string_view of, std::string_view what) {
  std::string key = fmt::format("{}|{}|{}", file, of, what);
  std::erase_if(key,
                [](unsigned char c) { return std::isdigit(c) != 0 || c == '.' || c == '-' || c == '+'; });
  return key;
}

/// "link" of "link 'shin'".
std::string rule_of(const RobotFinding& finding) { return finding.of.substr(0, finding.of.find(' ')); }

std::string_view sarif_level(Severity severity) {
  return severity == Severity::kNote ? std::string_view("note") : name(severity);
}

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
    }
  }
  return out;
}

std::string lines_of(const LintReport& report) {
  std::string text;
  for (const LintedRobot& robot : report.robots) {
    for (const RobotFinding& finding : robot.findings)
      text += fmt::format("{}: {}: {}{}\n", robot.file, name(finding.severity), describe(finding),
                          report.is_known(robot, finding) ? " (known)" : "");
    if (robot.findings.empty()) text += fmt::format("{}: nothing found\n", robot.file);
  }
  return text + fmt::format("{} new error(s), {} new warning(s)\n", report.count_new(Severity::kError),
                            report.count_new(Severity::kWarning) - report.count_new(Severity::kError));
}

ordered_json json_of(const LintReport& report) {
  ordered_json files = ordered_json::array();
  for (const LintedRobot& robot : report.robots) {
    ordered_json findings = to_json(robot.findings);
    for (std::size_t i = 0; i < robot.findings.size(); ++i)
      findings[i]["known"] = report.is_known(robot, robot.findings[i]);
    files.push_back({{"file", robot.file}, {"findings", std::move(findings)}});
  }
  return with_schema("robots",
                     {{"files", std::move(files)}, {"new_errors", report.count_new(Severity::kError)}});
}

ordered_json sarif_of(const LintReport& report) {
  ordered_json results = ordered_json::array();
  std::set<std::string> rules;
  for (const LintedRobot& robot : report.robots) {
    for (const RobotFinding& finding : robot.findings) {
      rules.insert(rule_of(finding));
      results.push_back(
          {{"ruleId", rule_of(finding)},
           {"level", sarif_level(finding.severity)},
           {"message", {{"text", describe(finding)}}},
           {"baselineState", report.is_known(robot, finding) ? "unchanged" : "new"},
           {"locations",
            ordered_json::array({{{"physicalLocation", {{"artifactLocation", {{"uri", robot.file}}}}}}})}});
    }
  }
  ordered_json listed = ordered_json::array();
  for (const std::string& rule : rules) listed.push_back({{"id", rule}});
  ordered_json run{
      {"tool", {{"driver", {{"name", "crossgait"}, {"version", crossgait_version()}, {"rules", listed}}}}},
      {"results", std::move(results)}};
  return {{"version", "2.1.0"},
          {"$schema", "https://json.schemastore.org/sarif-2.1.0.json"},
          {"runs", ordered_json::array({std::move(run)})}};
}

std::string junit_of(const LintReport& report) {
  std::string text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n";
  for (const LintedRobot& robot : report.robots) {
    std::string cases;
    std::size_t failures = 0;
    for (const RobotFinding& finding : robot.findings) {
      const bool fails = finding.severity == Severity::kError && !report.is_known(robot, finding);
      failures += fails ? 1 : 0;
      const std::string said = escaped(describe(finding));
      cases +=
          fmt::format("  <testcase classname=\"{}\" name=\"{}\">{}</testcase>\n", escaped(robot.file), said,
                      fails ? fmt::format("<failure message=\"{}\"/>", said)
                            : fmt::format("<system-out>{}</system-out>", name(finding.severity)));
    }
    if (robot.findings.empty())
      cases = fmt::format("  <testcase classname=\"{}\" name=\"nothing found\"/>\n", escaped(robot.file));
    text +=
        fmt::format(" <testsuite name=\"{}\" tests=\"{}\" failures=\"{}\">\n{} </testsuite>\n",
                    escaped(robot.file), std::max<std::size_t>(1, robot.findings.size()), failures, cases);
  }
  return text + "</testsuites>\n";
}

}  // namespace

LintedRobot lint_robot(const std::string& file, const std::vector<std::string>& engines) {
  LintedRobot linted{file, {}};
  try {
    const LoadedRobot loaded = load_robot_with_report(file);
    linted.findings = all_findings(loaded, world_of(loaded));
    const bool is_real = linted.findings.empty() || linted.findings.front().severity != Severity::kError;
    const Trial tried = try_robot(std::make_shared<const RobotDescription>(loaded.robot), engines);
    const Trial trial = is_real ? tried : without_advice(tried);
    for (const TrialWalk& walk : trial.walks) {
      if (walk.failures.empty()) continue;
      linted.findings.push_back({Severity::kError, fmt::format("walk in {}", walk.engine),
                                 fmt::format("{}", fmt::join(walk.failures, "; ")),
                                 is_real ? "" : "what the errors above say"});
    }
  } catch (const ConfigError& error) {
    linted.findings.push_back({Severity::kError, "file", error.what(), ""});
  }
  std::ranges::stable_sort(linted.findings, std::ranges::greater{}, &RobotFinding::severity);
  return linted;
}

LintBaseline read_baseline(const std::string& file) {
  const std::string text = read_text_file(file, kResultBudget);
  check_json_budget(text, kResultBudget, file);
  const ordered_json json = ordered_json::parse(text, nullptr, false);
  LintBaseline known;
  try {
    for (const ordered_json& robot : json.at("files")) {
      for (const ordered_json& finding : robot.at("findings"))
        known.insert(key_of(robot.at("file").get<std::string>(), finding.at("of").get<std::string>(),
                            finding.at("what").get<std::string>()));
    }
  } catch (const nlohmann::json::exception&) {
    throw ConfigError(file, "files", "findings of an earlier `crossgait robots --check --format json`",
                      "something else");
  }
  return known;
}

bool LintReport::is_known(const LintedRobot& robot, const RobotFinding& finding) const {
  return known.contains(key_of(robot.file, finding.of, finding.what));
}

std::size_t LintReport::count_new(Severity least) const {
  std::size_t count = 0;
  for (const LintedRobot& robot : robots) {
    for (const RobotFinding& finding : robot.findings)
      count += finding.severity >= least && !is_known(robot, finding) ? 1 : 0;
  }
  return count;
}

std::string LintReport::text(LintFormat format) const {
  switch (format) {
    case LintFormat::kJson:
      return json_of(*this).dump(2) + "\n";
    case LintFormat::kSarif:
      return sarif_of(*this).dump(2) + "\n";
    case LintFormat::kJunit:
      return junit_of(*this);
    case LintFormat::kText:
      break;
  }
  return lines_of(*this);
}

}  // namespace crossgait
