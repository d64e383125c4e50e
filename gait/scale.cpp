#include "gait/scale.h"

#include <cmath>

namespace crossgait {

GaitScale gait_scale(const RobotDescription& robot) noexcept {
  GaitScale scale;
  if (robot.standing_height > 0) scale.length = robot.standing_height / kReferenceHeight;
  scale.stance_offset = robot.stance_offset;
  if (robot.legs) scale.linkage = (*robot.legs)[Leg::FL].linkage;
  return scale;
}

GaitParameters scaled(const GaitParameters& parameters, const GaitScale& scale) noexcept {
  GaitParameters result = parameters;
  for (const ParameterRow& row : gait_parameters()) result.*row.member *= row.factor(scale.length);
  return result;
}

Gait scaled(const Gait& gait, const GaitScale& scale) noexcept {
  Gait result = gait;
  if (scale.linkage != LegLinkage::kFiveBar && gait.preferred_serial)
    result.preferred = *gait.preferred_serial;
  result.preferred = scaled(result.preferred, scale);
  result.preferred.stance_offset += scale.stance_offset;
  result.preferred_serial.reset();
  return result;
}

StepLimits scaled(const StepLimits& limits, const GaitScale& scale) noexcept {
  return {scale.length * limits.max_x, scale.length * limits.max_y};
}

MultiGaitOptions scaled(MultiGaitOptions options, const GaitScale& scale) {
  for (SpeedBand& band : options.bands) {
    band.gait = scaled(band.gait, scale);
    band.below *= scale.time();
  }
  options.hysteresis *= scale.time();
  options.longest_step *= scale.length;
  options.shortest_cycle *= scale.time();
  options.limits = scaled(options.limits, scale);
  return options;
}

AdaptationRanges scaled(AdaptationRanges ranges, const GaitScale& scale) {
  ranges.length_scale = scale.length;
  return ranges;
}

}  // namespace crossgait
