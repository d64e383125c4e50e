#include "gait/gait.h"

#include <cmath>

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/core/find_row.h"

namespace crossgait {
namespace {

// Legs are in the order FL, FR, RL, RR.
constexpr LegArray<double> kAtOnce{{0, 0, 0, 0}}, kDiagonals{{0, 0.5, 0.5, 0}},
    kLateral{{0.25, 0.75, 0, 0.5}}, kSides{{0, 0.5, 0, 0.5}}, kEnds{{0, 0, 0.5, 0.5}};

// The guide's numbers, but for lower swings: with a longer lift the body sags and the others drag.
constexpr GaitParameters guide(double duty_factor, double cycle_time) {
  GaitParameters p = guide_adaptive_parameters();
  p.step_height = 0.03;
  p.foot_clearance = 0;
  p.duty_factor = duty_factor;
  p.cycle_time = cycle_time;
  return p;
}

// What stiff serial legs walk with, at the table's size (docs/gaits-measured.md): swings of 0.28 h, for they
// do not sag like soft five-bars, a load share above 1, for what gives way beside the servos is the ground,
// and cycles of 2.45 sqrt(h / g). The trot sets its feet down with less speed forward (swing_shape) than the
// others: hard contact takes what speed a landing foot has (docs/gaits-measured.md).
constexpr GaitParameters serial(double cycle_time, double duty_factor, double step_length,
                                double swing_shape = 0.6) {
  return {.step_height = 0.0174,
          .step_length = step_length,
          .cycle_time = cycle_time,
          .swing_shape = swing_shape,
          .duty_factor = duty_factor,
          .load_share = 1.2};
}
constexpr GaitParameters kSerialTrot = serial(0.195, 0.6, 0.028, 0.85),
                         kSerialWalk = serial(0.465, 0.85, 0.03), kSerialInPairs = serial(0.14, 0.75, 0.022);

using Phases = std::array<GaitPhase, kMaxGaitPhases>;
constexpr Phases kTrotPhases{{{"pair_a_swing", 0}, {"pair_b_swing", 0.5}}};
constexpr Phases kWalkPhases{{{"rl_swing", 0}, {"fl_swing", 0.25}, {"rr_swing", 0.5}, {"fr_swing", 0.75}}};
constexpr Phases kEndPhases{
    {{"front_swing", 0}, {"front_stance", 0.25}, {"rear_swing", 0.5}, {"rear_stance", 0.75}}};

// Preferred parameters were searched for on scara_quadruped (docs/gaits-measured.md). Where both
// legs of an end or a side swing together nothing but speed keeps the body from tipping over them: those
// gaits swing for a twentieth of a second. The bound's feet stand forward for the speed that it loses in hard
// contact, and so for its own speed alone.
constexpr std::array kGaits{
    Gait{.name = "trot",
         .summary = "diagonal pairs in turn",
         .offset = kDiagonals,
         .preferred = {},
         .preferred_serial = kSerialTrot,
         .phases = kTrotPhases},
    Gait{.name = "walk",
         .summary = "one leg at a time in lateral sequence: RL, FL, RR, FR",
         .offset = kLateral,
         .preferred = {.step_height = 0.045,
                       .cycle_time = 0.6,
                       .body_height = 0.065,
                       .swing_shape = 0.1,
                       .duty_factor = 0.85,
                       .load_share = 1,
                       .swing = SwingCurve::kMatched},
         .preferred_serial = kSerialWalk,
         .phases = kWalkPhases},
    Gait{
        .name = "pace",
        .summary = "the legs of one side, all four, the other side's, all four",
        .offset = kSides,
        .preferred = {.step_height = 0.05,
                      .cycle_time = 0.2,
                      .body_height = 0.065,
                      .swing_shape = 0.8,
                      .duty_factor = 0.75,
                      .load_share = 1.2},
        .preferred_serial = kSerialInPairs,
        .phases = {{{"left_swing", 0}, {"left_stance", 0.25}, {"right_swing", 0.5}, {"right_stance", 0.75}}}},
    Gait{.name = "bound",
         .summary = "front legs, all four, rear legs, all four",
         .offset = kEnds,
         .preferred = {.step_height = 0.047,
                       .step_length = 0.05,
                       .cycle_time = 0.2,
                       .body_height = 0.065,
                       .swing_shape = 0.85,
                       .duty_factor = 0.75,
                       .load_share = 0.9,
                       .stance_offset = 0.007},
         .preferred_serial = kSerialInPairs,
         .phases = kEndPhases},
    Gait{.name = "pronk",
         .summary = "all legs at once",
         .offset = kAtOnce,
         .preferred = {.step_height = 0.05,
                       .step_length = 0.03,
                       .cycle_time = 0.2,
                       .body_height = 0.065,
                       .swing_shape = 0.5,
                       .duty_factor = 0.75,
                       .load_share = 1},
         .preferred_serial = kSerialInPairs,
         .phases = {{{"flight", 0}, {"stance", 0.25}}}},
    Gait{.name = "gallop",
         .summary = "as bound, in longer steps",
         .offset = kEnds,
         .preferred = {.step_height = 0.05,
                       .step_length = 0.06,
                       .cycle_time = 0.2,
                       .body_height = 0.065,
                       .stance_width = 0.04,
                       .swing_shape = 0.9,
                       .duty_factor = 0.75,
                       .load_share = 1},
         .preferred_serial = kSerialInPairs,
         .phases = kEndPhases},
    Gait{.name = "trot:guide",
         .summary = "the guide's trot",
         .offset = kDiagonals,
         .preferred = guide(0.5, 0.8),
         .phases = kTrotPhases},
    Gait{.name = "walk:guide",
         .summary = "a walk with the guide's numbers",
         .offset = kLateral,
         .preferred = guide(0.75, 1.2),
         .phases = kWalkPhases},
    // Its four states of a quarter cycle each; the stance is one sweep over the three quarters between
    // swings.
    Gait{.name = "gallop:guide",
         .summary = "the guide's gallop",
         .offset = kEnds,
         .preferred = guide(0.75, 0.6),
         .phases = kEndPhases},
};

}  // namespace

std::span<const Gait> gaits() { return kGaits; }

const Gait& find_gait(std::string_view name) { return find_row(kGaits, name, "gait", "name"); }

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
  for (const Leg leg : kLegs) {
    if (!(gait.offset[leg] >= 0 && gait.offset[leg] < 1)) {
      throw ConfigError(source, fmt::format("offset of {}", name(leg)), "a phase in [0, 1)",
                        fmt::format("{:g}", gait.offset[leg]));
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
  if (gait.preferred_serial) validate(*gait.preferred_serial, source);
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
