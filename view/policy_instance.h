// A robot whose gait a policy adapts, or whose joints it commands; by hand it is told where to go.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "env/quadruped_env.h"
#include "view/robot_instance.h"

namespace crossgait {

class PolicyInstance final : public RobotInstance {
 public:
  /// Stands and has settled. What `config` randomises is left out, its episodes go on for as long as they
  /// may, and its command begins at zero. @param policy  as `load_policy` takes it. @throws ConfigError
  PolicyInstance(const Engine& engine, const LoadedEnv& environment, const std::string& policy);

  /// Begins a policy anew that remembers what it saw.
  std::unique_ptr<RobotInstance> with_engine(const Engine& engine) const override;
  std::unique_ptr<RobotInstance> with_terrain(const Engine& engine,
                                              const TerrainChoice& ground) const override;

  std::unique_ptr<RobotInstance> with_changes(const Engine& engine,
                                              const std::vector<QuantityChange>& changes) const override;
  std::unique_ptr<Saved> save() const override;
  void restore(const Saved& saved) override;

  /// Makes control steps a policy step at a time, with the first of it.
  void step() override;
  void stand_up() override;
  void push(const Vector3& impulse) override;
  void pull(const Vector3& force) override;

  void set_command(const VelocityCommand& command) override;
  void set_gait(const std::string& gait) override;
  void set_parameter(const std::string& name, double value) override;
  void set_curve(const std::string& curve) override;

  const VelocityCommand& command() const noexcept override { return command_; }
  std::string chosen_gait() const override;
  const GaitGenerator* gait() const noexcept override;
  const PhysicsBackend& world() const noexcept override { return env_.world(); }
  const ControlTargets& targets() const noexcept override { return env_.targets(); }
  Outcome outcome() const noexcept override { return env_.info().outcome; }

 private:
  struct Moment;
  PolicyInstance(const Engine& engine, const LoadedEnv& environment, PolicyFactory make);
  PolicyInstance(const Engine& engine, const PolicyInstance& other);

  PolicyFactory make_;
  QuadrupedEnv env_;
  std::unique_ptr<Policy> policy_;
  VelocityCommand command_;
  std::vector<double> observation_, action_;
  int steps_left_ = 0;  // control steps that the last policy step has made already
};

}  // namespace crossgait
