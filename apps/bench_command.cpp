// crossgait bench: speed and accuracy of the engines on the same motions.
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/bench_page.h"
#include "apps/command.h"
#include "apps/interruption.h"
#include "apps/page_option.h"
#include "benchmarks/bench.h"
#include "benchmarks/regression.h"
#include "physics/core/error.h"
#include "physics/core/table.h"
#include "physics/robot_files/data_path.h"

namespace crossgait::apps {
namespace {

using nlohmann::ordered_json;

struct BenchCommand {
  std::vector<std::string> engines, sections;
  bool quick = false;
  std::string robot = "scara_quadruped", from, compare;
  double worse_than = 1.25;
  PageOption page;
  JsonOption json;
};

ordered_json measure(const BenchCommand& options) {
  const benchmarks::BenchOptions bench{
      .engines = engines_or_all(options.engines),
      .sections = options.sections,
      .quick = options.quick,
      .robot = std::make_shared<const RobotDescription>(load_robot(find_robot(options.robot)))};
  ProgressLine progress("measuring");
  return benchmarks::run_bench(bench, [&](double share) { progress.update(share); });
}

Provenance provenance_of(const BenchCommand& options) {
  if (!options.from.empty()) return options.json.provenance();  // it says itself what it was measured with
  ResultInputs inputs = of_robot(load_robot(find_robot(options.robot)));
  inputs.engines = engines_or_all(options.engines);
  inputs.chosen["--engines"] = inputs.engines;
  return options.json.provenance(inputs);
}

void run(const BenchCommand& options) {
  // Looked at before minutes of measuring.
  options.page.check();
  ordered_json stored;
  benchmarks::check_worse_than(options.worse_than);
  if (!options.compare.empty()) stored = benchmarks::read_bench(options.compare);
  const Provenance provenance = provenance_of(options);
  ordered_json result = options.from.empty() ? measure(options) : benchmarks::read_bench(options.from);

  std::string text = benchmarks::describe_bench(result);
  std::size_t worse = 0;
  if (!options.compare.empty()) {
    const benchmarks::Regression regression = benchmarks::compare_results(stored, result, options.worse_than);
    text += benchmarks::describe(regression);
    result["comparison"] = benchmarks::to_json(regression);
    worse = regression.worse.size();
  }
  if (options.page.asked()) options.page.write(bench_page(result), provenance);
  options.json.emit(text, result, provenance);
  if (result.contains("interrupted") && options.from.empty())
    throw EndedEarly("the sections that are finished are written as asked");
  if (worse > 0)
    throw std::runtime_error(fmt::format("{} worse than in {}", counted(worse, "figure"), options.compare));
}

}  // namespace

void add_bench_command(CLI::App& program, Invocation& invocation) {
  CLI::App* command =
      program.add_subcommand("bench", "Speed and accuracy of the engines on the same motions");
  command->footer(
      "\n  speed     time of a physics step in five scenes, of the walk around it, and on several threads\n"
      "  accuracy  error of the trot against the same engine at a step of 1/16 ms, and what it costs\n"
      "  analytic  free fall, pendulum, tumbling, friction and rebound against closed forms\n"
      "  feet      creep, penetration, touch-down and slip of feet\n"
      "\nExamples:\n"
      "  crossgait bench --quick\n"
      "  crossgait bench --only speed --engines mujoco,bullet --json speed.json\n"
      "  crossgait bench --only speed --quick --robot serial_quadruped --engines mujoco,physx,physx:pgs\n"
      "  crossgait bench --json result.json --report result.html --compare "
      "benchmarks/results/amd-epyc-2-cores.json\n"
      "  crossgait bench --from result.json --report result.html");
  auto options = std::make_shared<BenchCommand>();
  CLI::Option* quick = command->add_flag("--quick", options->quick, "Fewer repetitions: under a minute");
  CLI::Option* only =
      command
          ->add_option("--only", options->sections,
                       "Measure only this: speed, accuracy, analytic or feet; may be repeated")
          ->delimiter(',');
  CLI::Option* engine =
      command
          ->add_option("--engines,--engine", options->engines,
                       "Engines, comma-separated or repeated; all that are built in by default. Times are "
                       "compared to the first one's")
          ->delimiter(',');
  add_robot_option(*command, options->robot);  // of all sections but analytic
  command->add_option("--from", options->from, "Measure nothing: take the result that --json wrote")
      ->type_name("FILE")
      ->excludes(quick)
      ->excludes(only)
      ->excludes(command->get_option("--robot"))
      ->excludes(engine);
  command
      ->add_option("--compare", options->compare,
                   "Compare with a stored result: times as ratios to the first engine, errors as they are; "
                   "exit code 1 if a figure got worse")
      ->type_name("FILE");
  command->add_option("--worse-than", options->worse_than, "Factor beyond which a figure counts as worse")
      ->capture_default_str();
  options->page.add_to(*command, "Write a page with charts of its sections and its tables, as one HTML file");
  options->json.add_to(*command, invocation);
  on_run(*command, [options] { run(*options); });
}

}  // namespace crossgait::apps
