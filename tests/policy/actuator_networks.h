// Networks of actuators: their files, and the same computed in double precision in another way.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include <Eigen/Core>
#include <fmt/format.h>

#include "physics/core/random.h"
#include "policy/safetensors.h"

namespace crossgait::actuator_tests {

/// Computes a torque from the whole past, anew every time.
struct PlainActuator {
  std::vector<std::array<double, 2>> past;  // error, velocity
  std::vector<Eigen::MatrixXd> weights;
  std::vector<Eigen::VectorXd> biases;
  Eigen::MatrixXd input, hidden;  // of an LSTM
  Eigen::VectorXd bias;
  bool lstm = false;

  double torque() const {
    const auto at = [&](std::size_t ago, std::size_t which) {
      return ago < past.size() ? past[past.size() - 1 - ago][which] : 0;
    };
    Eigen::VectorXd x;
    if (lstm) {
      const Eigen::Index units = hidden.cols();
      Eigen::VectorXd h = Eigen::VectorXd::Zero(units), c = h;
      for (const auto& now : past) {
        const Eigen::VectorXd g = input * Eigen::Vector2d(now[0], 0.1 * now[1]) + hidden * h + bias;
        for (Eigen::Index i = 0; i < units; ++i) {
          const auto gate = [&](Eigen::Index k) { return 1 / (1 + std::exp(-g[k * units + i])); };
          c[i] = gate(1) * c[i] + gate(0) * std::tanh(g[2 * units + i]);
          h[i] = gate(3) * std::tanh(c[i]);
        }
      }
      x = h;
    } else {
      x.resize(6);
      for (std::size_t k = 0; k < 3; ++k) {
        x[static_cast<Eigen::Index>(k)] = at(k, 0);
        x[static_cast<Eigen::Index>(3 + k)] = 0.1 * at(k, 1);
      }
    }
    for (std::size_t k = 0; k < weights.size(); ++k) {
      x = weights[k] * x + biases[k];
      if (k + 1 < weights.size())
        for (double& value : x) value /= 1 + std::abs(value);
    }
    return 20 * x[0];
  }
};

inline Tensor tensor_of(const Eigen::MatrixXd& matrix, bool vector = false) {
  Tensor tensor{Tensor::Kind::kF64, {static_cast<std::size_t>(matrix.rows())}, {}};
  if (!vector) tensor.shape.push_back(static_cast<std::size_t>(matrix.cols()));
  for (const auto& row : matrix.rowwise()) tensor.values.insert(tensor.values.end(), row.begin(), row.end());
  return tensor;
}

/// Draws a network: an LSTM of 4 units with a layer behind it, or a perceptron of 6-32-32-1.
inline PlainActuator plain(bool lstm) {
  Random random(3);
  const auto draw = [&random] { return random.uniform(-0.8, 0.8); };
  PlainActuator plain;
  plain.lstm = lstm;
  plain.input = Eigen::MatrixXd::NullaryExpr(16, 2, draw);
  plain.hidden = Eigen::MatrixXd::NullaryExpr(16, 4, draw);
  plain.bias = Eigen::VectorXd::NullaryExpr(16, draw);
  const std::vector<Eigen::Index> sizes =
      lstm ? std::vector<Eigen::Index>{4, 1} : std::vector<Eigen::Index>{6, 32, 32, 1};
  for (std::size_t k = 0; k + 1 < sizes.size(); ++k) {
    plain.weights.emplace_back(Eigen::MatrixXd::NullaryExpr(sizes[k + 1], sizes[k], draw));
    plain.biases.emplace_back(Eigen::VectorXd::NullaryExpr(sizes[k + 1], draw));
  }
  return plain;
}

/// Makes the file of a network, with what it computes of eight steps.
inline TensorFile file_of(PlainActuator plain) {
  TensorFile file;
  file.metadata = {{"format", "crossgait-actuator-1"},
                   {"activation", "softsign"},
                   {"input_order", "error_first"},
                   {"instants", plain.lstm ? "[0]" : "[0, 1, 2]"},
                   {"physics_dt", "0.001"},
                   {"error_scale", "1"},
                   {"velocity_scale", "0.1"},
                   {"torque_scale", "20"}};
  for (std::size_t k = 0; k < plain.weights.size(); ++k) {
    file.tensors[fmt::format("layer.{}.weight", k)] = tensor_of(plain.weights[k]);
    file.tensors[fmt::format("layer.{}.bias", k)] = tensor_of(plain.biases[k], true);
  }
  if (plain.lstm) {
    file.tensors["lstm.0.weight_ih"] = tensor_of(plain.input);
    file.tensors["lstm.0.weight_hh"] = tensor_of(plain.hidden);
    file.tensors["lstm.0.bias_ih"] = tensor_of(plain.bias, true);
    file.tensors["lstm.0.bias_hh"] = tensor_of(0 * plain.bias, true);
  }
  Eigen::VectorXd errors(8), velocities(8), torques(8);
  for (Eigen::Index i = 0; i < 8; ++i) {
    errors[i] = 0.1 * std::sin(static_cast<double>(i));
    velocities[i] = std::cos(static_cast<double>(i));
    plain.past.push_back({errors[i], velocities[i]});
    torques[i] = plain.torque();
  }
  file.tensors["golden.error"] = tensor_of(errors, true);
  file.tensors["golden.velocity"] = tensor_of(velocities, true);
  file.tensors["golden.torque"] = tensor_of(torques, true);
  return file;
}

}  // namespace crossgait::actuator_tests
