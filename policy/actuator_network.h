// A network in the place of a servo's law, as fitted to real drives: what it feels gives its torque.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "policy/policy_bundle.h"

namespace crossgait {

/// Computes the torque of a servo from how far it is from its target and how fast it turns, now and some
/// steps ago; or with a memory (LSTM). The two common shapes: a perceptron on three errors and three
/// velocities (Hwangbo et al., Learning agile and dynamic motor skills for legged robots, 2019), and an LSTM
/// on one each (Rudin et al., Learning to walk in minutes, 2021). One network is shared by servos with a
/// memory each. In single precision, without allocating.
class ActuatorNetwork {
 public:
  /// Holds what one servo's network remembers, and room to compute in. A value: a copy goes on from there.
  struct Memory {
    std::vector<float> errors, velocities;  ///< scaled, of the last steps, newest first
    Eigen::VectorXf input;
    std::vector<Eigen::VectorXf> hidden, cell, gates;  ///< of each LSTM layer
    std::vector<Eigen::VectorXf> values;               ///< of each layer after them
  };

  /// Reads a file of the format `crossgait-actuator-1` (docs/policies.md).
  /// @throws ConfigError naming file and entry, also if the network does not reproduce its golden torques
  static std::shared_ptr<const ActuatorNetwork> read(const std::string& path);

  /// @throws ConfigError naming `source` unless `physics_dt` (s) is the step that the network was made for
  void check_step(double physics_dt, std::string_view source) const;

  /// Makes a memory of nothing: errors and velocities were zero for ever.
  Memory begin() const;
  void restart(Memory& memory) const noexcept;
  /// Computes the torque in the next physics step, N m; zero, and the memory stays, where an input is not
  /// finite.
  /// @param error     target less angle, rad
  /// @param velocity  rad/s
  double torque(double error, double velocity, Memory& memory) const noexcept;

 private:
  struct Layer {
    Eigen::MatrixXf weight;
    Eigen::VectorXf bias;
  };
  struct Lstm {
    Eigen::MatrixXf input, hidden;  // [4 units, inputs], [4 units, units]: in, forget, cell, out
    Eigen::VectorXf bias;
  };

  friend class ActuatorReader;

  std::string path_;
  MlpActivation activation_ = MlpActivation::kSoftsign;
  std::vector<std::size_t> instants_;  // of the inputs: 0 is now, 1 a physics step ago
  bool velocities_first_ = false;
  double physics_dt_ = 0;  // s
  float error_scale_ = 1, velocity_scale_ = 1, torque_scale_ = 1;
  std::vector<Lstm> lstm_;
  std::vector<Layer> layers_;
};

}  // namespace crossgait
