#include "gait/adaptive_gait_controller.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "physics/core/error.h"

namespace crossgait {
namespace {

constexpr std::string_view kController = "adaptive gait options";

std::vector<ParameterRow> resolve(const AdaptiveGaitOptions& options) {
  options.ranges.validate(kController);
  std::vector<ParameterRow> rows;
  for (const std::string& name : options.parameters) {
    const ParameterRow row = options.ranges.row(name);
    const auto same = [&](const ParameterRow& other) { return other.name == row.name; };
    if (std::any_of(rows.begin(), rows.end(), same)) {
      throw ConfigError(kController, "parameters", "every name once", fmt::format("{} twice", name));
    }
    rows.push_back(row);
  }
  return rows;
}

double validated_scale(double scale) {
  if (!(scale >= 0 && std::isfinite(scale))) {
    throw ConfigError(kController, "residual_scale", "a length of 0 m or more", fmt::format("{:g}", scale));
  }
  return scale;
}

double clip_to(double value, double most) {
  return std::isfinite(value) ? std::clamp(value, -most, most) : 0;
}

}  // namespace

AdaptiveGaitController::AdaptiveGaitController(const Gait& gait, const AdaptiveGaitOptions& options,
                                               const LegArray<Vector3>& p_BL)
    : adapted_(resolve(options)),
      initial_(options.initial),
      residual_scale_(validated_scale(options.residual_scale)),
      generator_(gait, options.initial, p_BL, options.limits) {
  reset();
}

void AdaptiveGaitController::reset(GaitGenerator::Start start) noexcept {
  static_cast<void>(generator_.set_parameters(initial_));  // valid: the generator was constructed with them
  generator_.reset(start);
  residuals_.fill(Vector3::Zero());
  add_residuals();
}

void AdaptiveGaitController::add_deltas(std::span<const double> deltas) noexcept {
  GaitParameters parameters = generator_.parameters();
  const std::size_t n = std::min(deltas.size(), adapted_.size());
  for (std::size_t i = 0; i < n; ++i) {
    const ParameterRow& row = adapted_[i];
    double& value = parameters.*row.member;
    if (std::isfinite(deltas[i])) value = row.moved(value, deltas[i]);
  }
  static_cast<void>(generator_.set_parameters(parameters));  // valid: between the ranges and the initial ones
}

void AdaptiveGaitController::set_residuals(const LegArray<Vector3>& residuals) noexcept {
  for (const Leg leg : kLegs) {
    for (int axis = 0; axis < 3; ++axis)
      residuals_[leg][axis] = clip_to(residuals[leg][axis], residual_scale_);
  }
}

void AdaptiveGaitController::apply_action(std::span<const double> action) noexcept {
  const auto at = [&](std::size_t i) { return i < action.size() ? clip_to(action[i], 1) : 0; };
  GaitParameters parameters = generator_.parameters();
  for (std::size_t i = 0; i < adapted_.size(); ++i) {
    const ParameterRow& row = adapted_[i];
    double& value = parameters.*row.member;
    value = row.moved(value, at(i) * row.delta_scale);
  }
  static_cast<void>(generator_.set_parameters(parameters));  // valid: between the ranges and the initial ones
  std::size_t next = adapted_.size();
  for (Vector3& residual : residuals_) {
    for (int axis = 0; axis < 3; ++axis) residual[axis] = at(next++) * residual_scale_;
  }
}

const LegArray<FootTarget>& AdaptiveGaitController::update(double dt) noexcept {
  generator_.update(dt);
  add_residuals();
  return targets_;
}

void AdaptiveGaitController::normalised_parameters(std::span<double> out) const noexcept {
  const std::size_t n = std::min(out.size(), adapted_.size());
  for (std::size_t i = 0; i < n; ++i) out[i] = adapted_[i].normalise(parameters().*adapted_[i].member);
}

void AdaptiveGaitController::add_residuals() noexcept {
  targets_ = generator_.targets();
  for (const Leg leg : kLegs) targets_[leg].position += residuals_[leg];
}

}  // namespace crossgait
