// How a policy bundle spells what it holds: shared by its reader and its writer.
#pragma once

#include <array>
#include <string_view>
#include <utility>

#include "policy/policy_bundle.h"

namespace crossgait::bundle_names {

inline constexpr std::string_view kFormat = "crossgait-policy-1";
inline constexpr std::array<std::pair<std::string_view, MlpActivation>, 6> kActivations{
    {{"tanh", MlpActivation::kTanh},
     {"elu", MlpActivation::kElu},
     {"relu", MlpActivation::kRelu},
     {"swish", MlpActivation::kSwish},
     {"silu", MlpActivation::kSwish},
     {"softsign", MlpActivation::kSoftsign}}};
inline constexpr std::array<std::pair<std::string_view, MlpOutput>, 2> kOutputs{
    {{"linear", MlpOutput::kLinear}, {"tanh", MlpOutput::kTanh}}};

}  // namespace crossgait::bundle_names
