#include "policy/policy.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "physics/core/error.h"
#include "physics/core/yaml_reader.h"
#include "policy/bundled_policies.h"
#include "policy/hierarchical_policy.h"
#include "policy/mlp_policy.h"
#include "policy/onnx_policy.h"
#include "policy/scripted_policy.h"
#include "policy/simple_policies.h"

namespace crossgait {
namespace {

/// Descriptions name entries of layouts, and names do not tell what changed with a version.
void check_layout_version(const YamlValue& root) {
  constexpr std::string_view kKey = "layout_version";
  const auto value = root.find(kKey);
  const auto stated = value ? std::optional(value->text()) : std::nullopt;
  const auto error = layout_version_error(stated, "written");
  if (!error) return;
  if (value) value->fail(layout_version_in_words(), *error);
  throw ConfigError(root.source(), kKey, layout_version_in_words(), *error);
}

PolicyFactory load_described(const std::string& path) {
  const YamlValue root = YamlValue::load(path);
  const YamlValue kind = root.at("kind");
  constexpr std::array kKinds{
      std::pair{std::string_view("scripted"), &load_scripted_policy},
      std::pair{std::string_view("hierarchical"), &load_hierarchical_policy},
      std::pair{std::string_view("onnx"), &load_onnx_policy},
  };
  for (const auto& [name, load] : kKinds) {
    if (kind.text() != name) continue;
    check_layout_version(root);
    return load(root);
  }
  kind.fail("scripted, hierarchical or onnx", "'" + kind.text() + "'");
}

}  // namespace

Policy::Policy(std::string name, PolicyInterface interface)
    : name_(std::move(name)), interface_(std::move(interface)), clipped_(interface_.action.size(), 0) {}

void Policy::reset(std::uint64_t seed) noexcept {
  std::fill(clipped_.begin(), clipped_.end(), 0);
  do_reset(seed);
}

void Policy::act(std::span<const double> observation, std::span<double> action) noexcept {
  const bool fits =
      observation.size() == interface_.observation.size() && action.size() == interface_.action.size();
  assert(fits && "spans of the interface's sizes");
  if (!fits) {
    std::fill(action.begin(), action.end(), 0.0);
    return;
  }
  do_act(observation, action);
  for (std::size_t i = 0; i < action.size(); ++i) {
    const LayoutEntry& entry = interface_.action.entries[i];
    const double asked = std::isfinite(action[i]) ? action[i] : 0;
    action[i] = std::clamp(asked, entry.min, entry.max);
    clipped_[i] += action[i] == asked ? 0 : 1;
  }
}

PolicyFactory load_policy(const std::string& text) {
  if (text == "zero") return std::make_unique<ZeroPolicy, const PolicyInterface&>;
  if (text == "random") return std::make_unique<RandomPolicy, const PolicyInterface&>;
  const std::string file = find_policy_file(text);
  const std::string extension = std::filesystem::path(file).extension();
  if (extension == ".safetensors") return load_mlp_policy(file);
  if (extension == ".yaml") return load_described(file);
  for (const std::string_view foreign : {".onnx", ".pt", ".pth", ".zip"}) {
    if (extension == foreign)
      throw ConfigError(
          file, "policy",
          "FILE.safetensors: `crossgait import` makes a folder with one of a network (in Python "
          "import_policy, or Policy.from_onnx and the like)",
          extension);
  }
  std::vector<std::string> known{"zero", "random"};
  for (std::string& name : policy_names()) known.push_back(std::move(name));
  throw ConfigError("policy", text, fmt::format("{}, FILE.safetensors or FILE.yaml", fmt::join(known, ", ")),
                    "none of these");
}

std::unique_ptr<Policy> make_policy(const std::string& text, const PolicyInterface& interface) {
  return load_policy(text)(interface);
}

}  // namespace crossgait
