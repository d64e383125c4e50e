#include "policy/mlp_policy.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "policy/safetensors.h"
#include "tests/physics/core/config_error.h"
#include "tests/physics/core/scratch_folder.h"
#include "tests/policy/policy_interfaces.h"
#include "tests/support/constants.h"

namespace crossgait {
namespace {

using policy_tests::large_interface;
using policy_tests::layout_of;
using policy_tests::random_network;
using policy_tests::small_interface;

constexpr double kSinglePrecision = 1e-6;  // some roundings of numbers around one

std::vector<double> act_on(Policy& policy, const std::vector<double>& observation) {
  std::vector<double> action(policy.interface().action.size(), 9);
  policy.act(observation, action);
  return action;
}

/// Two inputs, two hidden, one output.
PolicyInterface tiny_interface() { return {layout_of({"x", "y"}), layout_of({"u"}), 2e-3}; }

MlpNetwork tiny_network() {
  MlpNetwork network;
  network.layers.resize(2);
  network.layers[0] = {(Eigen::MatrixXd(2, 2) << 1, -2, 0.5, 0.25).finished(), Eigen::Vector2d(0.1, -0.2)};
  network.layers[1] = {(Eigen::MatrixXd(1, 2) << 0.3, -0.4).finished(), Eigen::VectorXd::Constant(1, 0.05)};
  return network;
}

using Change = std::function<void(TensorFile&)>;

Change with_metadata(const std::string& key, const std::string& text) {
  return [key, text](TensorFile& file) { file.metadata[key] = text; };
}

class MlpPolicyTest : public ScratchFolder {
 protected:
  std::unique_ptr<Policy> make(const MlpNetwork& network,
                               const PolicyInterface& interface = tiny_interface()) {
    write_policy_bundle(path("p.safetensors"), network, interface);
    return make_policy(path("p.safetensors"), interface);
  }
  /// What loading says about a good bundle after `change`, without the path.
  std::string error_after(const Change& change) {
    write_policy_bundle(path("p.safetensors"), random_network(small_interface(), {8, 4}), small_interface());
    TensorFile file = read_safetensors(path("p.safetensors"));
    change(file);
    write_safetensors(path("p.safetensors"), file);
    return error_for(small_interface());
  }
  std::string error_for(const PolicyInterface& interface) {
    const std::string file = path("p.safetensors");
    return std::string(config_error([&] { (void)make_policy(file, interface); }).what())
        .substr(file.size() + 2);
  }
};

TEST_F(MlpPolicyTest, ComputesATinyNetworkAsByHand) {
  // Hidden sums of (0.2, 0.6): 0.2 - 1.2 + 0.1 = -0.9 and 0.1 + 0.15 - 0.2 = 0.05; then 0.3 h1 - 0.4 h2 +
  // 0.05.
  const std::vector<double> observation{0.2, 0.6};
  MlpNetwork network = tiny_network();
  network.activation = MlpActivation::kRelu;
  EXPECT_NEAR(act_on(*make(network), observation)[0], 0.03, kSinglePrecision);
  network.activation = MlpActivation::kTanh;  // -0.71629787, 0.04995838
  EXPECT_NEAR(act_on(*make(network), observation)[0], -0.18487271, kSinglePrecision);
  network.activation = MlpActivation::kElu;  // exp(-0.9) - 1 = -0.59343034, 0.05
  EXPECT_NEAR(act_on(*make(network), observation)[0], -0.14802910, kSinglePrecision);
  network.output = MlpOutput::kTanh;
  EXPECT_NEAR(act_on(*make(network), observation)[0], -0.14695739, kSinglePrecision);
}

TEST_F(MlpPolicyTest, NormalisesAndThenClipsObservations) {
  // ((1.4, -0.7) - (1, -1)) / (2, 0.5) = (0.2, 0.6) as above; 20 and -20 become 1.5 and -1.5:
  // hidden 1.5 + 3 + 0.1 = 4.6 and 0.75 - 0.375 - 0.2 = 0.175; action 1.38 - 0.07 + 0.05 beyond 1.
  MlpNetwork network = tiny_network();
  network.activation = MlpActivation::kRelu;
  network.observation_mean = Eigen::Vector2d(1, -1);
  network.observation_std = Eigen::Vector2d(2, 0.5);
  network.observation_clip = 1.5;
  const auto policy = make(network);
  EXPECT_NEAR(act_on(*policy, {1.4, -0.7})[0], 0.03, kSinglePrecision);
  EXPECT_EQ(act_on(*policy, {41, -11})[0], 1);
  network.layers[1].weight *= 0.5;  // 0.69 - 0.035 + 0.05
  EXPECT_NEAR(act_on(*make(network), {41, -11})[0], 0.705, kSinglePrecision);
}

TEST_F(MlpPolicyTest, GoldenActionsAreWithinTheirLimits) {
  MlpNetwork network = tiny_network();
  network.layers[1].weight *= 100;
  EXPECT_EQ(std::abs(act_on(*make(network), {0, 0})[0]), 1);  // and loads
  int at_limit = 0;
  const TensorFile file = read_safetensors(path("p.safetensors"));
  for (const double action : file.tensors.at("golden.action").values) {
    EXPECT_LE(std::abs(action), 1);
    at_limit += std::abs(action) == 1 ? 1 : 0;
  }
  EXPECT_GT(at_limit, 0);
}

TEST_F(MlpPolicyTest, AgreesWithDoublePrecision) {
  for (const MlpActivation activation : {MlpActivation::kTanh, MlpActivation::kElu, MlpActivation::kRelu}) {
    for (const std::vector<int>& hidden : {std::vector<int>{}, {1}, {17, 3}, {512, 256, 128}}) {
      const PolicyInterface interface = large_interface();
      MlpNetwork network = random_network(interface, hidden, hidden.size() + 1);
      network.activation = activation;
      const auto policy = make(network, interface);
      Random random(9);
      for (int i = 0; i < 20; ++i) {
        std::vector<double> observation(69);
        for (double& value : observation) value = random.uniform(-3, 3);
        const Eigen::VectorXd expected =
            network.evaluate(Eigen::Map<Eigen::VectorXd>(observation.data(), 69));
        const std::vector<double> action = act_on(*policy, observation);
        // Weights and 512 sums rounded to single precision.
        for (int k = 0; k < 16; ++k) EXPECT_NEAR(action[k], std::clamp(expected[k], -1.0, 1.0), 5e-6);
      }
    }
  }
}

TEST_F(MlpPolicyTest, HasNoMemory) {
  const PolicyInterface interface = large_interface();
  const MlpNetwork network = random_network(interface, {64, 32});
  const auto policy = make(network, interface), other = make(network, interface);
  const std::vector<double> a(69, 0.3), b(69, -0.7);
  const std::vector<double> first = act_on(*policy, a);
  (void)act_on(*policy, b);
  policy->reset(5);
  EXPECT_EQ(act_on(*policy, a), first);
  EXPECT_EQ(act_on(*other, a), first);
  EXPECT_EQ(policy->name(), "p.safetensors");
}

TEST_F(MlpPolicyTest, AnObservationThatIsNoNumberGivesZeros) {
  using test::kInfinity;
  MlpNetwork network = tiny_network();
  for (const MlpActivation activation : {MlpActivation::kTanh, MlpActivation::kElu, MlpActivation::kRelu}) {
    network.activation = activation;
    const auto policy = make(network);
    for (const double bad : {std::nan(""), kInfinity, -kInfinity, 1e300}) {
      EXPECT_EQ(act_on(*policy, {bad, 0})[0], 0) << bad;
      EXPECT_EQ(act_on(*policy, {0, bad})[0], 0) << bad;
    }
    EXPECT_NE(act_on(*policy, {0, 0})[0], 0);  // and nothing of it stays
  }
  network.observation_clip = 2;
  const auto policy = make(network);
  EXPECT_EQ(act_on(*policy, {kInfinity, 0}), act_on(*policy, {2, 0}));
  EXPECT_EQ(act_on(*policy, {std::nan(""), 0})[0], 0);
}

TEST_F(MlpPolicyTest, SaysWhatDiffersInAnotherLayout) {
  write_policy_bundle(path("p.safetensors"), random_network(small_interface(), {8}), small_interface());
  PolicyInterface other = small_interface();
  other.observation.entries.erase(other.observation.entries.begin() + 1);
  EXPECT_EQ(error_for(other),
            "observation: expected the environment's entries, found a policy whose observation has 4 entries "
            "where 3 "
            "were expected; entry 1 is param.step_height, expected terrain.front");
  other = small_interface();
  other.action.entries[3].name = "residual.FL.y";
  EXPECT_EQ(
      error_for(other),
      "action: expected the environment's entries, found a policy whose action entry 3 is residual.FL.z, "
      "expected residual.FL.y");
  other = small_interface();
  other.observation.entries[0].unit = "m";
  const std::string message = error_for(other);
  EXPECT_EQ(message, "layout_hash: expected " + layout_hash(other.observation, other.action) + ", found " +
                         layout_hash(small_interface().observation, small_interface().action) +
                         ": names agree, so units of some entries differ, or the hash is not that of "
                         "docs/policies.md");
  other = small_interface();
  other.policy_dt = 0.02;
  EXPECT_EQ(error_for(other),
            "policy_dt: expected 0.02 s, the environment's, found a policy trained for 0.002 s");
}

TEST_F(MlpPolicyTest, RefusesBundlesOfAnotherLayoutVersion) {
  const std::string expected = "layout_version: expected 3 (ranges of gaits that step), found ";
  EXPECT_EQ(error_after([](TensorFile& file) { EXPECT_EQ(file.metadata.erase("layout_version"), 1U); }),
            expected + "none, which means 1: trained for leg frames with z down");
  EXPECT_EQ(error_after(with_metadata("layout_version", "1")),
            expected + "1: trained for leg frames with z down");
  EXPECT_EQ(error_after(with_metadata("layout_version", "2")),
            expected + "2: trained for the guide's ranges of parameters");
  for (const std::string other : {"4", "0", "", "2.0", "two"}) {
    EXPECT_EQ(error_after(with_metadata("layout_version", other)),
              expected + "'" + other + "', which is not known here");
  }
}

TEST_F(MlpPolicyTest, RefusesIncompleteAndContradictoryBundles) {
  const auto erased = [](const char* name) {
    return [name](TensorFile& file) { EXPECT_EQ(file.tensors.erase(name) + file.metadata.erase(name), 1U); };
  };
  for (const char* key :
       {"format", "activation", "output", "layout_hash", "observation_names", "action_names"}) {
    EXPECT_EQ(error_after(erased(key)),
              std::string(key) + ": expected metadata of a policy bundle, found none");
  }
  for (const char* name : {"observation.mean", "observation.std", "layer.0.weight", "layer.0.bias",
                           "layer.2.bias", "golden.observation", "golden.action"}) {
    EXPECT_EQ(error_after(erased(name)), std::string(name) + ": expected this tensor, found none");
  }
  EXPECT_EQ(error_after(erased("layer.1.weight")), "layer.0.weight: expected shape [4, 4], found [8, 4]");
  EXPECT_EQ(error_after(erased("layer.2.weight")),
            "layer.2.bias: expected no further tensor, found an unknown one");
  EXPECT_EQ(error_after(with_metadata("format", "crossgait-policy-2")),
            "format: expected crossgait-policy-1, found 'crossgait-policy-2'");
  EXPECT_EQ(error_after(with_metadata("activation", "gelu")),
            "activation: expected tanh, elu, relu, swish, silu, softsign, found 'gelu'");
  EXPECT_EQ(error_after(with_metadata("output", "relu")), "output: expected linear, tanh, found 'relu'");
  EXPECT_EQ(error_after(with_metadata("observation_clip", "0")),
            "observation_clip: expected a positive number, found '0'");
  EXPECT_EQ(error_after(with_metadata("policy_dt", "fast")),
            "policy_dt: expected a positive number, found 'fast'");
  EXPECT_EQ(error_after(with_metadata("action_names", "[1]")),
            "action_names: expected a JSON list of names, found '[1]'");
  EXPECT_EQ(error_after(with_metadata("action_names", "[")),
            "action_names: expected a JSON list of names, found '['");
  EXPECT_EQ(error_after(with_metadata("author", "me")),
            "author: expected no further metadata, found an unknown key");
}

TEST_F(MlpPolicyTest, RefusesWrongShapesAndNumbers) {
  const auto set = [](const char* name, double value) {
    return [name, value](TensorFile& file) { file.tensors.at(name).values.at(3) = value; };
  };
  EXPECT_EQ(error_after(set("layer.1.weight", std::nan(""))),
            "layer.1.weight: expected finite numbers, found nan at 3");
  EXPECT_EQ(error_after(set("golden.action", HUGE_VAL)),
            "golden.action: expected finite numbers, found inf at 3");
  EXPECT_EQ(error_after(set("observation.std", 0)), "observation.std: expected positive numbers, found 0");
  const auto shaped = [](const char* name, const std::vector<std::size_t>& shape) {
    return [name, shape](TensorFile& file) {
      std::size_t count = 1;
      for (const std::size_t size : shape) count *= size;
      file.tensors.at(name) = {Tensor::Kind::kF32, shape, std::vector<double>(count, 1)};
    };
  };
  EXPECT_EQ(error_after(shaped("layer.0.weight", {8, 5})),
            "layer.0.weight: expected shape [n, 4], found [8, 5]");
  EXPECT_EQ(error_after(shaped("layer.0.weight", {32})), "layer.0.weight: expected shape [n, 4], found [32]");
  EXPECT_EQ(error_after(shaped("layer.0.weight", {0, 4})),
            "layer.0.weight: expected shape [n, 4], found [0, 4]");
  EXPECT_EQ(error_after(shaped("layer.0.bias", {7})), "layer.0.bias: expected shape [8], found [7]");
  EXPECT_EQ(error_after(shaped("layer.2.weight", {3, 4})),
            "layer.2.weight: expected shape [4, 4], found [3, 4]");
  EXPECT_EQ(error_after(shaped("golden.observation", {0, 4})),
            "golden.observation: expected shape [n, 4], found [0, 4]");
  // Every row runs the network when the bundle is read.
  EXPECT_EQ(error_after(shaped("golden.observation", {257, 4})),
            "golden.observation: expected at most 256 rows, found 257");
  EXPECT_EQ(error_after(shaped("golden.action", {7, 4})),
            "golden.action: expected shape [8, 4], found [7, 4]");
  EXPECT_EQ(error_after([](TensorFile& file) {
              for (const char* name : {"layer.0.weight", "layer.0.bias"}) {
                Tensor& tensor = file.tensors.at(name);
                tensor.kind = Tensor::Kind::kF64;
                for (double& value : tensor.values) value *= 1e300;
              }
            }),
            "layers: expected weights and biases in the range of single precision, found larger ones");
}

TEST_F(MlpPolicyTest, RefusesANetworkThatDoesNotDoWhatItsWriterDid) {
  const std::vector<Change> changes{
      with_metadata("activation", "elu"),
      with_metadata("output", "tanh"),
      with_metadata("observation_clip", "9"),
      [](TensorFile& file) { file.metadata.erase("observation_clip"); },
      [](TensorFile& file) { file.tensors.at("layer.1.weight").values[5] += 0.01; },
      [](TensorFile& file) { file.tensors.at("observation.mean").values[2] += 0.01; },
      [](TensorFile& file) {
        file.tensors.erase("observation.mean");
        file.tensors.erase("observation.std");
      },
      [](TensorFile& file) { file.tensors.at("golden.action").values[31] += 2e-5; }};
  for (std::size_t i = 0; i < changes.size(); ++i) {
    const std::string message = error_after(changes[i]);
    EXPECT_EQ(message.rfind("golden.action [", 0), 0U) << i << ": " << message;
  }
}

TEST_F(MlpPolicyTest, GoldenActionsBeyondTheLimitsCountAsAtThem) {
  write_policy_bundle(path("p.safetensors"), tiny_network(), tiny_interface());
  TensorFile file = read_safetensors(path("p.safetensors"));
  file.tensors.at("layer.1.bias").values[0] = 5;
  for (double& value : file.tensors.at("golden.action").values) value = 4.95 + value;
  write_safetensors(path("p.safetensors"), file);
  EXPECT_NO_THROW((void)make_policy(path("p.safetensors"), tiny_interface()));
}

TEST_F(MlpPolicyTest, BundlesAreWrittenAsTheyAreRead) {
  write_policy_bundle(path("p.safetensors"), random_network(small_interface(), {8, 4}), small_interface());
  PolicyBundle bundle = read_policy_bundle(path("p.safetensors"));
  write_policy_bundle(path("q.safetensors"), bundle);
  EXPECT_EQ(read_safetensors(path("q.safetensors")), read_safetensors(path("p.safetensors")));
  bundle.policy_dt.reset();
  write_policy_bundle(path("q.safetensors"), bundle);
  EXPECT_FALSE(read_policy_bundle(path("q.safetensors")).policy_dt);
}

TEST_F(MlpPolicyTest, ABundleInMemoryIsAPolicyOfTheNameOfItsSource) {
  const PolicyBundle bundle = make_policy_bundle(tiny_network(), tiny_interface(), "somewhere/net.onnx");
  MlpPolicy policy(bundle, "somewhere/net.onnx", tiny_interface());
  EXPECT_EQ(policy.name(), "net.onnx");
  EXPECT_EQ(act_on(policy, {0.2, 0.6}), act_on(*make(tiny_network()), {0.2, 0.6}));
}

TEST_F(MlpPolicyTest, GoldenPairsMayBeGiven) {
  const PolicyBundle own = make_policy_bundle(tiny_network(), tiny_interface(), "p");
  const Eigen::MatrixXd observation = Eigen::MatrixXd::Constant(3, 2, 0.25);
  const Eigen::MatrixXd action = own.network.evaluate(observation.row(0)).replicate(3, 1);
  write_policy_bundle(path("p.safetensors"), with_golden_pairs(own, observation, action, "p"));
  const PolicyBundle read = read_policy_bundle(path("p.safetensors"));
  EXPECT_EQ(read.golden_observation, observation);
  EXPECT_EQ(read.golden_action, action);
  EXPECT_NO_THROW((void)make_policy(path("p.safetensors"), tiny_interface()));
}

TEST_F(MlpPolicyTest, RefusesGoldenPairsThatDoNotFit) {
  const PolicyBundle own = make_policy_bundle(tiny_network(), tiny_interface(), "p");
  const auto error_of = [&](const Eigen::MatrixXd& observation, const Eigen::MatrixXd& action) {
    return std::string(config_error([&] { (void)with_golden_pairs(own, observation, action, "p"); }).what());
  };
  const auto zeros = [](int rows, int columns) { return Eigen::MatrixXd::Zero(rows, columns).eval(); };
  EXPECT_EQ(error_of(zeros(0, 2), zeros(0, 1)), "p: golden pairs: expected 1 to 256, found 0");
  EXPECT_EQ(error_of(zeros(257, 2), zeros(257, 1)), "p: golden pairs: expected 1 to 256, found 257");
  EXPECT_EQ(error_of(zeros(3, 1), zeros(3, 1)), "p: golden.observation: expected shape [3, 2], found [3, 1]");
  EXPECT_EQ(error_of(zeros(3, 2), zeros(2, 1)), "p: golden.action: expected shape [3, 1], found [2, 1]");
  EXPECT_EQ(error_of(zeros(3, 2), Eigen::MatrixXd::Constant(3, 1, std::nan(""))),
            "p: golden.action: expected finite numbers, found others");
}

TEST_F(MlpPolicyTest, RefusesToWriteANetworkThatDoesNotFit) {
  const auto error_of = [&](const MlpNetwork& network) {
    const std::string file = path("p");
    const ConfigError error = config_error([&] { write_policy_bundle(file, network, tiny_interface()); });
    return std::string(error.what()).substr(file.size() - 1);
  };
  EXPECT_EQ(error_of({}), "p: layers: expected at least one, found none");
  MlpNetwork network = tiny_network();
  network.layers[1].weight.setZero(1, 3);
  EXPECT_EQ(error_of(network), "p: columns of a layer's weight: expected 2, found 3");
  network = tiny_network();
  network.layers.pop_back();
  EXPECT_EQ(error_of(network), "p: outputs: expected 1, found 2");
  network = tiny_network();
  network.observation_mean = Eigen::Vector2d(0, 0);
  EXPECT_EQ(error_of(network), "p: size of observation_std: expected 2, found 0");
  network.observation_std = Eigen::Vector2d(1, 0);
  EXPECT_EQ(error_of(network),
            "p: observation_std and observation_clip: expected positive numbers, found others");
  network.observation_std = Eigen::Vector2d(1, 1);
  network.observation_clip = std::nan("");
  EXPECT_EQ(error_of(network),
            "p: observation_std and observation_clip: expected positive numbers, found others");
  network = tiny_network();
  network.layers[0].weight(1, 1) = 1e39;  // no float
  EXPECT_EQ(error_of(network), "p: weights, biases and means: expected finite numbers, found others");
  EXPECT_FALSE(std::filesystem::exists(path("p")));
}

TEST_F(MlpPolicyTest, DamagedFilesAreRefusedOrDoTheSame) {
  const PolicyInterface interface = small_interface();
  const auto policy = make(random_network(interface, {8, 4}), interface);
  const PolicyBundle bundle = read_policy_bundle(path("p.safetensors"));
  const std::string bytes = read(path("p.safetensors"));
  const std::size_t header =
      8 + static_cast<unsigned char>(bytes[0]) + 256U * static_cast<unsigned char>(bytes[1]);
  for (std::size_t size = 0; size <= header; ++size) {
    const std::string file = write("damaged.safetensors", std::string_view(bytes).substr(0, size));
    EXPECT_THROW((void)make_policy(file, interface), ConfigError) << size;
  }
  Random random(1);
  int refused = 0;
  constexpr int kFlips = 3000;
  for (int i = 0; i < kFlips; ++i) {
    std::string flipped = bytes;
    const auto bit = static_cast<std::size_t>(random.uniform() * 8 * static_cast<double>(bytes.size()));
    flipped[bit / 8] = static_cast<char>(flipped[bit / 8] ^ 1 << bit % 8);
    try {
      const auto damaged = make_policy(write("damaged.safetensors", flipped), interface);
      for (Eigen::Index row = 0; row < bundle.golden_observation.rows(); ++row) {
        const Eigen::VectorXd golden = bundle.golden_observation.row(row);
        const std::vector<double> observation(golden.begin(), golden.end());
        const std::vector<double> expected = act_on(*policy, observation),
                                  action = act_on(*damaged, observation);
        // Flipped low bits of numbers: within twice the tolerance of golden pairs, they being flipped or not.
        for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(action[k], expected[k], 2e-5) << bit;
      }
    } catch (const ConfigError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, kFlips / 4);
}

}  // namespace
}  // namespace crossgait
