// Walks two seconds in one engine and says how it went.
#include <cstdio>

#include "crossgait/backends/registry.h"
#include "crossgait/parity/report.h"
#include "crossgait/study/loaded_walk.h"

int main() {
  crossgait::WalkConfig config;
  config.terrain = "rough";
  config.timing.seconds = 2;
  const crossgait::Engine engine = crossgait::find_engine(crossgait::available_engines().front());
  const auto world = engine.make(crossgait::LoadedWalk(config).world);
  std::puts(crossgait::describe(crossgait::record_walk(*world, config.setup())).c_str());
}
