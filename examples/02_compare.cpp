// Walks the same in every engine, side by side: how far they lie apart, and what came first apart.
#include <cstdio>

#include "crossgait/backends/registry.h"
#include "crossgait/parity/report.h"
#include "crossgait/study/walk.h"

int main() {
  crossgait::WalkConfig config;
  config.terrain = "rough";
  config.terrain_seed = 3;
  config.timing.seconds = 2;
  const crossgait::WalkComparison result = compare_walks(config, crossgait::available_engines());
  std::puts(crossgait::describe(result.comparison).c_str());
}
