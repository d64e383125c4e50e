// Closed loops: they stay closed, under load and in motion, and give way as RobotDescription::loop_softness
// says.
#include <algorithm>
#include <cmath>

#include "conformance/topics.h"

namespace crossgait::conformance {
namespace {

std::vector<double> loops_closed(const Subject& subject) {
  const auto world = subject.make(scenes::quadruped());
  const scenes::Trot trot(world->robot());
  double walking = 0, standing = 0;
  while (world->state().time < scenes::Trot::kStand + 3) {
    advance(*world, trot.targets(world->state().time));
    walking = std::max(walking, loop_gap(*world));
  }
  // In the air, where nothing loads them: let go with the loops open, they close.
  WorldSpec spec = scenes::world_of(scenes::quadruped());
  spec.fixed_base = true;
  const auto hanging = subject.make(spec);
  RobotState start = hanging->home_state();
  start.p_WB.z() += 0.5;
  start.q.array() += 0.02;
  hanging->reset(start);
  const double open = loop_gap(*hanging);
  advance(*hanging, scenes::home_targets(hanging->robot()), 500);
  standing = loop_gap(*hanging);
  return {walking, open, standing};
}

/// Largest gap of a robot that stands, its loops at a time constant of so many s.
double standing_gap(const Subject& subject, double time_constant) {
  RobotDescription robot = *scenes::quadruped();
  robot.loop_softness.time_constant = time_constant;
  const auto world = subject.make(std::make_shared<const RobotDescription>(robot));
  advance(*world, scenes::home_targets(robot), 1500);
  return loop_gap(*world);
}

std::vector<double> loop_softness(const Subject& subject) {
  const double stiff = standing_gap(subject, 0.005), soft = standing_gap(subject, 0.01);
  return {stiff, soft / stiff};
}

}  // namespace

std::vector<Check> loop_checks() {
  return {
      {"loops_closed",
       "Loops stay closed in a trot, and close when they are let go open",
       {at_most(1e-3, "largest gap in a trot", "m", "five times what MuJoCo's law comes to"),
        at_least(1e-4, "let go open by", "m", "something is there to be closed"),
        at_most(1e-5, "left of it after 0.5 s in the air", "m",
                "twenty times what the weight of the links keeps open")},
       loops_closed},
      {"loop_softness",
       "Loops give way as loop_softness says, in MuJoCo's terms",
       {at_least(1e-7, "gap of a standing robot", "m", "soft: a rigid loop has none"),
        between(
            3.3, 3.5, "the gap at twice the time constant, over it", "",
            "3.39 by R f = K imp r: a quarter of the stiffness, and an impedance that grows with the gap")},
       loop_softness,
       {"Laws::loops is \"mujoco\"",
        [](const Subject& subject) { return subject.engine.info.laws.loops.starts_with("mujoco"); }}},
  };
}

}  // namespace crossgait::conformance
