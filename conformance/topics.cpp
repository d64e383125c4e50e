#include "conformance/topics.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "conformance/contact_forces.h"
#include "physics/engine/lost_engine.h"
#include "physics/robot/multibody.h"

namespace crossgait::conformance {

void advance(PhysicsBackend& world, const JointTargets& targets, int steps) {
  if (world.step(targets, steps) == StepStatus::kOk) return;
  throw_if_lost(world);
  throw std::runtime_error(fmt::format("{} diverged after {:.4g} s", world.robot().name, world.state().time));
}

std::unique_ptr<PhysicsBackend> swinging_arm(const Subject& subject, const scenes::ArmLink& link,
                                             const Vector3& gravity, double angle, double speed) {
  WorldSpec spec = scenes::world_of(scenes::arm({link}));
  spec.fixed_base = true;
  spec.gravity = gravity;
  auto world = subject.make(spec);
  RobotState start = world->home_state();
  start.q[0] = angle;
  start.qd[0] = speed;
  world->reset(start);
  return world;
}

WorldSpec world_on(const char* terrain, const scenes::RobotPtr& robot) {
  WorldSpec spec = scenes::world_of(robot);
  spec.terrain = make_terrain(terrain);
  return spec;
}

double relative_difference(const JointVector& found, const JointVector& expected) {
  double worst = 0;
  for (Eigen::Index i = 0; i < expected.size(); ++i) {
    const double difference = std::abs(found[i] - expected[i]);
    if (difference > 0) worst = std::max(worst, difference / std::abs(expected[i]));
  }
  return worst;
}

double convergence(double fine, double coarse, double expected, double rounding) {
  const double off = fine - expected * coarse;
  return expected + std::copysign(std::max(0.0, std::abs(off) - (1 + expected) * rounding), off) / coarse;
}

double residual_speed(const EngineInfo& engine) {
  const bool stops_early = engine.laws.contact.find("/temporal") != std::string::npos;
  return stops_early ? kGravity * 1e-3 / 5 : 0;
}

double soft_creep(const scenes::ArmLink& link, double torque) {
  const Softness soft = RobotDescription().friction_softness;
  const double damping = 2 / (soft.impedance_max * soft.time_constant);
  return torque * (1 - soft.impedance_min) / soft.impedance_min / link.joint_inertia() / damping;
}

bool is_soft(const Subject& subject) { return subject.engine.info.capabilities.soft_contact; }

double loop_gap(const PhysicsBackend& world) {
  std::vector<Pose> poses;
  forward_kinematics(world.robot(), world.state(), poses);
  return max_loop_gap(world.robot(), poses);
}

}  // namespace crossgait::conformance
