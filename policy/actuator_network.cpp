#include "policy/actuator_network.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "physics/core/error.h"
#include "physics/core/read_budget.h"
#include "policy/mlp_activation.h"
#include "policy/policy_bundle_names.h"
#include "policy/tensor_reader.h"

namespace crossgait {
namespace {

constexpr std::string_view kFormat = "crossgait-actuator-1";
constexpr std::array<std::pair<std::string_view, bool>, 2> kOrders{
    {{"error_first", false}, {"velocity_first", true}}};
constexpr std::size_t kOldestInstant = 100;  // physics steps
constexpr std::size_t kMostUnits = 4096;     // of a layer

void squash(Eigen::Ref<Eigen::VectorXf> values) noexcept {
  values.array() = 1.0F / ((-values.array()).exp() + 1.0F);
}

}  // namespace

// Takes entries out of the file one by one.
class ActuatorReader : private TensorReader {
 public:
  explicit ActuatorReader(const std::string& path) : TensorReader(path, "an actuator's network") {}

  std::shared_ptr<const ActuatorNetwork> read() {
    auto network = std::make_shared<ActuatorNetwork>();
    check_format(kFormat);
    network->path_ = path();
    network->activation_ = choice("activation", bundle_names::kActivations);
    network->velocities_first_ = choice("input_order", kOrders);
    network->instants_ = instants();
    network->physics_dt_ = positive_number("physics_dt");
    network->error_scale_ = static_cast<float>(number("error_scale"));
    network->velocity_scale_ = static_cast<float>(number("velocity_scale"));
    network->torque_scale_ = static_cast<float>(number("torque_scale"));
    read_layers(*network, read_lstm(*network, 2 * network->instants_.size()));
    check_golden(*network);
    check_all_read();
    return network;
  }

 private:
  std::vector<std::size_t> instants() {
    const std::string found = text("instants");
    check_json_budget(found, kPolicyBudget, fmt::format("{}: instants", path()));
    const nlohmann::json list = nlohmann::json::parse(found, nullptr, false);
    const auto fits = [](const nlohmann::json& item) {
      return item.is_number_unsigned() && item.get<std::size_t>() <= kOldestInstant;
    };
    if (!list.is_array() || list.empty() || list.size() > kOldestInstant ||
        !std::all_of(list.begin(), list.end(), fits))
      fail("instants", fmt::format("a JSON list of physics steps ago, 0 to {}", kOldestInstant),
           fmt::format("'{}'", found));
    return list.get<std::vector<std::size_t>>();
  }

  std::size_t checked(const std::string& name, std::size_t units) const {
    if (units > kMostUnits) fail(name, fmt::format("at most {} units", kMostUnits), std::to_string(units));
    return units;
  }

  std::size_t read_lstm(ActuatorNetwork& network, std::size_t width) {
    for (std::size_t k = 0; has_tensor(fmt::format("lstm.{}.weight_ih", k)); ++k) {
      const auto key = [k](const char* part) { return fmt::format("lstm.{}.{}", k, part); };
      const Eigen::MatrixXd input = matrix(key("weight_ih"), 0, width);
      const std::size_t units = checked(key("weight_ih"), static_cast<std::size_t>(input.rows()) / 4);
      if (4 * units != static_cast<std::size_t>(input.rows()))
        fail(key("weight_ih"), "four rows of each unit", std::to_string(input.rows()));
      const Eigen::MatrixXd hidden = matrix(key("weight_hh"), 4 * units, units);
      const Eigen::VectorXd bias = vector(key("bias_ih"), 4 * units) + vector(key("bias_hh"), 4 * units);
      network.lstm_.push_back({input.cast<float>(), hidden.cast<float>(), bias.cast<float>()});
      width = units;
    }
    return width;
  }

  void read_layers(ActuatorNetwork& network, std::size_t width) {
    const auto name = [](std::size_t k) { return fmt::format("layer.{}.weight", k); };
    for (std::size_t k = 0; k == 0 || has_tensor(name(k)); ++k) {
      const Eigen::MatrixXd weight = matrix(name(k), has_tensor(name(k + 1)) ? 0 : 1, width);
      width = checked(name(k), static_cast<std::size_t>(weight.rows()));
      const Eigen::VectorXd bias = vector(fmt::format("layer.{}.bias", k), width);
      network.layers_.push_back({weight.cast<float>(), bias.cast<float>()});
    }
  }

  // What whoever made the network computed with it, for one servo from rest.
  void check_golden(const ActuatorNetwork& network) {
    const Eigen::VectorXd errors = vector("golden.error", 0);
    const auto steps = static_cast<std::size_t>(errors.size());
    const Eigen::VectorXd velocities = vector("golden.velocity", steps),
                          torques = vector("golden.torque", steps);
    // As of policies: what summing in another order changes in single precision, in units of the largest.
    const double tolerance = 1e-5 * std::max(1.0, torques.cwiseAbs().maxCoeff());
    ActuatorNetwork::Memory memory = network.begin();
    for (Eigen::Index i = 0; i < errors.size(); ++i) {
      const double torque = network.torque(errors[i], velocities[i], memory);
      if (std::abs(torque - torques[i]) <= tolerance) continue;
      fail(fmt::format("golden.torque [{}]", i),
           fmt::format("what the network makes of golden.error and golden.velocity, {:.7g} within {:g} N m",
                       torque, tolerance),
           fmt::format("{:.7g}", torques[i]));
    }
  }
};

std::shared_ptr<const ActuatorNetwork> ActuatorNetwork::read(const std::string& path) {
  return ActuatorReader(path).read();
}

void ActuatorNetwork::check_step(double physics_dt, std::string_view source) const {
  constexpr double kRounding = 1e-9;  // relative; of a number that was written as decimal text
  if (std::abs(physics_dt - physics_dt_) <= kRounding * physics_dt_) return;
  throw ConfigError(source, "physics_dt", fmt::format("{:g} s, the step of {}", physics_dt_, path_),
                    fmt::format("{:g} s", physics_dt));
}

ActuatorNetwork::Memory ActuatorNetwork::begin() const {
  Memory memory;
  const std::size_t oldest = *std::max_element(instants_.begin(), instants_.end());
  memory.errors.assign(oldest + 1, 0);
  memory.velocities = memory.errors;
  memory.input = Eigen::VectorXf::Zero(static_cast<Eigen::Index>(2 * instants_.size()));
  for (const Lstm& layer : lstm_) {
    memory.hidden.emplace_back(Eigen::VectorXf::Zero(layer.hidden.cols()));
    memory.cell.push_back(memory.hidden.back());
    memory.gates.emplace_back(Eigen::VectorXf::Zero(layer.bias.size()));
  }
  for (const Layer& layer : layers_) memory.values.push_back(layer.bias);
  return memory;
}

void ActuatorNetwork::restart(Memory& memory) const noexcept {
  std::fill(memory.errors.begin(), memory.errors.end(), 0.0F);
  std::fill(memory.velocities.begin(), memory.velocities.end(), 0.0F);
  for (std::size_t k = 0; k < lstm_.size(); ++k) {
    memory.hidden[k].setZero();
    memory.cell[k].setZero();
  }
}

double ActuatorNetwork::torque(double error, double velocity, Memory& memory) const noexcept {
  if (!std::isfinite(error) || !std::isfinite(velocity)) return 0;
  std::shift_right(memory.errors.begin(), memory.errors.end(), 1);
  std::shift_right(memory.velocities.begin(), memory.velocities.end(), 1);
  memory.errors.front() = error_scale_ * static_cast<float>(error);
  memory.velocities.front() = velocity_scale_ * static_cast<float>(velocity);
  const std::size_t count = instants_.size(), first = velocities_first_ ? count : 0;
  for (std::size_t i = 0; i < count; ++i) {
    memory.input[static_cast<Eigen::Index>(first + i)] = memory.errors[instants_[i]];
    memory.input[static_cast<Eigen::Index>(count - first + i)] = memory.velocities[instants_[i]];
  }
  const Eigen::VectorXf* x = &memory.input;
  for (std::size_t k = 0; k < lstm_.size(); ++k) {
    Eigen::VectorXf &gates = memory.gates[k], &hidden = memory.hidden[k], &cell = memory.cell[k];
    gates = lstm_[k].bias;
    gates.noalias() += lstm_[k].input * *x;
    gates.noalias() += lstm_[k].hidden * hidden;
    const Eigen::Index units = hidden.size();
    squash(gates.head(2 * units));
    squash(gates.tail(units));
    auto in = gates.head(units).array(), forget = gates.segment(units, units).array(),
         next = gates.segment(2 * units, units).array(), out = gates.tail(units).array();
    cell.array() = forget * cell.array() + in * next.tanh();
    hidden.array() = out * cell.array().tanh();
    x = &hidden;
  }
  for (std::size_t k = 0; k < layers_.size(); ++k) {
    Eigen::VectorXf& values = memory.values[k];
    values = layers_[k].bias;
    values.noalias() += layers_[k].weight * *x;
    if (k + 1 < layers_.size()) activate(activation_, values);
    x = &values;
  }
  return torque_scale_ * static_cast<double>((*x)[0]);
}

}  // namespace crossgait
