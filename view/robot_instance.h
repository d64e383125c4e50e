// One driven robot in one engine. Several instances take the same commands, side by side.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "gait/gait_generator.h"
#include "motion/controller.h"
#include "motion/outcome.h"
#include "physics/engine/engine.h"
#include "physics/engine/world_quantities.h"

namespace crossgait {

/// Describes a ground by generator, as `make_terrain` takes it.
struct TerrainChoice {
  std::string terrain;
  std::uint64_t seed = 0;
};

/// Drives one robot by a gait (gait_instance.h) or a policy (policy_instance.h).
class RobotInstance {
 public:
  RobotInstance() = default;
  virtual ~RobotInstance() = default;
  RobotInstance(const RobotInstance&) = delete;
  RobotInstance& operator=(const RobotInstance&) = delete;

  /// Copies this, as it is, into another engine: coordinates, velocities and time of the world, phase and
  /// parameters of the gait, statistics. Contacts, pending pushes and servo targets that are on their way are
  /// forgotten, as `PhysicsBackend::reset` does. @throws ConfigError if the world cannot be made
  virtual std::unique_ptr<RobotInstance> with_engine(const Engine& engine) const = 0;
  /// Makes one anew on another ground, standing at its origin, gait and parameters kept. @throws ConfigError
  virtual std::unique_ptr<RobotInstance> with_terrain(const Engine& engine,
                                                      const TerrainChoice& ground) const = 0;

  /// Makes one whose world is the first one's with these changes, in place of all changes before, and which
  /// goes on as `with_engine` does. @throws ConfigError for what cannot change under way (physics_dt, delay),
  /// and if the world cannot be made
  virtual std::unique_ptr<RobotInstance> with_changes(const Engine& engine,
                                                      const std::vector<QuantityChange>& changes) const = 0;

  /// Holds a moment of an instance.
  struct Saved {
    Saved() = default;
    virtual ~Saved() = default;
    Saved(const Saved&) = delete;
    Saved& operator=(const Saved&) = delete;
  };
  /// Saves what the motion depends on, but for what a policy remembers.
  virtual std::unique_ptr<Saved> save() const = 0;
  /// Continues where `saved` was: a moment of this instance, in this world.
  virtual void restore(const Saved& saved) = 0;

  /// Goes on by one control step, unless it has ended (it left the ground, the engine diverged).
  virtual void step() = 0;
  /// Goes back to the stand at the origin, settled, without a command. @throws ConfigError if the parameters
  /// leave no stand
  virtual void stand_up() = 0;
  /// @param impulse  N s, in W, at the base. @throws ConfigError if not finite
  virtual void push(const Vector3& impulse) = 0;

  /// Lets a force act on the base's origin in the next control step (of a policy: in those until its next
  /// action). @param force  N, in W
  virtual void pull(const Vector3& force) = 0;

  /// @throws ConfigError beyond `drive_limits`, or not finite
  virtual void set_command(const VelocityCommand& command) = 0;
  /// Sets a gait with the parameters that it prefers; `auto` is the gait for the speed. @throws ConfigError
  /// for an unknown name, or where a policy drives
  virtual void set_gait(const std::string& gait) = 0;
  /// @throws ConfigError for an unknown name, a value outside `parameter_range`, or where a policy drives
  virtual void set_parameter(const std::string& name, double value) = 0;

  /// Sets the SwingCurve by name. @throws ConfigError for an unknown name, or where a policy drives
  virtual void set_curve(const std::string& curve) = 0;

  virtual const VelocityCommand& command() const noexcept = 0;
  /// Returns what `set_gait` was told; a policy's own gait; empty where joints are commanded.
  virtual std::string chosen_gait() const = 0;
  /// Returns the gait; null where joints are commanded.
  virtual const GaitGenerator* gait() const noexcept = 0;
  virtual const PhysicsBackend& world() const noexcept = 0;
  /// Returns the targets of the last control step.
  virtual const ControlTargets& targets() const noexcept = 0;
  /// Returns kWalked while all is well, else the worst so far.
  virtual Outcome outcome() const noexcept = 0;
};

}  // namespace crossgait
