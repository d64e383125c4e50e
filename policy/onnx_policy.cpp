#include "policy/onnx_policy.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "physics/core/error.h"
#include "physics/core/yaml_reader.h"

namespace crossgait {
namespace {

std::vector<std::string> names_of(const std::vector<OnnxTensor>& tensors) {
  std::vector<std::string> names;
  for (const OnnxTensor& tensor : tensors) names.push_back(tensor.name);
  return names;
}

// @param kind  "observation", "memory"
std::size_t index_of(const std::vector<OnnxTensor>& tensors, const std::string& name, std::string_view kind,
                     const std::string& source) {
  const auto it = std::find_if(tensors.begin(), tensors.end(),
                               [&](const OnnxTensor& tensor) { return tensor.name == name; });
  if (it == tensors.end())
    throw ConfigError(source, kind, fmt::format("one of {}", fmt::join(names_of(tensors), ", ")),
                      fmt::format("'{}'", name));
  return static_cast<std::size_t>(it - tensors.begin());
}

void check_size(const OnnxTensor& tensor, std::size_t size, std::string_view what,
                const std::string& source) {
  if (tensor.size() == size) return;
  throw ConfigError(source, fmt::format("{} of the network", tensor.name),
                    fmt::format("{} numbers, as {}", size, what),
                    fmt::format("{} ([{}])", tensor.size(), fmt::join(tensor.shape, ", ")));
}

}  // namespace

OnnxPolicy::OnnxPolicy(std::shared_ptr<const OnnxNetwork> network, const OnnxPolicyPorts& ports,
                       const std::string& source, const PolicyInterface& interface)
    : Policy(std::filesystem::path(source).filename(), interface), run_(std::move(network)) {
  const auto &inputs = run_.network().inputs(), &outputs = run_.network().outputs();
  observation_ = index_of(inputs, ports.observation, "observation", source);
  action_ = index_of(outputs, ports.action, "action", source);
  check_size(inputs[observation_], interface.observation.size(), "the environment's observation", source);
  check_size(outputs[action_], interface.action.size(), "the environment's action", source);
  std::vector<bool> given(inputs.size());
  given[observation_] = true;
  for (const auto& [in, out] : ports.memory) {
    memory_.emplace_back(index_of(inputs, in, "memory", source), index_of(outputs, out, "memory", source));
    const auto& [input, output] = memory_.back();
    check_size(outputs[output], inputs[input].size(), fmt::format("its input {}", in), source);
    given[input] = true;
  }
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    if (!given[i])
      throw ConfigError(source, "memory", "every input that is not the observation, with its output",
                        fmt::format("nothing about {}", inputs[i].name));
  }
  std::string problem;
  if (!run_.compute(&problem))
    throw ConfigError(source, "network", "one that ONNX Runtime computes", problem);
}

void OnnxPolicy::do_reset(std::uint64_t /*seed*/) noexcept {
  for (const auto& [input, output] : memory_) std::ranges::fill(run_.input(input), 0.0F);
}

void OnnxPolicy::do_act(std::span<const double> observation, std::span<double> action) noexcept {
  const std::span<float> in = run_.input(observation_);
  std::transform(observation.begin(), observation.end(), in.begin(),
                 [](double value) { return static_cast<float>(value); });
  const bool finite = std::all_of(in.begin(), in.end(), [](float value) { return std::isfinite(value); });
  if (!finite || !run_.compute()) {
    std::fill(action.begin(), action.end(), 0.0);
    return;
  }
  std::ranges::copy(run_.output(action_), action.begin());
  for (const auto& [input, output] : memory_)
    std::ranges::copy(run_.output(output), run_.input(input).begin());
}

namespace {

void check_onnx_interface(const YamlValue& root, const PolicyInterface& interface) {
  const YamlValue hash = root.at("layout_hash");
  const std::string expected = layout_hash(interface.observation, interface.action);
  if (hash.text() != expected)
    hash.fail(fmt::format("{}, the layout of this environment (`crossgait env --describe`)", expected),
              hash.text());
  if (const auto dt = root.find("policy_dt"); dt && std::abs(dt->number() - interface.policy_dt) > 1e-9)
    dt->fail(fmt::format("the environment's {:g} s between two actions", interface.policy_dt),
             fmt::format("{:g} s", dt->number()));
}

}  // namespace

PolicyFactory load_onnx_policy(const YamlValue& root) {
  return [root, make = load_relabelled_onnx_policy(root)](const PolicyInterface& interface) {
    check_onnx_interface(root, interface);
    return make(interface);
  };
}

PolicyFactory load_relabelled_onnx_policy(const YamlValue& root) {
  root.allow_keys(
      {"kind", "layout_version", "layout_hash", "policy_dt", "network", "observation", "action", "memory"});
  OnnxPolicyPorts ports{root.at("observation").text(), root.at("action").text(), {}};
  if (const auto memory = root.find("memory")) {
    for (const auto& [input, output] : memory->entries()) ports.memory.emplace_back(input, output.text());
  }
  const YamlValue file = root.at("network");
  const std::string path = std::filesystem::path(root.source()).parent_path() / file.text();
  std::string bytes;
  try {
    bytes = OnnxNetwork::read(path);
  } catch (const ConfigError& error) {
    file.fail(error);
  }
  return [network = std::make_shared<const std::string>(std::move(bytes)), path, ports,
          file](const PolicyInterface& interface) {
    try {
      return std::make_unique<OnnxPolicy>(OnnxNetwork::of(*network, path), ports, file.source(), interface);
    } catch (const ConfigError& error) {
      file.fail(error);
    }
  };
}

}  // namespace crossgait
