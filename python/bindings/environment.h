// Environments as Python holds them.
#pragma once

#include <memory>
#include <vector>

#include <nanobind/nanobind.h>

#include "env/vector_env.h"
#include "python/bindings/observation_bounds.h"

namespace crossgait::python {

/// Holds one environment with room for what its steps write.
struct Environment {
  std::shared_ptr<const EnvModel> model;
  std::unique_ptr<QuadrupedEnv> env;
  ObservationBounds bounds;
  std::vector<double> action = {};        ///< of float32
  std::vector<std::size_t> outside = {};  ///< of the last observation
  std::uint64_t revision = 0;             ///< grows whenever something may have changed

  const QuadrupedEnv& get() const { return *env; }
};

/// Views one of the environments of a VectorEnv, which outlives it and alone steps it.
struct EnvironmentView {
  VectorEnv* envs;
  std::size_t index;

  const QuadrupedEnv& get() const { return envs->environment(index); }
};

/// Identifies the environments that it is one of, for `guarded`: they work all at once.
inline const void* identity_of(const EnvironmentView& view) noexcept { return view.envs; }

/// Makes a list of (name, unit, min, max, low, high) of a layout.
nanobind::object layout(const Layout& layout);

}  // namespace crossgait::python
