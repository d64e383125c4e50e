#include "gait/multi_gait_controller.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "physics/core/error.h"

namespace crossgait {
namespace {

const MultiGaitOptions& validated(const MultiGaitOptions& options) {
  constexpr std::string_view kSource = "multi-gait options";
  if (options.bands.empty()) throw ConfigError(kSource, "bands", "at least one", "none");
  for (std::size_t i = 0; i < options.bands.size(); ++i) {
    validate(options.bands[i].gait);
    const bool last = i + 1 == options.bands.size();
    const double from = i == 0 ? 0 : options.bands[i - 1].below;
    if (!last && !(options.bands[i].below > from)) {
      throw ConfigError(kSource, fmt::format("band of {}", options.bands[i].gait.name),
                        fmt::format("an end above {:g} m/s", from),
                        fmt::format("{:g} m/s", options.bands[i].below));
    }
  }
  if (!(options.hysteresis >= 0 && std::isfinite(options.hysteresis))) {
    throw ConfigError(kSource, "hysteresis", "0 m/s or more", fmt::format("{:g}", options.hysteresis));
  }
  validate(options.limits, kSource);
  if (!(options.longest_step > 0 && options.longest_step <= options.limits.max_x)) {
    throw ConfigError(kSource, "longest_step", fmt::format("above 0, at most {:g} m", options.limits.max_x),
                      fmt::format("{:g}", options.longest_step));
  }
  constexpr double kShortest = 0.05;
  if (!(options.shortest_cycle >= kShortest && std::isfinite(options.shortest_cycle))) {
    throw ConfigError(kSource, "shortest_cycle", fmt::format("{} s or more", kShortest),
                      fmt::format("{:g}", options.shortest_cycle));
  }
  if (options.parameters) validate(*options.parameters, kSource);
  return options;
}

bool same(const Gait& a, const Gait& b) { return a.name == b.name && a.offset == b.offset; }

}  // namespace

std::vector<SpeedBand> default_speed_bands() { return {{find_gait("walk"), 0.08}, {find_gait("trot"), 0}}; }

std::vector<SpeedBand> guide_speed_bands() {
  return {{find_gait("walk:guide"), 0.1}, {find_gait("trot:guide"), 0.3}, {find_gait("gallop:guide"), 0}};
}

MultiGaitOptions guide_multi_gait_options() {
  MultiGaitOptions options;
  options.bands = guide_speed_bands();
  options.longest_step = 0.10;
  options.shortest_cycle = 0.4;
  return options;
}

MultiGaitController::MultiGaitController(const MultiGaitOptions& options, const LegArray<Vector3>& p_BL)
    : options_(validated(options)),
      p_BL_(p_BL),
      generator_(options.bands.front().gait, options.bands.front().gait.preferred, p_BL, options.limits) {
  reset();
}

void MultiGaitController::reset() noexcept {
  forced_.reset();
  command_ = {};
  band_ = 0;
  static_cast<void>(generator_.set_command(command_));  // zero is finite
  generator_.set_gait(options_.bands[0].gait);
  choose();
  generator_.reset(GaitGenerator::Start::kStanding);
}

bool MultiGaitController::set_command(const VelocityCommand& command) noexcept {
  if (!generator_.set_command(command)) return false;
  command_ = command;
  choose();
  return true;
}

bool MultiGaitController::set_parameters(const GaitParameters& parameters) noexcept {
  if (!is_valid(parameters)) return false;
  options_.parameters = parameters;
  choose();
  return true;
}

void MultiGaitController::force_gait(const Gait& gait) noexcept {
  forced_ = gait;
  choose();
}

void MultiGaitController::choose_gait_by_speed() noexcept {
  forced_.reset();
  choose();
}

void MultiGaitController::choose() noexcept {
  const LegArray<Vector2> velocity = foot_velocities_asked();
  double fastest = 0;
  for (const Vector2& v : velocity) fastest = std::max(fastest, v.norm());
  band_ = band_for(fastest);
  const Gait& gait = forced_ ? *forced_ : options_.bands[band_].gait;
  if (!same(gait, generator_.gait())) generator_.set_gait(gait);
  GaitParameters parameters = options_.parameters.value_or(gait.preferred);
  parameters.cycle_time = cycle_time(gait, velocity);
  parameters.duty_factor = gait.preferred.duty_factor;
  static_cast<void>(generator_.set_parameters(parameters));  // valid: checked where they came in
}

std::size_t MultiGaitController::band_for(double speed) const noexcept {
  const std::vector<SpeedBand>& bands = options_.bands;
  std::size_t band = 0;
  while (band + 1 < bands.size() && speed >= bands[band].below) ++band;
  // Slower than now: only once it is slower by the hysteresis.
  while (band < band_ && speed >= bands[band].below - options_.hysteresis) ++band;
  return band;
}

LegArray<Vector2> MultiGaitController::foot_velocities_asked() const noexcept {
  LegArray<Vector2> feet;
  for (const Leg leg : kLegs) {
    feet[leg] = {p_BL_[leg].x() + generator_.parameters().stance_offset,
                 p_BL_[leg].y() + side_sign(leg) * outward_shift(generator_.parameters(), leg)};
  }
  return foot_velocities(command_, feet);
}

/// The gait's own cycle time, or shorter by as much as its steps would be longer than `longest_step`.
double MultiGaitController::cycle_time(const Gait& gait, const LegArray<Vector2>& velocity) const noexcept {
  const double preferred = gait.preferred.cycle_time;
  // A hair more than needed, so that what fits is not reported as limited by a rounding error.
  constexpr double kHair = 1 - 1e-12;
  const StepLimits comfortable{options_.longest_step,
                               options_.limits.max_y * options_.longest_step / options_.limits.max_x};
  const double fits = plan_steps(velocity, gait.preferred.duty_factor * preferred, comfortable).limit_factor;
  if (fits == 1) return preferred;
  return std::min(preferred, std::max(options_.shortest_cycle, kHair * fits * preferred));
}

}  // namespace crossgait
