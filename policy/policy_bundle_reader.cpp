#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "physics/core/error.h"
#include "physics/core/read_budget.h"
#include "policy/policy_bundle.h"
#include "policy/policy_bundle_names.h"
#include "policy/tensor_reader.h"

namespace crossgait {
namespace {

class BundleReader : private TensorReader {
 public:
  explicit BundleReader(const std::string& path) : TensorReader(path, "a policy bundle") {}

  PolicyBundle read() {
    PolicyBundle bundle;
    check_format(bundle_names::kFormat);
    check_layout_version();
    bundle.layout_hash = text("layout_hash");
    bundle.observation_names = names("observation_names");
    bundle.action_names = names("action_names");
    if (has_text("policy_dt")) bundle.policy_dt = positive_number("policy_dt");
    MlpNetwork& network = bundle.network;
    network.activation = choice("activation", bundle_names::kActivations);
    network.output = choice("output", bundle_names::kOutputs);
    if (has_text("observation_clip")) {
      network.observation_clip = positive_number("observation_clip");
    }
    const std::size_t inputs = bundle.observation_names.size(), outputs = bundle.action_names.size();
    read_normalisation(network, inputs);
    read_layers(network, inputs, outputs);
    read_golden(bundle, inputs, outputs);
    check_all_read();
    return bundle;
  }

 private:
  /// Before anything is made of names, which are the same in all versions.
  void check_layout_version() {
    const std::optional<std::string> stated = find_text("layout_version");
    if (const auto error = layout_version_error(stated, "trained")) {
      fail("layout_version", layout_version_in_words(), *error);
    }
  }

  std::vector<std::string> names(const std::string& key) {
    const std::string found = text(key);
    check_json_budget(found, kPolicyBudget, fmt::format("{}: {}", path(), key));
    const nlohmann::json list = nlohmann::json::parse(found, nullptr, false);
    const auto is_text = [](const nlohmann::json& item) { return item.is_string(); };
    if (!list.is_array() || list.empty() || !std::all_of(list.begin(), list.end(), is_text)) {
      fail(key, "a JSON list of names", fmt::format("'{}'", found));
    }
    return list.get<std::vector<std::string>>();
  }

  void read_normalisation(MlpNetwork& network, std::size_t inputs) {
    if (!has_tensor("observation.mean") && !has_tensor("observation.std")) return;
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
      const bool last = !has_tensor(weight_name(k + 1));
      MlpLayer layer;
      layer.weight = matrix(weight_name(k), last ? outputs : 0, width);
      width = static_cast<std::size_t>(layer.weight.rows());
      layer.bias = vector(fmt::format("layer.{}.bias", k), width);
      network.layers.push_back(std::move(layer));
    } while (has_tensor(weight_name(network.layers.size())));
  }

  void read_golden(PolicyBundle& bundle, std::size_t inputs, std::size_t outputs) {
    bundle.golden_observation = matrix("golden.observation", 0, inputs);
    const auto pairs = static_cast<std::size_t>(bundle.golden_observation.rows());
    if (pairs > kMaxGoldenPairs) {
      fail("golden.observation", fmt::format("at most {} rows", kMaxGoldenPairs), std::to_string(pairs));
    }
    bundle.golden_action = matrix("golden.action", pairs, outputs);
  }
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
