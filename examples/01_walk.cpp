// Walks two seconds in one engine and says how it went.
#include <cstdio>

#include "crossgait/backends/registry.h"
#include "crossgait/parity/report.h"
#include "crossgait/study/walk.h"

int main() {
  crossgait::WalkConfig config;
  config.terrain = "rough";
  config.timing.seconds = 2;
  const crossgait::WalkRun run = crossgait::walk(config, crossgait::available_engines().front());
  std::puts(crossgait::describe(run).c_str());
}
