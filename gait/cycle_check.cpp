#include "gait/cycle_check.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "physics/core/error.h"

namespace crossgait {
namespace {

/// @param step  of every leg, m
CycleCheck count_unreachable(const Gait& gait, const GaitParameters& parameters, const Vector2& step,
                             const TargetCheck& check, int samples) {
  CycleCheck result;
  for (int i = 0; i < samples; ++i) {
    const double clock = static_cast<double>(i) / samples;
    for (const Leg leg : kLegs) {
      const FootStride stride{step, 1, parameters.swing};
      const LegPhase phase = leg_phase(clock, gait.offset[leg], parameters.duty_factor);
      const Vector3 target = foot_position(parameters, leg, phase, stride);
      ++result.targets;
      if (check(leg, target)) continue;
      ++result.unreachable;
      if (!result.first) result.first = {leg, clock, target};
    }
  }
  return result;
}

CycleCheck count_unreachable(const Gait& gait, const GaitParameters& parameters, const TargetCheck& check,
                             int samples) {
  return count_unreachable(gait, parameters, {parameters.step_length, 0}, check, samples);
}

std::vector<std::string_view> find_offending(const Gait& gait, GaitParameters parameters,
                                             const TargetCheck& check, int samples, int unreachable) {
  std::vector<std::string_view> offending;
  std::vector<const ParameterRow*> changed;
  for (const ParameterRow& row : gait_parameters()) {
    if (parameters.*row.member != gait.preferred.*row.member) changed.push_back(&row);
  }
  while (unreachable > 0 && !changed.empty()) {
    auto best = changed.begin();
    int fewest = -1;
    for (auto it = changed.begin(); it != changed.end(); ++it) {
      GaitParameters trial = parameters;
      trial.*(*it)->member = gait.preferred.*(*it)->member;
      const int left = count_unreachable(gait, trial, check, samples).unreachable;
      if (fewest < 0 || left < fewest) {
        fewest = left;
        best = it;
      }
    }
    parameters.*(*best)->member = gait.preferred.*(*best)->member;
    unreachable = fewest;
    offending.push_back((*best)->name);
    changed.erase(best);
  }
  return offending;
}

void validate_check(const Gait& gait, const GaitParameters& parameters, int samples) {
  validate(gait);
  validate(parameters, "gait parameters");
  constexpr int kLeast = 2;
  if (samples < kLeast) {
    throw ConfigError("cycle check", "samples", fmt::format("{} or more", kLeast),
                      fmt::format("{}", samples));
  }
}

/// Longest length for which `reachable` holds, given that it does at zero, to a tenth of a millimetre.
template <typename Reachable>
double longest(const Reachable& reachable) {
  constexpr double kResolution = 1e-4, kMost = 1;  // m
  double good = 0, bad = kResolution;
  while (bad < kMost && reachable(bad)) {
    good = bad;
    bad *= 2;
  }
  while (bad - good > kResolution) {
    const double middle = (good + bad) / 2;
    (reachable(middle) ? good : bad) = middle;
  }
  return good;
}

}  // namespace

CycleCheck check_cycle(const Gait& gait, const GaitParameters& parameters, const TargetCheck& check,
                       int samples) {
  validate_check(gait, parameters, samples);
  CycleCheck result = count_unreachable(gait, parameters, check, samples);
  result.offending = find_offending(gait, parameters, check, samples, result.unreachable);
  return result;
}

StepLimits reachable_steps(const Gait& gait, const GaitParameters& parameters, const TargetCheck& check,
                           int samples) {
  validate_check(gait, parameters, samples);
  const auto walk = [&](const Vector2& step) {
    return count_unreachable(gait, parameters, step, check, samples);
  };
  if (const CycleCheck on_the_spot = walk(Vector2::Zero()); !on_the_spot.ok()) {
    const CycleCheck::Failure& failure = *on_the_spot.first;
    throw ConfigError(fmt::format("gait '{}'", gait.name),
                      fmt::format("steps on the spot, leg {}", name(failure.leg)), "targets within reach",
                      fmt::format("({:g}, {:g}, {:g}) m at phase {:g}", failure.target.x(),
                                  failure.target.y(), failure.target.z(), failure.phase));
  }
  const auto both_ways = [&](const Vector2& step) { return walk(step).ok() && walk(-step).ok(); };
  StepLimits limits;
  limits.max_x = longest([&](double length) { return both_ways({length, 0}); });
  limits.max_y = longest([&](double length) { return both_ways({0, length}); });
  const auto all_directions = [&](double share) {
    constexpr int kHalf = 8;
    for (int i = 0; i < kHalf; ++i) {
      const double angle = M_PI * i / kHalf;
      if (!both_ways(share * Vector2(limits.max_x * std::cos(angle), limits.max_y * std::sin(angle))))
        return false;
    }
    return true;
  };
  constexpr double kShrink = 0.98, kLeastShare = 0.01;
  double share = 1;
  while (share > kLeastShare && !all_directions(share)) share *= kShrink;
  return {share * limits.max_x, share * limits.max_y};
}

}  // namespace crossgait
