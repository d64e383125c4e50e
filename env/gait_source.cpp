#include "crossgait/env/gait_source.h"

#include <memory>

namespace crossgait {

GaitChoice choose_gait(const std::string& gait, const std::vector<std::string>& settings) {
  GaitChoice choice{find_gait(gait), {}};
  choice.parameters = choice.gait.preferred;
  for (const std::string& setting : settings) assign(choice.parameters, setting);
  return choice;
}

LegArray<Vector3> leg_origins(const RobotDescription& robot) {
  LegArray<Vector3> p_BL;
  for (const Leg leg : kLegs) p_BL[leg] = five_bar_geometry(robot, leg).p_BL;
  return p_BL;
}

FootTargetSource make_gait_source(const GaitChoice& choice, const RobotDescription& robot) {
  const auto generator = std::make_shared<GaitGenerator>(choice.gait, choice.parameters, leg_origins(robot));
  generator->reset(GaitGenerator::Start::kStanding);
  return [generator](double dt) {
    const LegArray<FootTarget>& targets = generator->update(dt);
    LegArray<Vector3> feet;
    for (const Leg leg : kLegs) feet[leg] = targets[leg].position;
    return feet;
  };
}

}  // namespace crossgait
