#include "policy/relabelled_policy.h"

#include <filesystem>

#include "physics/core/yaml_reader.h"
#include "policy/bundled_policies.h"
#include "policy/mlp_policy.h"
#include "policy/onnx_policy.h"

namespace crossgait {
namespace {

RelabelledPolicy of_bundle(const std::string& file) {
  const PolicyBundle bundle = read_policy_bundle(file);
  const MlpNetwork& network = bundle.network;
  return {[network, file](const PolicyInterface& interface) {
            return std::make_unique<MlpPolicy>(make_policy_bundle(network, interface, file), file, interface);
          },
          bundle.layout_hash, bundle.policy_dt, network.observation_mean, network.observation_std};
}

RelabelledPolicy of_onnx(const YamlValue& root) {
  RelabelledPolicy policy;
  policy.make = load_relabelled_onnx_policy(root);
  if (const auto hash = root.find("layout_hash")) policy.layout_hash = hash->text();
  if (const auto dt = root.find("policy_dt")) policy.policy_dt = dt->number();
  return policy;
}

}  // namespace

RelabelledPolicy read_relabelled_policy(const std::string& text) {
  const std::string file = find_policy_file(text), extension = std::filesystem::path(file).extension();
  if (extension == ".safetensors") return of_bundle(file);
  if (extension == ".yaml") {
    const YamlValue root = YamlValue::load(file);
    if (root.at("kind").text() == "onnx") return of_onnx(root);
  }
  return {load_policy(text), {}, {}, {}, {}};
}

}  // namespace crossgait
