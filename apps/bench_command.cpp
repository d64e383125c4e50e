// crossgait bench: speed and accuracy of the engines on the same motions.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crossgait/apps/command.h"
#include "crossgait/backends/registry.h"
#include "crossgait/bench/bench.h"

namespace crossgait::apps {
namespace {

struct Options {
  bench::BenchOptions bench;
  JsonOption json;
};

void run(const Options& options) {
  bench::BenchOptions bench = options.bench;
  if (bench.backends.empty()) bench.backends = available_backends();
  nlohmann::ordered_json result;
  {
    ProgressLine progress("measuring");
    result = bench::run_bench(bench, [&](double share) { progress.update(share); });
  }
  options.json.emit(bench::describe_bench(result), result);
}

}  // namespace

void add_bench_command(CLI::App& program) {
  CLI::App* command =
      program.add_subcommand("bench", "Speed and accuracy of the engines on the same motions");
  auto options = std::make_shared<Options>();
  command->add_flag("--quick", options->bench.quick, "Fewer repetitions: under a minute");
  command->add_option("--only", options->bench.sections, "speed, accuracy, analytic or feet; may be repeated")
      ->delimiter(',');
  command->add_option("--backend", options->bench.backends, "Engines; all that are built in by default")
      ->delimiter(',');
  options->json.add_to(*command);
  command->callback([options] { run(*options); });
}

}  // namespace crossgait::apps
