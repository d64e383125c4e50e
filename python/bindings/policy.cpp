// Policies, and the networks that bundles hold.
#include "policy/policy.h"

#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "env/env_model.h"
#include "physics/core/error.h"
#include "policy/bundled_policies.h"
#include "policy/hierarchical_policy.h"
#include "policy/mlp_policy.h"
#include "policy/onnx_library.h"
#include "policy/policy_bundle_names.h"
#include "python/bindings/arrays.h"
#include "python/bindings/bindings.h"
#include "python/bindings/environment.h"

namespace crossgait::python {
namespace {

using LayerArrays = std::pair<Eigen::MatrixXd, Eigen::VectorXd>;    // weight, bias
using Normalisation = std::pair<Eigen::VectorXd, Eigen::VectorXd>;  // mean, std

/// A policy with room for observations of float32.
struct BoundPolicy {
  std::unique_ptr<Policy> policy;
  std::vector<double> observation = {};
};

template <typename Value, std::size_t size>
Value value_of(const std::array<std::pair<std::string_view, Value>, size>& table, const char* element,
               const std::string& name) {
  std::string known;
  for (const auto& [text, value] : table) {
    if (text == name) return value;
    known += (known.empty() ? "" : ", ") + std::string(text);
  }
  throw ConfigError("network", element, known, name);
}

template <typename Value, std::size_t size>
std::string name_of(const std::array<std::pair<std::string_view, Value>, size>& table, Value value) {
  for (const auto& [text, known] : table) {
    if (known == value) return std::string(text);
  }
  return {};
}

MlpNetwork make_network(const std::vector<LayerArrays>& layers, const std::string& activation,
                        const std::string& output, const std::optional<Normalisation>& normalisation,
                        std::optional<double> clip) {
  MlpNetwork network;
  for (const auto& [weight, bias] : layers) network.layers.push_back({weight, bias});
  network.activation = value_of(bundle_names::kActivations, "activation", activation);
  network.output = value_of(bundle_names::kOutputs, "output", output);
  if (normalisation) std::tie(network.observation_mean, network.observation_std) = *normalisation;
  if (clip) network.observation_clip = *clip;
  check_layers("network", network, layers.empty() ? 0 : network.layers.front().weight.cols());
  return network;
}

Eigen::MatrixXd evaluate(const MlpNetwork& network, const Eigen::MatrixXd& observations) {
  const auto inputs = network.layers.empty() ? 0 : network.layers.front().weight.cols();
  if (inputs == 0 || observations.cols() != inputs) {
    throw ConfigError("network", "observations", "[n, " + std::to_string(inputs) + "]",
                      "[n, " + std::to_string(observations.cols()) + "]");
  }
  Eigen::MatrixXd actions(observations.rows(), network.layers.back().bias.size());
  for (Eigen::Index i = 0; i < observations.rows(); ++i)
    actions.row(i) = network.evaluate(observations.row(i));
  return actions;
}

BoundPolicy make_from_text(const std::string& text, const PolicyInterface& interface) {
  return {make_policy(text, interface)};
}

BoundPolicy make_from_bundle(const PolicyBundle& bundle, const std::string& source,
                             const PolicyInterface& interface) {
  return {std::make_unique<MlpPolicy>(bundle, source, interface)};
}

nb::object act(BoundPolicy& self, const AnyArray& observation) {
  const PolicyInterface& interface = self.policy->interface();
  const auto numbers =
      doubles(observation, std::array{interface.observation.size()}, "observation", self.observation);
  const NewArray<double> action(interface.action.size());
  self.policy->act(numbers, {action.data, interface.action.size()});
  return action.array;
}

void check_trained_for(const PolicyInterface& interface, const std::vector<std::string>& observation_names,
                       const std::vector<std::string>& action_names, const std::string& layout_hash,
                       std::optional<double> policy_dt, const std::string& source) {
  PolicyBundle stated;
  stated.observation_names = observation_names;
  stated.action_names = action_names;
  stated.layout_hash = layout_hash;
  stated.policy_dt = policy_dt;
  check_interface(stated, interface, source);
}

void bind_interface(nb::module_& m) {
  nb::class_<PolicyInterface>(m, "PolicyInterface",
                              "What a policy runs on: the layouts of an environment and its pace. Immutable.")
      .def(nb::new_([](const EnvConfig& config) { return EnvModel::make(config)->interface; }),
           nb::arg("config"), "Makes the interface of an environment. Raises ConfigError.")
      .def_prop_ro(
          "observation_layout", [](const PolicyInterface& i) { return layout(i.observation); },
          nb::sig("def observation_layout(self) -> list[tuple[str, str, float, float, float, float]]"),
          "(name, unit, min, max, low, high) of every number.")
      .def_prop_ro(
          "action_layout", [](const PolicyInterface& i) { return layout(i.action); },
          nb::sig("def action_layout(self) -> list[tuple[str, str, float, float, float, float]]"))
      .def_prop_ro("layout_hash",
                   [](const PolicyInterface& i) { return layout_hash(i.observation, i.action); })
      .def_ro("policy_dt", &PolicyInterface::policy_dt, "s between two actions.")
      .def(
          "member",
          [](const PolicyInterface& i, const std::string& part, const std::vector<std::string>& observation,
             double policy_dt) { return member_interface(i, observation, part, policy_dt, "member"); },
          nb::arg("part"), nb::kw_only(), nb::arg("observation") = std::vector<std::string>{},
          nb::arg("policy_dt"),
          "What a member of a hierarchical policy runs on (docs/policies.md). `part`: of the action, "
          "\"delta.\" or \"residual.\"; `observation`: names, or beginnings of names that end in \".\"; all "
          "if there are none. Raises ConfigError.")
      .def("__repr__", [](const PolicyInterface& i) {
        return fmt::format("<crossgait.policies.PolicyInterface: {} numbers to {} every {:g} s>",
                           i.observation.size(), i.action.size(), i.policy_dt);
      });
  m.attr("LAYOUT_VERSION") = kLayoutVersion;
}

/// Inputs, layers and outputs: "45-128-12".
std::string sizes_of(const MlpNetwork& network) {
  std::string sizes = std::to_string(network.layers.front().weight.cols());
  for (const MlpLayer& layer : network.layers) sizes += fmt::format("-{}", layer.weight.rows());
  return sizes;
}

void bind_network(nb::module_& m) {
  nb::class_<MlpNetwork>(m, "MlpNetwork",
                         "A multilayer perceptron as bundles hold it: clip((x - mean) / std, +-clip), layers "
                         "with the activation after all but the last, then the output function. Immutable.")
      .def(nb::new_(&make_network), nb::arg("layers"), nb::kw_only(), nb::arg("activation") = "tanh",
           nb::arg("output") = "linear", nb::arg("normalisation") = nb::none(), nb::arg("clip") = nb::none(),
           "`layers`: (weight [out, in], bias [out]) each; `activation`: tanh, elu, relu, swish or silu; "
           "`output`: linear or tanh; `normalisation`: (mean, std); `clip`: of the normalised observation. "
           "Raises ConfigError for an unknown name.")
      .def_prop_ro(
          "layers",
          [](const MlpNetwork& n) {
            std::vector<LayerArrays> layers;
            for (const MlpLayer& layer : n.layers) layers.emplace_back(layer.weight, layer.bias);
            return layers;
          },
          "(weight [out, in], bias [out]) of every layer, in arrays of their own.")
      .def_prop_ro("activation",
                   [](const MlpNetwork& n) { return name_of(bundle_names::kActivations, n.activation); })
      .def_prop_ro("output", [](const MlpNetwork& n) { return name_of(bundle_names::kOutputs, n.output); })
      .def_prop_ro(
          "normalisation",
          [](const MlpNetwork& n) -> std::optional<Normalisation> {
            if (n.observation_mean.size() == 0) return std::nullopt;
            return Normalisation{n.observation_mean, n.observation_std};
          },
          "(mean, std) of the observation, or None.")
      .def_prop_ro(
          "clip",
          [](const MlpNetwork& n) -> std::optional<double> {
            if (!std::isfinite(n.observation_clip)) return std::nullopt;
            return n.observation_clip;
          },
          "Bound of the normalised observation, ±, or None.")
      .def("evaluate", &evaluate, nb::arg("observations"),
           "Outputs [n, act] of raw observations [n, obs], in double precision and not clipped to the "
           "action's bounds. Raises ConfigError for another width.")
      .def("__repr__",
           [](const MlpNetwork& n) { return "<crossgait.policies.MlpNetwork " + sizes_of(n) + ">"; });
}

void bind_bundle(nb::module_& m) {
  nb::class_<PolicyBundle>(
      m, "PolicyBundle",
      "A network with the layout that it was trained for and golden pairs: what a bundle's file holds.")
      .def(nb::new_(&make_policy_bundle), nb::arg("network"), nb::arg("interface"),
           nb::arg("source") = "policy",
           "Weights and biases are rounded to single precision, as files hold them; golden pairs are of its "
           "own choice. `source` stands for the file in messages. Raises ConfigError unless the network "
           "fits the interface and is finite.")
      .def_static(
          "read", [](const std::filesystem::path& path) { return read_policy_bundle(path.string()); },
          nb::arg("path"), "Raises ConfigError unless everything is there.")
      .def(
          "write",
          [](const PolicyBundle& b, const std::filesystem::path& path) {
            write_policy_bundle(path.string(), b);
          },
          nb::arg("path"), "Whole or not at all. Raises ConfigError.")
      .def(
          "with_golden_pairs",
          [](const PolicyBundle& b, const Eigen::MatrixXd& observation, const Eigen::MatrixXd& action,
             const std::string& source) { return with_golden_pairs(b, observation, action, source); },
          nb::arg("observation"), nb::arg("action"), nb::arg("source") = "policy",
          "The same with other golden pairs: raw observations [n, obs] and the actions [n, act] of whoever "
          "made the network. Raises ConfigError.")
      .def_ro("network", &PolicyBundle::network)
      .def_ro("observation_names", &PolicyBundle::observation_names)
      .def_ro("action_names", &PolicyBundle::action_names)
      .def_ro("layout_hash", &PolicyBundle::layout_hash)
      .def_ro("policy_dt", &PolicyBundle::policy_dt, "s, or None if it was trained for none.")
      .def_prop_ro("golden_observation", [](const PolicyBundle& b) { return b.golden_observation; })
      .def_prop_ro("golden_action", [](const PolicyBundle& b) { return b.golden_action; })
      .def("__repr__", [](const PolicyBundle& b) {
        return "<crossgait.policies.PolicyBundle of a network " + sizes_of(b.network) + ">";
      });
  m.def("check_interface", &check_trained_for, nb::arg("interface"), nb::kw_only(),
        nb::arg("observation_names"), nb::arg("action_names"), nb::arg("layout_hash"),
        nb::arg("policy_dt") = nb::none(), nb::arg("source") = "policy",
        "Raises ConfigError saying what differs first, unless a policy that states this was trained for the "
        "interface.");
}

}  // namespace

void bind_policy(nb::module_& m) {
  bind_interface(m);
  bind_network(m);
  bind_bundle(m);
  m.def("policy_names", &policy_names, "Names of the policies that come with Crossgait, sorted.");
  m.def("find_policy_file", &find_policy_file, nb::arg("text"),
        "The file of a policy by its name or folder; any other text itself.");
  m.def("environment_of_policy", &environment_of_policy, nb::arg("text"),
        "The environment's file of a policy by its name or folder; None for any other text.");
  nb::class_<BoundPolicy>(m, "Policy", "One instance serves one environment at a time: it may remember.")
      .def(nb::new_(&make_from_text), nb::arg("text"), nb::arg("interface"),
           "zero, random, FILE.safetensors or FILE.yaml (docs/policies.md). Raises ConfigError.")
      .def_static("of_bundle", &make_from_bundle, nb::arg("bundle"), nb::arg("source"), nb::arg("interface"),
                  "Raises ConfigError if the bundle is for another interface or its network does not give "
                  "its golden actions.")
      .def(
          "reset", [](BoundPolicy& p, std::uint64_t seed) { p.policy->reset(seed); }, nb::arg("seed"),
          "An episode begins.")
      .def("act", &act, nb::arg("observation"),
           nb::sig("def act(self, observation: numpy.typing.NDArray[typing.Any]) -> "
                   "numpy.typing.NDArray[numpy.float64]"),
           "The action, in an array of its own, finite and within its bounds. Raises ConfigError for an "
           "observation of another size or type.")
      .def_prop_ro("name", [](const BoundPolicy& p) { return p.policy->name(); })
      .def_prop_ro("interface", [](const BoundPolicy& p) { return p.policy->interface(); });
}

}  // namespace crossgait::python
