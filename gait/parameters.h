// The numbers that shape a gait, and the one table that names them. SI units.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "physics/robot/leg.h"

namespace crossgait {

/// Says which path a swinging foot takes; see foot_trajectory.h.
enum class SwingCurve {
  kBezier,   ///< the guide's: apex at 3/4 of step_height + foot_clearance, lands moving forward
  kMatched,  ///< apex at step_height + foot_clearance, lifts off and lands at ground speed
};

/// Names a curve: "bezier", "matched".
std::string_view name(SwingCurve curve) noexcept;

/// Holds parameters of a gait. The initialisers are the defaults, the only ones there are: those of the trot.
struct GaitParameters {
  double step_height = 0.04;   ///< lift of a swinging foot, m; adds to foot_clearance
  double step_length = 0.04;   ///< way of the body over a foot's stance, m: ground speed = step_length /
                               ///< (duty_factor cycle_time)
  double cycle_time = 0.24;    ///< s
  double body_height = 0.062;  ///< depth of a standing foot's centre below the shoulders, m
  double stance_width =
      0;  ///< each foot stands half of it outward from its own leg's plane, m; see foot_spacing
  double foot_clearance = 0;     ///< additional lift, m
  double swing_shape = 0.3;      ///< place of the inner control points of the Bezier swing, -
  double lateral_offset_fl = 0;  ///< further outward shift of a single foot, m
  double lateral_offset_fr = 0;
  double lateral_offset_rl = 0;
  double lateral_offset_rr = 0;
  double duty_factor = 0.6;  ///< share of the cycle that every foot stands, -
  /// Share of the load on the standing legs that their servos are to make up for
  /// (motion/servo_compensation.h),
  /// -. It moves no target: what a gait needs of its servos is as much its own as its steps are.
  double load_share = 1;
  double stance_offset = 0;  ///< forward shift of every foot, m: brings them under the centre of mass
  SwingCurve swing = SwingCurve::kBezier;
};

/// Returns the guide's GaitParameters (body_height 0.07, step_length 0.05, step_height 0.015, ...).
constexpr GaitParameters guide_parameters() {
  return {.step_height = 0.015,
          .step_length = 0.05,
          .cycle_time = 0.8,
          .body_height = 0.07,
          .stance_width = 0.08,
          .foot_clearance = 0.01,
          .swing_shape = 0.35,
          .duty_factor = 0.5,
          .load_share = 0.35};
}

/// Returns the guide's adaptive controller's parameters (body_height 0.05, step_length 0.06, ...).
constexpr GaitParameters guide_adaptive_parameters() {
  GaitParameters p = guide_parameters();
  p.step_height = 0.04;
  p.step_length = 0.06;
  p.body_height = 0.05;
  return p;
}

/// Describes one tunable parameter. Adaptation, normalisation, action and observation layouts, traces and
/// plots follow from its row; `--set` goes by its name and takes every valid value (`is_valid`).
struct ParameterRow {
  std::string_view name, unit, help;
  double GaitParameters::*member;
  double min, max;     ///< range for tuning and adaptation
  double delta_scale;  ///< change per adaptation step at full action

  /// Returns the factor of a value for a robot `length_scale` times as high, by its unit: lengths by as much,
  /// times and speeds by its root (`kUnits`, parameters.cpp). @throws std::logic_error for an unknown unit
  double factor(double length_scale) const;
  constexpr double default_value() const { return GaitParameters{}.*member; }
  constexpr double clip(double value) const { return value < min ? min : value > max ? max : value; }
  /// Returns `value` + `delta`, clipped to the range. A value outside it stays where it is or comes nearer:
  /// only deltas move it.
  constexpr double moved(double value, double delta) const {
    const double low = value < min ? value : min, high = value > max ? value : max, sum = value + delta;
    return sum < low ? low : sum > high ? high : sum;
  }
  /// Maps [min, max] to [-1, 1].
  constexpr double normalise(double value) const { return 2 * ((value - min) / (max - min)) - 1; }
};

/// Returns the table. Its order is that of action and observation vectors.
std::span<const ParameterRow> gait_parameters();

/// @throws ConfigError listing the known names
const ParameterRow& find_parameter(std::string_view name);

/// Takes the place of the table's ranges and delta scales where parameters adapt or are tuned. What is not
/// mentioned is the table's.
struct AdaptationRanges {
  struct Interval {
    double min = 0, max = 0;

    bool operator==(const Interval&) const = default;
  };
  std::map<std::string, Interval> ranges;      ///< by parameter
  std::map<std::string, double> delta_scales;  ///< by parameter
  double length_scale = 1;                     ///< the table's are multiplied by their rows' `factor` of it

  bool operator==(const AdaptationRanges&) const = default;
  /// Returns the table's row with what is replaced. @throws ConfigError listing the known names
  ParameterRow row(std::string_view name) const;
  /// @throws ConfigError naming `source` and "ranges.<name>" or "delta_scales.<name>" for an unknown name, a
  /// range that is empty or reaches beyond the valid values, or a scale outside (0, max - min]
  void validate(std::string_view source) const;
};

/// Returns the guide's ranges and delta scales of its six parameters.
AdaptationRanges guide_ranges();

/// Returns a sentence for every parameter that is neither within its range nor as `usual` has it, and one
/// where a swing is not lifted as asked (`swing_lift`).
std::vector<std::string> parameter_notes(const GaitParameters& parameters, const GaitParameters& usual,
                                         const AdaptationRanges& ranges = {});

/// Sets one parameter by name. @throws ConfigError for an unknown name or a value that is not valid
/// (`is_valid`)
void set(GaitParameters& parameters, std::string_view name, double value);

/// Sets one parameter from text "name=value", including "swing=bezier" and "swing=matched".
/// @throws ConfigError as `set`, and for text that is no such assignment
void assign(GaitParameters& parameters, std::string_view text);

/// Holds some of a gait's parameters, by name; the others are left to whoever knows the gait and the robot.
struct GaitSettings {
  struct Value {
    std::string name;
    double value = 0;

    bool operator==(const Value&) const = default;
  };
  std::vector<Value> values;  ///< each name once
  std::optional<SwingCurve> swing;

  /// Returns settings of every parameter.
  static GaitSettings all(const GaitParameters& parameters);
  /// Returns a value by name, added with 0 if it is not there.
  double& operator[](std::string_view name);
  std::optional<double> find(std::string_view name) const;
  GaitParameters over(GaitParameters parameters) const;
  bool operator==(const GaitSettings&) const = default;
};

/// Sets a parameter as above.
void set(GaitSettings& settings, std::string_view name, double value);
void assign(GaitSettings& settings, std::string_view text);
/// @throws ConfigError (naming `source` and the parameter) for an unknown name or a value that is not valid
void validate(const GaitSettings& settings, std::string_view source);

/// Moves every parameter of the table into its range.
GaitParameters clip(const GaitParameters& parameters) noexcept;

/// Tells whether the formulas hold: finite, lengths and heights not negative, body_height positive,
/// cycle_time at least 0.05 s, duty_factor 0.05 to 0.95, load_share 0 to 2. Wider than the table's ranges.
bool is_valid(const GaitParameters& parameters) noexcept;

/// @throws ConfigError (naming `source` and the parameter) unless `is_valid`
void validate(const GaitParameters& parameters, std::string_view source);

}  // namespace crossgait
