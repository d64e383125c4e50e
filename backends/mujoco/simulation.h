// MuJoCo's model and data, in which the worlds that share them take turns.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "backends/mujoco/engine_call.h"
#include "backends/mujoco/model.h"
#include "backends/mujoco/terrain_collision.h"
#include "physics/engine/world_group.h"

namespace crossgait::mujoco {

/// Is all that the next step of a world hangs on, in MuJoCo's own order: qpos, qvel, qacc_warmstart (from
/// which the solver starts), place and attitude of a base that does not move, time.
class KeptState {
 public:
  explicit KeptState(const mjModel& model);

  mjtNum* qpos() noexcept { return numbers_.data(); }
  mjtNum* qvel() noexcept { return qpos() + nq_; }
  mjtNum* warmstart() noexcept { return qvel() + nv_; }
  mjtNum* base_position() noexcept { return warmstart() + nv_; }
  mjtNum* base_attitude() noexcept { return base_position() + 3; }
  mjtNum& time() noexcept { return numbers_.back(); }

  const mjtNum* qpos() const noexcept { return numbers_.data(); }
  const mjtNum* qvel() const noexcept { return qpos() + nq_; }
  const mjtNum* warmstart() const noexcept { return qvel() + nv_; }
  const mjtNum* base_position() const noexcept { return warmstart() + nv_; }
  const mjtNum* base_attitude() const noexcept { return base_position() + 3; }
  mjtNum time() const noexcept { return numbers_.back(); }

  /// Puts all joints to zero and everything to rest, the base at a place (m) and attitude (w, x, y, z).
  void clear(const mjModel& model, const mjtNum* position, const mjtNum* attitude);
  const std::vector<double>& numbers() const noexcept { return numbers_; }
  /// @param numbers  of another of the same model
  void set(const std::vector<double>& numbers) noexcept;

 private:
  std::size_t nq_, nv_;
  std::vector<double> numbers_;
};

/// Says which state of which world is in a simulation; 0: none.
struct Occupant {
  std::uint64_t world = 0, state = 0;
  bool operator==(const Occupant&) const = default;
};

/// Holds what a step takes: the model, data, and what finds contacts. For one thread at a time.
class Simulation {
 public:
  /// @param terrain  has to outlive this
  Simulation(ModelPtr model, const WorldSpec& spec, const Terrain& terrain);

  mjModel& model() noexcept { return *model_; }
  const mjModel& model() const noexcept { return *model_; }
  mjData& data() noexcept { return *data_; }
  /// Returns data without contacts, for questions between steps. Made when the first is asked: most worlds of
  /// a training never are. @throws std::runtime_error
  mjData& query();
  TerrainCollision& collision() noexcept { return collision_; }
  CalledFor who() noexcept { return {model_.get(), &collision_}; }

  /// Makes `state` the one that is simulated next, unless it is in here. Allocates nothing.
  void load(const Occupant& who, const KeptState& state, int base_body) noexcept;
  /// Takes what a step has made of it. @param now  whose and which it is
  void store(const Occupant& now, KeptState& state) noexcept;
  /// Says that MuJoCo left the data as they must not be used.
  void spoil() noexcept {
    occupant_ = {};
    spoilt_ = true;
  }

 private:
  ModelPtr model_;
  DataPtr data_, query_;
  TerrainCollision collision_;
  Occupant occupant_;
  bool spoilt_ = false;
};

/// Holds the simulations of worlds that are alike, one for each thread that steps them.
class Simulations {
 public:
  /// Returns those of the world's group, if that has the same robot, ground and settings; else one of its
  /// own.
  /// @param engine  that asks: its name
  /// @throws ConfigError if MuJoCo refuses the model, std::runtime_error if it fails otherwise (memory)
  static std::shared_ptr<Simulations> of(const WorldSpec& spec, const std::string& engine);

  /// Returns that of the calling thread.
  Simulation& here() noexcept { return *all_[group_ == nullptr ? 0 : group_->thread()]; }
  /// Returns a model of theirs, to read what no world changes: not where a base is that does not move.
  const mjModel& model() const noexcept { return all_.front()->model(); }
  /// Returns where a body is in its parent as the model was made, m, and its attitude, w, x, y, z.
  const mjtNum* position(int body) const noexcept { return &positions_[3 * static_cast<std::size_t>(body)]; }
  const mjtNum* attitude(int body) const noexcept { return &attitudes_[4 * static_cast<std::size_t>(body)]; }

 private:
  /// @param xml  model_xml(spec)
  Simulations(const WorldSpec& spec, std::string xml, std::size_t threads);
  bool are_of(const WorldSpec& spec, const std::string& xml) const;

  WorldSpec spec_;
  std::string xml_;
  const WorldGroup* group_ = nullptr;  // which owns this
  std::vector<std::unique_ptr<Simulation>> all_;
  std::vector<mjtNum> positions_, attitudes_;
};

}  // namespace crossgait::mujoco
