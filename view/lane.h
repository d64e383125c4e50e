// One driven robot in one engine. Several lanes take the same commands, side by side.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "crossgait/env/closed_loop.h"
#include "crossgait/physics/engine.h"
#include "crossgait/view/gait_drive.h"

namespace crossgait {

class Lane {
 public:
  /// Stands and has settled, at the origin. @throws ConfigError if the world cannot be made or the robot
  /// cannot stand
  Lane(const Engine& engine, const WorldSpec& spec, const GaitDrive& drive, double control_dt);
  /// `other` as it is now, in another engine: generalised coordinates, velocities and time of the world,
  /// phase and parameters of the gait, statistics. Contacts, pending pushes and servo targets that are on
  /// their way are forgotten, as `PhysicsBackend::reset` does. @throws ConfigError if the world cannot be
  /// made
  Lane(const Engine& engine, const Lane& other);
  ~Lane() = default;
  Lane(const Lane&) = delete;
  Lane& operator=(const Lane&) = delete;

  /// One more control step, unless it has ended. @returns whether it was made
  bool step();
  /// Back to the stand at the origin, settled, without a command. @throws ConfigError if the parameters leave
  /// no stand
  void stand_up();
  /// @param impulse  N s, in W, at the base. @throws ConfigError if not finite
  void push(const Vector3& impulse) { world_->apply_push(impulse); }

  GaitDrive& drive() noexcept { return drive_; }
  const GaitDrive& drive() const noexcept { return drive_; }
  const PhysicsBackend& world() const noexcept { return *world_; }
  const ControlTargets& targets() const noexcept { return loop_.targets(); }
  /// "walked" while all is well, else the worst outcome so far ("fell"; env/outcome.h).
  std::string_view outcome() const noexcept { return name(loop_.statistics().worst()); }

 private:
  TargetSource source();

  std::unique_ptr<PhysicsBackend> world_;
  GaitDrive drive_;
  ClosedLoop loop_;
  TargetSource source_;  // of drive_
};

}  // namespace crossgait
