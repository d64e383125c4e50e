#include "apps/leg_option.h"

#include <fmt/format.h>

#include "physics/core/error.h"

namespace crossgait::apps {

void LegOption::add_to(CLI::App& command) {
  command.add_option("--leg", leg, "FL, FR, RL or RR")->capture_default_str();
  command.add_option(
      "--mode", mode,
      "Working mode of a five-bar: 1 knees inward, 2 outward, 3 both forward, 4 both backward; "
      "default: as in the home pose");
  command.add_option("--knee", knee,
                     "Knee of a serial leg: forward or backward; default: as in the home pose");
}

Leg LegOption::which() const {
  const auto known = leg_from_name(leg);
  if (!known) throw ConfigError("command line", "--leg", "FL, FR, RL or RR", "\"" + leg + "\"");
  return *known;
}

LegBranch LegOption::branch(const LegKinematics& kinematics) const {
  LegBranch branch = kinematics.home_branch();
  const bool five_bar = kinematics.kind() == LegKind::kFiveBar;
  if (mode != 0) {
    const auto known = working_mode(mode);
    if (!known)
      throw ConfigError("command line", "--mode", "a working mode from 1 to 4", std::to_string(mode));
    if (!five_bar)
      throw ConfigError("command line", "--mode", "a five-bar leg; --knee is for serial ones", leg);
    branch.mode = *known;
  }
  if (!knee.empty()) {
    if (knee != "forward" && knee != "backward")
      throw ConfigError("command line", "--knee", "forward or backward", "\"" + knee + "\"");
    if (five_bar) throw ConfigError("command line", "--knee", "a serial leg; --mode is for five-bars", leg);
    branch.knee = knee == "forward" ? KneeBranch::kForward : KneeBranch::kBackward;
  }
  return branch;
}

std::string branch_text(const LegKinematics& kinematics, LegBranch branch) {
  if (kinematics.kind() == LegKind::kFiveBar) return fmt::format("mode {}", static_cast<int>(branch.mode));
  return branch.knee == KneeBranch::kForward ? "knee forward" : "knee backward";
}

}  // namespace crossgait::apps
