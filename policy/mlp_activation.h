// Activations of networks, in single precision.
#pragma once

#include "policy/policy_bundle.h"

namespace crossgait {

/// Applies an activation to every value, without allocating.
inline void activate(MlpActivation activation, Eigen::VectorXf& values) noexcept {
  auto x = values.array();
  switch (activation) {
    case MlpActivation::kTanh:
      x = x.tanh();
      break;
    case MlpActivation::kElu:
      x = x.max(0.0F) + (x.min(0.0F).exp() - 1.0F);
      break;
    case MlpActivation::kRelu:
      x = x.max(0.0F);
      break;
    case MlpActivation::kSwish:
      x = x / ((-x).exp() + 1.0F);
      break;
    case MlpActivation::kSoftsign:
      x = x / (x.abs() + 1.0F);
      break;
  }
}

}  // namespace crossgait
