#include "benchmarks/convergence.h"

#include <array>
#include <utility>

#include "backends/registry.h"
#include "benchmarks/statistics.h"
#include "scenes/analytic.h"

namespace crossgait::benchmarks {

std::vector<Convergence> measure_convergence(const std::vector<std::string>& engines,
                                             const Progress& progress) {
  struct Quantity {
    const char* name;
    const char* unit;
    double (*error)(const Engine& engine, double h);
  };
  constexpr std::array<Quantity, 4> kQuantities{{
      {"free_fall", "m", scenes::free_fall_error},
      {"pendulum_period", "relative", scenes::pendulum_error},
      {"tumbling_momentum", "relative",
       [](const Engine& engine, double h) { return scenes::measure_tumbling(engine, h).momentum; }},
      {"tumbling_energy", "relative",
       [](const Engine& engine, double h) { return scenes::measure_tumbling(engine, h).energy; }},
  }};
  std::vector<Convergence> results;
  for (const Quantity& quantity : kQuantities) {
    for (const std::string& name : engines) {
      Convergence c{quantity.name, quantity.unit, name, {4e-3, 2e-3, 1e-3, 5e-4}, {}, 0};
      const Engine engine = find_engine(name);
      for (const double h : c.step_s) c.error.push_back(quantity.error(engine, h));
      c.order = convergence_order(c.step_s, c.error);
      results.push_back(std::move(c));
      progress(static_cast<double>(results.size()) /
               static_cast<double>(kQuantities.size() * engines.size()));
    }
  }
  return results;
}

}  // namespace crossgait::benchmarks
