// Findings on robots' files for people and for continuous integration.
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "study/robot_findings.h"

namespace crossgait {

struct LintedRobot {
  std::string file;
  std::vector<RobotFinding> findings;
};

enum class LintFormat { kText, kJson, kSarif, kJunit };

/// Reads a robot and walks it two seconds in each engine: what is doubtful, what is wrong, and where it does
/// not walk. A file that cannot be read is a finding, too.
LintedRobot lint_robot(const std::string& file, const std::vector<std::string>& engines);

/// Findings that are known: file, of and what, numbers left out, for these differ in the last digit.
using LintBaseline = std::set<std::string>;

/// Takes the findings of an earlier run, in JSON. @throws ConfigError naming the file if it is no such
LintBaseline read_baseline(const std::string& file);

struct LintReport {
  std::vector<LintedRobot> robots;
  LintBaseline known;

  bool is_known(const LintedRobot& robot, const RobotFinding& finding) const;
  /// Counts findings of this severity or worse that are not known.
  std::size_t count_new(Severity least) const;
  /// Writes findings as lines; JSON; SARIF 2.1.0 (OASIS), known findings `unchanged`; or JUnit's XML, where a
  /// robot is a suite and a finding that is an error and not known a failure.
  std::string text(LintFormat format) const;
};

}  // namespace crossgait
