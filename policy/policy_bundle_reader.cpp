#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "physics/core/error.h"
#include "physics/core/text.h"
#include "policy/policy_bundle.h"
#include "policy/policy_bundle_names.h"
#include "policy/safetensors.h"

namespace crossgait {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Eigen::Index to_index(std::size_t size) { return static_cast<Eigen::Index>(size); }

/// Takes entries out of the file one by one, so that what is left over was not expected.
class BundleReader {
 public:
  explicit BundleReader(const std::string& path) : path_(path), file_(read_safetensors(path)) {}

  PolicyBundle read() {
    PolicyBundle bundle;
    const std::string format = text("format");
    if (format != bundle_names::kFormat) fail("format", std::string(bundle_names::kFormat), quoted(format));
    check_layout_version();
    bundle.layout_hash = text("layout_hash");
    bundle.observation_names = names("observation_names");
    bundle.action_names = names("action_names");
    if (file_.metadata.contains("policy_dt")) bundle.policy_dt = positive_number("policy_dt");
    MlpNetwork& network = bundle.network;
    network.activation = choice("activation", bundle_names::kActivations);
    network.output = choice("output", bundle_names::kOutputs);
    if (file_.metadata.contains("observation_clip")) {
      network.observation_clip = positive_number("observation_clip");
    }
    const std::size_t inputs = bundle.observation_names.size(), outputs = bundle.action_names.size();
    read_normalisation(network, inputs);
    read_layers(network, inputs, outputs);
    read_golden(bundle, inputs, outputs);
    if (!file_.tensors.empty()) fail(file_.tensors.begin()->first, "no further tensor", "an unknown one");
    if (!file_.metadata.empty()) fail(file_.metadata.begin()->first, "no further metadata", "an unknown key");
    return bundle;
  }

 private:
  [[noreturn]] void fail(std::string_view element, std::string_view expected, std::string_view found) const {
    throw ConfigError(path_, element, expected, found);
  }

  /// Before anything is made of names, which are the same in all versions.
  void check_layout_version() {
    const auto entry = file_.metadata.extract("layout_version");
    const auto stated = entry ? std::optional(entry.mapped()) : std::nullopt;
    if (const auto error = layout_version_error(stated, "trained")) {
      fail("layout_version", layout_version_in_words(), *error);
    }
  }

  static std::string quoted(std::string_view text) { return fmt::format("'{}'", text); }

  std::string text(const std::string& key) {
    const auto entry = file_.metadata.extract(key);
    if (!entry) fail(key, "metadata of a policy bundle", "none");
    return entry.mapped();
  }

  double positive_number(const std::string& key) {
    const std::string found = text(key);
    const auto number = parse_number(found);
    if (!number || *number <= 0) fail(key, "a positive number", quoted(found));
    return *number;
  }

  template <typename Value, std::size_t size>
  Value choice(const std::string& key, const std::array<std::pair<std::string_view, Value>, size>& table) {
    const std::string found = text(key);
    std::vector<std::string_view> known;
    for (const auto& [name, value] : table) {
      if (name == found) return value;
      known.push_back(name);
    }
    fail(key, fmt::format("{}", fmt::join(known, ", ")), quoted(found));
  }

  std::vector<std::string> names(const std::string& key) {
    const std::string found = text(key);
    check_json_budget(found, kPolicyBudget, fmt::format("{}: {}", path_, key));
    const nlohmann::json list = nlohmann::json::parse(found, nullptr, false);
    const auto is_text = [](const nlohmann::json& item) { return item.is_string(); };
    if (!list.is_array() || list.empty() || !std::all_of(list.begin(), list.end(), is_text)) {
      fail(key, "a JSON list of names", quoted(found));
    }
    return list.get<std::vector<std::string>>();
  }

  /// @param shape  0 stands for any size of 1 or more
  Tensor tensor(const std::string& name, const std::vector<std::size_t>& shape) {
    auto entry = file_.tensors.extract(name);
    if (!entry) fail(name, "this tensor", "none");
    Tensor& found = entry.mapped();
    const auto fits = [](std::size_t size, std::size_t wanted) {
      return wanted == 0 ? size > 0 : size == wanted;
    };
    if (!std::equal(found.shape.begin(), found.shape.end(), shape.begin(), shape.end(), fits)) {
      std::vector<std::string> sizes;
      for (const std::size_t size : shape) sizes.push_back(size == 0 ? "n" : std::to_string(size));
      fail(name, fmt::format("shape [{}]", fmt::join(sizes, ", ")), describe_shape(found.shape));
    }
    const auto bad =
        std::find_if_not(found.values.begin(), found.values.end(), [](double v) { return std::isfinite(v); });
    if (bad != found.values.end()) {
      fail(name, "finite numbers", fmt::format("{} at {}", *bad, bad - found.values.begin()));
    }
    return std::move(found);
  }

  Eigen::VectorXd vector(const std::string& name, std::size_t size) {
    const Tensor found = tensor(name, {size});
    return Eigen::Map<const Eigen::VectorXd>(found.values.data(), to_index(found.values.size()));
  }

  Eigen::MatrixXd matrix(const std::string& name, std::size_t rows, std::size_t columns) {
    const Tensor found = tensor(name, {rows, columns});
    return Eigen::Map<const RowMajor>(found.values.data(), to_index(found.shape[0]),
                                      to_index(found.shape[1]));
  }

  void read_normalisation(MlpNetwork& network, std::size_t inputs) {
    if (!file_.tensors.contains("observation.mean") && !file_.tensors.contains("observation.std")) return;
    network.observation_mean = vector("observation.mean", inputs);
    network.observation_std = vector("observation.std", inputs);
    if (network.observation_std.minCoeff() <= 0) {
      fail("observation.std", "positive numbers", fmt::format("{:g}", network.observation_std.minCoeff()));
    }
  }

  void read_layers(MlpNetwork& network, std::size_t inputs, std::size_t outputs) {
    const auto weight_name = [](std::size_t k) { return fmt::format("layer.{}.weight", k); };
    std::size_t width = inputs;
    do {
      const std::size_t k = network.layers.size();
      const bool last = !file_.tensors.contains(weight_name(k + 1));
      MlpLayer layer;
      layer.weight = matrix(weight_name(k), last ? outputs : 0, width);
      width = static_cast<std::size_t>(layer.weight.rows());
      layer.bias = vector(fmt::format("layer.{}.bias", k), width);
      network.layers.push_back(std::move(layer));
    } while (file_.tensors.contains(weight_name(network.layers.size())));
  }

  void read_golden(PolicyBundle& bundle, std::size_t inputs, std::size_t outputs) {
    bundle.golden_observation = matrix("golden.observation", 0, inputs);
    const auto pairs = static_cast<std::size_t>(bundle.golden_observation.rows());
    if (pairs > kMaxGoldenPairs) {
      fail("golden.observation", fmt::format("at most {} rows", kMaxGoldenPairs), std::to_string(pairs));
    }
    bundle.golden_action = matrix("golden.action", pairs, outputs);
  }

  const std::string& path_;
  TensorFile file_;
};

void check_names(const std::string& path, std::string_view element, const std::vector<std::string>& expected,
                 const std::vector<std::string>& found) {
  const std::string difference = layout_difference(expected, found);
  if (!difference.empty()) {
    throw ConfigError(path, element, "the environment's entries",
                      fmt::format("a policy whose {} {}", element, difference));
  }
}

}  // namespace

PolicyBundle read_policy_bundle(const std::string& path) { return BundleReader(path).read(); }

void check_interface(const PolicyBundle& bundle, const PolicyInterface& interface, const std::string& path) {
  check_names(path, "observation", interface.observation.names(), bundle.observation_names);
  check_names(path, "action", interface.action.names(), bundle.action_names);
  const std::string hash = layout_hash(interface.observation, interface.action);
  if (bundle.layout_hash != hash) {
    throw ConfigError(path, "layout_hash", hash,
                      fmt::format("{}: names agree, so units of some entries differ, or the hash is not "
                                  "that of docs/policies.md",
                                  bundle.layout_hash));
  }
  constexpr double kRounding = 1e-9;  // relative; of a number that was written as decimal text
  if (bundle.policy_dt &&
      std::abs(*bundle.policy_dt - interface.policy_dt) > kRounding * interface.policy_dt) {
    throw ConfigError(path, "policy_dt", fmt::format("{:g} s, the environment's", interface.policy_dt),
                      fmt::format("a policy trained for {:g} s", *bundle.policy_dt));
  }
}

}  // namespace crossgait
