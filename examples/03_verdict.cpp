// Judges whether a trot depends on the engine, and what in the engines it comes from.
#include <cstdio>

#include "crossgait/study/engine_comparison.h"

int main() {
  crossgait::WalkConfig walk;
  walk.terrain = "rough";
  walk.timing.seconds = 0.5;
  crossgait::JudgeOptions options;
  options.verdict.starts = 4;
  options.explain = true;
  std::puts(describe(judge_engines({walk, {}, 0}, {"mujoco", "bullet"}, options)).c_str());
}
