// crossgait tune: gait parameters for speed or a course, and what they are worth in the other engines.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/env_options.h"
#include "apps/interruption.h"
#include "apps/page_option.h"
#include "physics/core/atomic_file.h"
#include "physics/core/table.h"
#include "report/watched_episodes.h"
#include "study/tune.h"

namespace crossgait::apps {
namespace {

struct TuneCommand {
  EnvOptions env;
  std::vector<std::string> engines;  // for the final table
  TuneOptions tune;
  std::string course, aim = "speed", out;
  PageOption page;
  JsonOption json;
};

ReportPage page_of(const Tuning& tuning, const LoadedEnv& method, std::uint64_t seed) {
  ReportPage page;
  page.title = tuning.course.empty() ? fmt::format("{} tuned on {} in {}", tuning.start.gait,
                                                   tuning.start.terrain, tuning.start.engine)
                                     : fmt::format("{} tuned on course {}", tuning.start.gait, tuning.course);
  for (Table& table : tables(tuning)) page.tables.push_back({std::move(table)});
  Chart search{.title = "Search",
               .x_label = "generation",
               .y_label = "best score so far (m/s, minus cost, or of the course)"};
  Chart::Series& best = search.series.emplace_back(Chart::Series{"", 0, Chart::Series::Style::kLine, {}});
  for (std::size_t i = 0; i < tuning.history.size(); ++i)
    best.points.push_back({static_cast<double>(i + 1), tuning.history[i]});
  page.charts.push_back({"Search", {std::move(search)}});
  const NamedPolicy zero = find_policy("zero");
  page.motions.push_back(watch_episodes(
      {{"default", method.with(tuning.start), zero}, {"tuned", method.with(tuning.tuned), zero}}, seed));
  page.sentences.push_back(fmt::format("Replayed in {}: the first episode of both.", tuning.start.engine));
  return page;
}

void run(const TuneCommand& options) {
  TuneOptions how = options.tune;
  if (!options.course.empty()) how.course = load_course(options.course);
  if (options.aim == "cost") how.aim = TuneFor::kCost;
  const LoadedEnv asked = options.env.make();
  EnvConfig start = asked.config;
  if (!options.env.terrain && options.env.config.empty()) start.terrain = "rough";
  if (options.env.adapt.empty() && options.env.config.empty()) {
    start.adapt = {"step_height", "step_length",  "cycle_time",
                   "body_height", "stance_width", "foot_clearance"};
  }
  if (!options.env.episode_seconds && options.env.config.empty()) start.episode_seconds = 6;
  const LoadedEnv method = asked.with(start);
  options.page.check(start);
  const std::vector<std::string> engines = engines_or_all(options.engines);
  const Provenance provenance =
      options.json.provenance({policy_subject(method, {"zero"}, options.tune.seed),
                               engines,
                               {{"--engine", {start.engine}}, {"--engines", engines}}});
  ProgressLine progress("tuning");
  const Tuning tuning = tune_gait(method, engines, how, [&](double share) { progress.update(share); });
  if (!options.out.empty()) {
    write_file_atomically(options.out, to_yaml(tuning.tuned));
    print_written(options.out);
  }
  if (options.page.asked()) options.page.write(page_of(tuning, method, options.tune.seed), provenance);
  options.json.emit(describe(tuning), to_json(tuning), provenance);
  if (tuning.interrupted) {
    throw EndedEarly(fmt::format("{} of {} are finished; the best so far is written as asked",
                                 tuning.history.size(), counted(options.tune.iterations, "generation")));
  }
}

}  // namespace

void add_tune_command(CLI::App& program, Invocation& invocation) {
  CLI::App* command = program.add_subcommand(
      "tune",
      "Search gait parameters for speed or a course of hard ground, and try them in the other engines");
  command->footer(
      "\nExamples:\n"
      "  crossgait tune\n"
      "  crossgait tune --engine bullet --adapt step_length,cycle_time --out fast.yaml\n"
      "  crossgait rollout --config fast.yaml\n"
      "  crossgait tune --for cost --command .5,0,0 --adapt cycle_time,body_height,load_share\n"
      "  crossgait tune --course hard --adapt cycle_time,body_height,stance_offset --terrains 1 --out "
      "hard.yaml");
  auto options = std::make_shared<TuneCommand>();
  command->add_option("--iterations", options->tune.iterations, "Generations")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  command->add_option("--population", options->tune.population, "Parameter sets per generation")
      ->check(CLI::Range(4, 100000))
      ->capture_default_str();
  command
      ->add_option("--terrains", options->tune.terrains,
                   "Terrain seeds that every set walks on, or runs of a course's sections")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--unseen", options->tune.unseen, "Other terrain seeds, or runs, for the final table")
      ->check(CLI::Range(0, 1000))
      ->capture_default_str();
  command
      ->add_option("--engines", options->engines,
                   "Engines of the final table, and of a course, comma-separated; all by default")
      ->delimiter(',');
  CLI::Option* course =
      command
          ->add_option(
              "--course", options->course,
              "Search for the score on a course (hard, or a file), by the engine where it is the lowest")
          ->type_name("NAME|FILE.yaml");
  command
      ->add_option(
          "--for", options->aim,
          "Search for speed, or for the least cost of transport at the speed that --command asks for")
      ->check(CLI::IsMember({"speed", "cost"}))
      ->excludes(course)
      ->capture_default_str();
  add_seed_option(*command, "--seed", options->tune.seed, "Seed of the search and first terrain seed")
      ->capture_default_str();
  add_workers_option(*command, options->tune.workers);
  add_output_option(*command, "--out", options->out,
                    "Write the tuned environment as YAML, for `rollout --config`")
      ->type_name("FILE.yaml");
  options->page.add_to(*command, "Write a page that replays the gait before and after, as one HTML file");
  options->env.add_to(*command);
  options->json.add_to(*command, invocation);
  on_run(*command, [options] { run(*options); });
}

}  // namespace crossgait::apps
