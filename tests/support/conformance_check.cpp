#include "tests/support/conformance_check.h"

#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/support/engine_test.h"

namespace crossgait::conformance {

const Check& check_of(const std::string& name) {
  for (const Check& check : checks())
    if (check.name == name) return check;
  throw std::logic_error("no check " + name);
}

std::vector<std::string> names_of_checks() {
  std::vector<std::string> names;
  for (const Check& check : checks()) names.push_back(check.name);
  return names;
}

void expect_holds(const std::string& name, const std::string& engine) {
  const Check& check = check_of(name);
  const Subject subject = subject_of(engine);
  const Outcome outcome = run_check(check, subject);
  if (outcome.status == Status::kSkipped) GTEST_SKIP() << "needs: " << outcome.reason;
  EXPECT_EQ(outcome.reason, "");
  for (std::size_t i = 0; i < outcome.values.size(); ++i) {
    const Requirement& requirement = check.requirements[i];
    measured(check.name + ": " + requirement.what + (requirement.unit.empty() ? "" : ", " + requirement.unit),
             outcome.values[i]);
    EXPECT_TRUE(requirement.holds(outcome.values[i], subject.precision()))
        << requirement.what << ": " << requirement.bound(subject.precision());
  }
  EXPECT_EQ(outcome.status, Status::kPassed);
}

}  // namespace crossgait::conformance
