#include "crossgait/gait/gait.h"

#include <cmath>

#include <fmt/format.h>

#include "crossgait/physics/error.h"

namespace crossgait {
namespace {

// Legs are in the order FL, FR, RL, RR. Duty factors are the same for all legs of every gait here. Where both
// legs of an end or a side swing together nothing but speed keeps the body from tipping over them: those
// gaits swing for a tenth of a second or so (docs/gaits.md has what was measured).
constexpr LegArray<double> all(double value) { return {{value, value, value, value}}; }

constexpr std::array kGaits{
    Gait{.name = "trot",
         .summary = "diagonal pairs in turn",
         .offset = {{0, 0.5, 0.5, 0}},
         .duty = all(0.5),
         .phases = {{{"pair_a_swing", 0}, {"pair_b_swing", 0.5}}},
         .preferred = {.step_height = 0.03, .foot_clearance = 0}},
    Gait{.name = "walk",
         .summary = "one leg at a time in lateral sequence: RL, FL, RR, FR",
         .offset = {{0.25, 0.75, 0, 0.5}},
         .duty = all(0.75),
         .phases = {{{"rl_swing", 0}, {"fl_swing", 0.25}, {"rr_swing", 0.5}, {"fr_swing", 0.75}}},
         .preferred = {.step_height = 0.03, .cycle_time = 1.2, .foot_clearance = 0}},
    Gait{.name = "pace",
         .summary = "the legs of one side, all four, the other side's, all four",
         .offset = {{0, 0.5, 0, 0.5}},
         .duty = all(0.8),
         .phases = {{{"left_swing", 0}, {"left_stance", 0.2}, {"right_swing", 0.5}, {"right_stance", 0.7}}},
         .preferred = {.step_height = 0.03, .cycle_time = 0.4, .foot_clearance = 0}},
    Gait{.name = "bound",
         .summary = "as gallop with shorter swings",
         .offset = {{0, 0, 0.5, 0.5}},
         .duty = all(0.8),
         .phases = {{{"front_swing", 0}, {"front_stance", 0.2}, {"rear_swing", 0.5}, {"rear_stance", 0.7}}},
         .preferred = {.step_height = 0.03, .cycle_time = 0.4, .foot_clearance = 0}},
    Gait{.name = "pronk",
         .summary = "all legs at once",
         .offset = all(0),
         .duty = all(0.75),
         .phases = {{{"flight", 0}, {"stance", 0.25}}},
         .preferred = {.step_height = 0.03, .cycle_time = 0.4, .foot_clearance = 0}},
    // The guide's four states of a quarter cycle each; its stance is one sweep over the three quarters
    // between swings.
    Gait{.name = "gallop",
         .summary = "front legs, all four, rear legs, all four",
         .offset = {{0, 0, 0.5, 0.5}},
         .duty = all(0.75),
         .phases = {{{"front_swing", 0}, {"front_stance", 0.25}, {"rear_swing", 0.5}, {"rear_stance", 0.75}}},
         .preferred = {.step_height = 0.03, .cycle_time = 0.6, .foot_clearance = 0}},
};

}  // namespace

std::span<const Gait> gaits() { return kGaits; }

const Gait& find_gait(std::string_view name) {
  for (const Gait& gait : kGaits) {
    if (gait.name == name) return gait;
  }
  std::string known;
  for (const Gait& gait : kGaits) known += fmt::format("{}{}", known.empty() ? "" : ", ", gait.name);
  throw ConfigError("gait", name, "one of " + known, "an unknown name");
}

std::string_view phase_name(const Gait& gait, double phase) noexcept {
  std::string_view current;
  for (const GaitPhase& part : gait.phases) {
    if (part.name.empty() || part.start > phase) break;
    current = part.name;
  }
  return current;
}

void validate(const Gait& gait) {
  const std::string source = fmt::format("gait '{}'", gait.name);
  constexpr double kLeastDuty = 0.05, kMostDuty = 0.95;
  for (const Leg leg : kLegs) {
    if (!(gait.offset[leg] >= 0 && gait.offset[leg] < 1)) {
      throw ConfigError(source, fmt::format("offset of {}", name(leg)), "a phase in [0, 1)",
                        fmt::format("{:g}", gait.offset[leg]));
    }
    if (!(gait.duty[leg] >= kLeastDuty && gait.duty[leg] <= kMostDuty)) {
      throw ConfigError(source, fmt::format("duty of {}", name(leg)),
                        fmt::format("{} to {}", kLeastDuty, kMostDuty), fmt::format("{:g}", gait.duty[leg]));
    }
  }
  if (gait.phases[0].name.empty() || gait.phases[0].start != 0) {
    throw ConfigError(source, "phases", "a first phase, named, that starts at 0",
                      fmt::format("'{}' at {:g}", gait.phases[0].name, gait.phases[0].start));
  }
  for (std::size_t i = 1; i < gait.phases.size() && !gait.phases[i].name.empty(); ++i) {
    if (!(gait.phases[i].start > gait.phases[i - 1].start && gait.phases[i].start < 1)) {
      throw ConfigError(source, fmt::format("phase '{}'", gait.phases[i].name),
                        "a start after the previous, below 1", fmt::format("{:g}", gait.phases[i].start));
    }
  }
  validate(gait.preferred, source);
}

LegPhase leg_phase(double clock, double offset, double duty) noexcept {
  double phase = clock - offset;
  phase -= std::floor(phase);
  if (phase >= 1) phase = 0;  // a tiny negative difference rounds up to one
  const double swing = 1 - duty;
  if (phase < swing) return {phase, true, phase / swing};
  return {phase, false, (phase - swing) / duty};
}

}  // namespace crossgait
