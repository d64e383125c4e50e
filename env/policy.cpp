#include "crossgait/env/policy.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <filesystem>

#include "crossgait/env/hierarchical_policy.h"
#include "crossgait/env/mlp_policy.h"
#include "crossgait/env/scripted_policy.h"
#include "crossgait/env/simple_policies.h"
#include "crossgait/physics/error.h"
#include "crossgait/physics/yaml_reader.h"

namespace crossgait {
namespace {

std::unique_ptr<Policy> make_described(const std::string& path, const PolicyInterface& interface) {
  const YamlValue root = YamlValue::load(path);
  const YamlValue kind = root.at("kind");
  if (kind.text() == "scripted") return make_scripted_policy(root, interface);
  if (kind.text() == "hierarchical") return make_hierarchical_policy(root, interface);
  kind.fail("scripted or hierarchical", "'" + kind.text() + "'");
}

}  // namespace

Policy::Policy(std::string name, PolicyInterface interface)
    : name_(std::move(name)), interface_(std::move(interface)) {}

void Policy::act(std::span<const double> observation, std::span<double> action) noexcept {
  const bool fits =
      observation.size() == interface_.observation.size() && action.size() == interface_.action.size();
  assert(fits && "spans of the interface's sizes");
  if (!fits) {
    std::fill(action.begin(), action.end(), 0.0);
    return;
  }
  do_act(observation, action);
  for (double& value : action) value = std::isfinite(value) ? std::clamp(value, -1.0, 1.0) : 0;
}

std::unique_ptr<Policy> make_policy(const std::string& text, const PolicyInterface& interface) {
  if (text == "zero") return std::make_unique<ZeroPolicy>(interface);
  if (text == "random") return std::make_unique<RandomPolicy>(interface);
  const std::string extension = std::filesystem::path(text).extension();
  if (extension == ".safetensors") return std::make_unique<MlpPolicy>(text, interface);
  if (extension == ".yaml") return make_described(text, interface);
  throw ConfigError("policy", text, "zero, random, FILE.safetensors or FILE.yaml", "none of these");
}

}  // namespace crossgait
