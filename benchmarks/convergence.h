// How fast the errors of motions known in closed form vanish with the physics step.
#pragma once

#include <string>
#include <vector>

#include "parity/comparison.h"

namespace crossgait::benchmarks {

/// Holds errors of one quantity over the physics step, and how fast they vanish with it.
struct Convergence {
  std::string quantity, unit, engine;
  std::vector<double> step_s, error;
  double order = 0;  ///< p of error = C step^p
};

/// Measures free_fall, pendulum_period, tumbling_momentum and tumbling_energy at steps of 4, 2, 1 and 1/2 ms.
std::vector<Convergence> measure_convergence(const std::vector<std::string>& engines,
                                             const Progress& progress);

}  // namespace crossgait::benchmarks
