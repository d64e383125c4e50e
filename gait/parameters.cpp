#include "gait/parameters.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "gait/foot_trajectory.h"
#include "physics/core/error.h"
#include "physics/core/find_row.h"

namespace crossgait {
namespace {

using P = GaitParameters;

// Ranges around what walks (docs/gaits-measured.md); the guide's are `guide_ranges`.
constexpr std::array kTable{
    ParameterRow{"step_height", "m", "lift of a swinging foot", &P::step_height, 0.015, 0.055, 0.004},
    ParameterRow{"step_length", "m", "way of the body over a foot's stance", &P::step_length, 0.0, 0.12,
                 0.008},
    ParameterRow{"cycle_time", "s", "duration of a gait cycle", &P::cycle_time, 0.15, 0.8, 0.04},
    ParameterRow{"body_height", "m", "depth of a standing foot below the shoulders", &P::body_height, 0.045,
                 0.07, 0.003},
    ParameterRow{"stance_width", "m", "twice the outward shift of every foot", &P::stance_width, -0.02, 0.1,
                 0.008},
    ParameterRow{"foot_clearance", "m", "additional lift of a swinging foot", &P::foot_clearance, 0.0, 0.02,
                 0.002},
    ParameterRow{"swing_shape", "-", "place of the Bezier swing's inner control points", &P::swing_shape,
                 0.05, 0.95, 0.05},
    ParameterRow{"lateral_offset_fl", "m", "further outward shift of the foot FL", &P::lateral_offset_fl,
                 -0.02, 0.02, 0.002},
    ParameterRow{"lateral_offset_fr", "m", "further outward shift of the foot FR", &P::lateral_offset_fr,
                 -0.02, 0.02, 0.002},
    ParameterRow{"lateral_offset_rl", "m", "further outward shift of the foot RL", &P::lateral_offset_rl,
                 -0.02, 0.02, 0.002},
    ParameterRow{"lateral_offset_rr", "m", "further outward shift of the foot RR", &P::lateral_offset_rr,
                 -0.02, 0.02, 0.002},
    ParameterRow{"duty_factor", "-", "share of the cycle that a foot stands", &P::duty_factor, 0.5, 0.9,
                 0.025},
    ParameterRow{"load_share", "-", "share of their load that standing legs' servos make up for",
                 &P::load_share, 0, 1.2, 0.08},
    ParameterRow{"stance_offset", "m", "forward shift of every foot", &P::stance_offset, -0.02, 0.02, 0.002},
};

/// How a quantity grows with a robot's length L, gravity being the same: times and speeds with sqrt(L).
enum class Scale { kNone, kLength, kRoot, kInverseRoot };
struct UnitRow {
  std::string_view unit;
  Scale scale;
};
constexpr std::array kUnits{UnitRow{"-", Scale::kNone},           UnitRow{"m", Scale::kLength},
                            UnitRow{"s", Scale::kRoot},           UnitRow{"m/s", Scale::kRoot},
                            UnitRow{"m/s^2", Scale::kNone},       UnitRow{"rad", Scale::kNone},
                            UnitRow{"rad/s", Scale::kInverseRoot}};

/// @throws std::logic_error for a unit that is not in the table; in a constant expression, does not compile
constexpr Scale scale_of(std::string_view unit) {
  for (const UnitRow& row : kUnits) {
    if (row.unit == unit) return row.scale;
  }
  throw std::logic_error(
      "a gait parameter's unit that says nothing of its scale: a row of kUnits is missing");
}
// A parameter whose unit is unknown does not compile, instead of being left unscaled on robots of another
// size.
static_assert(std::all_of(kTable.begin(), kTable.end(),
                          [](const ParameterRow& row) { return scale_of(row.unit) <= Scale::kInverseRoot; }));

constexpr std::string_view kSource = "gait parameters";
constexpr std::array kCurves{SwingCurve::kBezier, SwingCurve::kMatched};

/// Smallest value for which the formulas hold.
constexpr double valid_from(double P::*member) {
  constexpr double kShortestCycle = 0.05, kLowestBody = 1e-3, kUnbounded = -1e3, kLeastDuty = 0.05;
  if (member == &P::duty_factor) return kLeastDuty;
  if (member == &P::cycle_time) return kShortestCycle;
  if (member == &P::body_height) return kLowestBody;
  if (member == &P::step_height || member == &P::foot_clearance || member == &P::load_share) return 0;
  return kUnbounded;
}

constexpr double valid_to(double P::*member) {
  constexpr double kMostDuty = 0.95, kMostShare = 2, kMost = 1e3;  // m or s; also keeps infinities out
  if (member == &P::load_share) return kMostShare;
  return member == &P::duty_factor ? kMostDuty : kMost;
}

/// Of each row of the table: asked for at every change of a gait.
constexpr auto kValid = [] {
  std::array<std::pair<double, double>, kTable.size()> bounds{};
  for (std::size_t i = 0; i < kTable.size(); ++i)
    bounds[i] = {valid_from(kTable[i].member), valid_to(kTable[i].member)};
  return bounds;
}();

bool holds(const ParameterRow& row, double value) {
  return value >= valid_from(row.member) && value <= valid_to(row.member);
}

/// " m", " s"; nothing for what has no unit.
std::string unit_of(const ParameterRow& row) { return row.unit == "-" ? "" : fmt::format(" {}", row.unit); }

std::string valid_range(const ParameterRow& row) {
  return fmt::format("{:g} to {:g}{}", valid_from(row.member), valid_to(row.member), unit_of(row));
}

void require_valid(std::string_view source, const ParameterRow& row, double value) {
  if (holds(row, value)) return;
  throw ConfigError(source, row.name, valid_range(row), fmt::format("{:g}", value));
}

SwingCurve curve_from_name(std::string_view text) {
  for (const SwingCurve curve : kCurves) {
    if (name(curve) == text) return curve;
  }
  throw ConfigError(kSource, "swing", "bezier or matched", fmt::format("'{}'", text));
}

}  // namespace

std::string_view name(SwingCurve curve) noexcept {
  return curve == SwingCurve::kBezier ? "bezier" : "matched";
}

double ParameterRow::factor(double length_scale) const {
  switch (scale_of(unit)) {
    case Scale::kLength:
      return length_scale;
    case Scale::kRoot:
      return std::sqrt(length_scale);
    case Scale::kInverseRoot:
      return 1 / std::sqrt(length_scale);
    case Scale::kNone:
      break;
  }
  return 1;
}

AdaptationRanges guide_ranges() {
  return {.ranges = {{"step_height", {0.03, 0.09}},
                     {"step_length", {0.03, 0.10}},
                     {"cycle_time", {0.8, 1.5}},
                     {"body_height", {0.04, 0.055}},
                     {"stance_width", {0.06, 0.12}},
                     {"foot_clearance", {0, 0.02}}},
          .delta_scales = {{"step_height", 0.005},
                           {"step_length", 0.005},
                           {"cycle_time", 0.05},
                           {"body_height", 0.003},
                           {"stance_width", 0.004},
                           {"foot_clearance", 0.002}}};
}

std::span<const ParameterRow> gait_parameters() { return kTable; }

const ParameterRow& find_parameter(std::string_view name) { return find_row(kTable, name, kSource, "name"); }

void set(GaitParameters& parameters, std::string_view name, double value) {
  const ParameterRow& row = find_parameter(name);
  require_valid(kSource, row, value);
  parameters.*row.member = value;
}

GaitSettings GaitSettings::all(const GaitParameters& parameters) {
  GaitSettings settings{{}, parameters.swing};
  for (const ParameterRow& row : kTable) settings[row.name] = parameters.*row.member;
  return settings;
}

double& GaitSettings::operator[](std::string_view name) {
  for (Value& known : values) {
    if (known.name == name) return known.value;
  }
  return values.emplace_back(Value{std::string(name), 0}).value;
}

std::optional<double> GaitSettings::find(std::string_view name) const {
  for (const Value& known : values) {
    if (known.name == name) return known.value;
  }
  return std::nullopt;
}

GaitParameters GaitSettings::over(GaitParameters parameters) const {
  for (const auto& [name, value] : values) parameters.*find_parameter(name).member = value;
  if (swing) parameters.swing = *swing;
  return parameters;
}

void set(GaitSettings& settings, std::string_view name, double value) {
  require_valid(kSource, find_parameter(name), value);
  settings[name] = value;
}

void validate(const GaitSettings& settings, std::string_view source) {
  for (const auto& [name, value] : settings.values) require_valid(source, find_parameter(name), value);
}

void assign(GaitParameters& parameters, std::string_view text) {
  GaitSettings settings;
  assign(settings, text);
  parameters = settings.over(parameters);
}

void assign(GaitSettings& settings, std::string_view text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string_view::npos) {
    throw ConfigError(kSource, text, "name=value", "no '='");
  }
  const std::string_view name = text.substr(0, equals), value = text.substr(equals + 1);
  if (name == "swing") {
    settings.swing = curve_from_name(value);
    return;
  }
  double number = 0;
  const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
  if (error != std::errc() || end != value.data() + value.size()) {
    throw ConfigError(kSource, name, "a number", fmt::format("'{}'", value));
  }
  set(settings, name, number);
}

GaitParameters clip(const GaitParameters& parameters) noexcept {
  GaitParameters clipped = parameters;
  for (const ParameterRow& row : kTable) clipped.*row.member = row.clip(parameters.*row.member);
  return clipped;
}

bool is_valid(const GaitParameters& parameters) noexcept {
  for (std::size_t i = 0; i < kTable.size(); ++i) {
    const double value = parameters.*kTable[i].member;
    if (!(value >= kValid[i].first && value <= kValid[i].second)) return false;
  }
  return true;
}

void validate(const GaitParameters& parameters, std::string_view source) {
  for (const ParameterRow& row : kTable) {
    require_valid(source, row, parameters.*row.member);
  }
}

ParameterRow AdaptationRanges::row(std::string_view name) const {
  ParameterRow row = find_parameter(name);
  const double factor = row.factor(length_scale);
  row.min *= factor;
  row.max *= factor;
  row.delta_scale *= factor;
  if (const auto range = ranges.find(std::string(name)); range != ranges.end()) {
    row.min = range->second.min;
    row.max = range->second.max;
  }
  if (const auto scale = delta_scales.find(std::string(name)); scale != delta_scales.end()) {
    row.delta_scale = scale->second;
  }
  return row;
}

void AdaptationRanges::validate(std::string_view source) const {
  for (const auto& [name, range] : ranges) {
    const ParameterRow& row = find_parameter(name);
    if (!(holds(row, range.min) && holds(row, range.max) && range.min < range.max)) {
      throw ConfigError(source, fmt::format("ranges.{}", name),
                        fmt::format("[min, max], min < max, within {}", valid_range(row)),
                        fmt::format("[{:g}, {:g}]", range.min, range.max));
    }
  }
  for (const auto& [name, scale] : delta_scales) {
    const ParameterRow changed = row(name);
    if (!(scale > 0 && scale <= changed.max - changed.min)) {
      throw ConfigError(source, fmt::format("delta_scales.{}", name),
                        fmt::format("a number above 0, at most {:g}{}, the width of the range",
                                    changed.max - changed.min, unit_of(changed)),
                        fmt::format("{:g}", scale));
    }
  }
}

std::vector<std::string> parameter_notes(const GaitParameters& parameters, const GaitParameters& usual,
                                         const AdaptationRanges& ranges) {
  std::vector<std::string> notes;
  for (const ParameterRow& known : kTable) {
    const ParameterRow row = ranges.row(known.name);
    const double value = parameters.*row.member;
    if (value == usual.*row.member || (value >= row.min && value <= row.max)) continue;
    notes.push_back(fmt::format("{} = {:g}{} lies outside the range for adaptation, {:g} to {:g}{}", row.name,
                                value, unit_of(row), row.min, row.max, unit_of(row)));
  }
  const double asked = parameters.step_height + parameters.foot_clearance, lift = swing_lift(parameters);
  if (lift < asked) {
    notes.push_back(
        fmt::format("step_height and foot_clearance ask for a lift of {:g} m, to above the shoulders: "
                    "feet are lifted by {:.4g} m, just below body_height",
                    asked, lift));
  }
  return notes;
}

}  // namespace crossgait
