// A robot that walks a gait, driven by hand.
#pragma once

#include <memory>
#include <string>

#include "motion/closed_loop.h"
#include "view/gait_drive.h"
#include "view/robot_instance.h"

namespace crossgait {

class GaitInstance final : public RobotInstance {
 public:
  /// Stands and has settled, at the origin. @throws ConfigError if the world cannot be made or the robot
  /// cannot stand
  GaitInstance(const Engine& engine, const WorldSpec& spec, const GaitDrive& drive, double control_dt);

  std::unique_ptr<RobotInstance> with_engine(const Engine& engine) const override;
  std::unique_ptr<RobotInstance> with_terrain(const Engine& engine,
                                              const TerrainChoice& ground) const override;

  std::unique_ptr<RobotInstance> with_changes(const Engine& engine,
                                              const std::vector<QuantityChange>& changes) const override;
  std::unique_ptr<Saved> save() const override;
  void restore(const Saved& saved) override;

  void step() override;
  void stand_up() override;
  void push(const Vector3& impulse) override { world_->apply_push(impulse); }
  void pull(const Vector3& force) override { world_->apply_wrench({.wrench = {force}}); }

  void set_command(const VelocityCommand& command) override { drive_.set_command(command); }
  void set_gait(const std::string& gait) override { drive_.set_gait(gait); }
  void set_parameter(const std::string& name, double value) override { drive_.set_parameter(name, value); }
  void set_curve(const std::string& curve) override { drive_.set_curve(curve); }

  const VelocityCommand& command() const noexcept override { return drive_.command(); }
  std::string chosen_gait() const override { return drive_.chosen_gait(); }
  const GaitGenerator* gait() const noexcept override { return &drive_.generator(); }
  const PhysicsBackend& world() const noexcept override { return *world_; }
  const ControlTargets& targets() const noexcept override { return loop_.targets(); }
  Outcome outcome() const noexcept override { return loop_.statistics().worst(); }

 private:
  struct Moment;
  GaitInstance(const Engine& engine, const GaitInstance& other, const WorldSpec& spec);

  WorldSpec nominal_;  ///< without changes
  std::unique_ptr<PhysicsBackend> world_;
  double control_dt_;
  GaitDrive drive_;
  ClosedLoop loop_;
};

}  // namespace crossgait
