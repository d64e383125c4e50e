// crossgait tune: gait parameters for speed, by the cross-entropy method (Rubinstein, 1999): draw parameter
// sets from a normal distribution, keep the best quarter, fit the distribution to them, repeat. No gradients,
// no network: it shows that the environment can be learned, and what its parameters alone are worth.
#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "crossgait/apps/env_options.h"
#include "crossgait/backends/registry.h"
#include "crossgait/env/worker_pool.h"
#include "crossgait/parity/table.h"
#include "crossgait/physics/atomic_file.h"
#include "crossgait/physics/error.h"

namespace crossgait::apps {
namespace {

struct Options {
  EnvOptions env;
  std::vector<std::string> engines;  // for the final table
  std::size_t iterations = 10, population = 16, terrains = 2, unseen = 3, workers = default_workers();
  std::uint64_t seed = 0;
  std::string out;
  JsonOption json;
};

// Parameters as the optimiser sees them: every range mapped to [-1, 1].
using Point = std::vector<double>;

// The rows that are tuned.
std::vector<const ParameterRow*> rows_of(const EnvConfig& config) {
  std::vector<const ParameterRow*> rows;
  for (const std::string& name : config.adapt) rows.push_back(&find_parameter(name));
  if (rows.empty()) throw ConfigError("command line", "--adapt", "at least one parameter to tune", "none");
  return rows;
}

EnvConfig with_parameters(EnvConfig config, const std::vector<const ParameterRow*>& rows,
                          const Point& point) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const ParameterRow& row = *rows[i];
    config.parameters.*row.member = row.clip(row.min + (point[i] + 1) / 2 * (row.max - row.min));
  }
  return config;
}

// The zero policy on so many terrains from `first` on.
Evaluation walk(EnvConfig config, std::uint64_t first, std::size_t terrains) {
  std::vector<EpisodeSummary> episodes;
  for (std::size_t k = 0; k < terrains; ++k) {
    config.terrain_seed = first + k;
    const auto one = evaluate_policy(env_factory(config), policy_factory("zero"), 1, 0);
    episodes.insert(episodes.end(), one.begin(), one.end());
  }
  return sum_up(episodes);
}

std::size_t ended_early(const Evaluation& e) { return e.falls + e.diverged + e.left_terrain; }

// Mean speed, less a metre per second for every terrain that it did not stay on, and a little for reaching
// beyond the legs.
double score(const Evaluation& e) {
  const double clamped =
      static_cast<double>(e.ik_clamped) / static_cast<double>(std::max<std::int64_t>(1, e.steps));
  return e.speed.mean - static_cast<double>(ended_early(e)) - 0.1 * clamped;
}

struct Distribution {
  Point mean, deviation;

  Point sample(Random& random) const {
    Point point(mean.size());
    for (std::size_t i = 0; i < mean.size(); ++i) {
      // Box and Muller's transform: the standard library's normal distribution differs between machines.
      const double r = std::sqrt(-2 * std::log(1 - random.uniform())), angle = random.uniform(0, 2 * M_PI);
      point[i] = std::clamp(mean[i] + deviation[i] * r * std::cos(angle), -1.0, 1.0);
    }
    return point;
  }

  void fit(const std::vector<Point>& best) {
    constexpr double kLeastDeviation = 0.03;
    const auto n = static_cast<double>(best.size());
    for (std::size_t i = 0; i < mean.size(); ++i) {
      double sum = 0, squares = 0;
      for (const Point& p : best) sum += p[i];
      mean[i] = sum / n;
      for (const Point& p : best) squares += (p[i] - mean[i]) * (p[i] - mean[i]);
      deviation[i] = std::max(std::sqrt(squares / n), kLeastDeviation);
    }
  }
};

struct Result {
  EnvConfig tuned;
  double score = 0;
  std::vector<double> history;  // best score so far, per iteration
};

Result tune(const Options& options, const EnvConfig& start, ProgressLine& progress) {
  const std::vector<const ParameterRow*> rows = rows_of(start);
  Distribution distribution;
  for (const ParameterRow* row : rows)
    distribution.mean.push_back(row->normalise(start.parameters.*row->member));
  distribution.deviation.assign(rows.size(), 0.5);
  Point best = distribution.mean;
  Result result{start, score(walk(start, options.seed, options.terrains)), {}};
  Random random(options.seed);
  WorkerPool pool(options.workers);
  const std::size_t elite = std::max<std::size_t>(2, options.population / 4);
  for (std::size_t iteration = 0; iteration < options.iterations; ++iteration) {
    std::vector<Point> points;
    for (std::size_t k = 0; k < options.population; ++k) points.push_back(distribution.sample(random));
    points.front() = best;  // the best so far stays in the race
    std::vector<double> scores(points.size());
    pool.run(points.size(), [&](std::size_t k) {
      scores[k] = score(walk(with_parameters(start, rows, points[k]), options.seed, options.terrains));
    });
    std::vector<std::size_t> order(points.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return scores[a] > scores[b]; });
    std::vector<Point> top;
    for (std::size_t k = 0; k < elite; ++k) top.push_back(points[order[k]]);
    distribution.fit(top);
    if (scores[order[0]] > result.score) {
      result.score = scores[order[0]];
      best = points[order[0]];
      result.tuned = with_parameters(start, rows, best);
    }
    result.history.push_back(result.score);
    progress.update(static_cast<double>(iteration + 1) / static_cast<double>(options.iterations));
  }
  return result;
}

// One line of the table: the same parameters everywhere.
struct Check {
  std::string ground, parameters;
  std::vector<Evaluation> per_engine;
};

std::vector<Check> check(const Options& options, const std::vector<std::string>& engines,
                         const EnvConfig& start, const EnvConfig& tuned) {
  std::vector<Check> checks;
  const auto add = [&](const std::string& ground, std::uint64_t first, std::size_t terrains) {
    for (const auto& [name, config] : {std::pair{"default", &start}, std::pair{"tuned", &tuned}}) {
      Check line{ground, name, {}};
      for (const std::string& engine : engines) {
        EnvConfig c = *config;
        c.backend = engine;
        line.per_engine.push_back(walk(c, first, terrains));
      }
      checks.push_back(std::move(line));
    }
  };
  add("seeds tuned on", options.seed, options.terrains);
  if (options.unseen > 0) add("unseen seeds", options.seed + options.terrains, options.unseen);
  return checks;
}

std::string describe(const std::vector<std::string>& engines, const std::vector<Check>& checks,
                     const Result& result, const EnvConfig& start) {
  Table parameters({"parameter", "default", "tuned", "unit"});
  for (const ParameterRow* row : rows_of(start)) {
    parameters.add_row({std::string(row->name), fmt::format("{:.4f}", start.parameters.*row->member),
                        fmt::format("{:.4f}", result.tuned.parameters.*row->member), std::string(row->unit)});
  }
  std::vector<std::string> header{fmt::format("mean speed on {}, m/s", start.terrain), "parameters"};
  header.insert(header.end(), engines.begin(), engines.end());
  Table speeds(header);
  for (std::size_t i = 0; i < checks.size(); ++i) {
    std::vector<std::string> row{checks[i].ground, checks[i].parameters};
    for (std::size_t k = 0; k < engines.size(); ++k) {
      const Evaluation& e = checks[i].per_engine[k];
      std::string text = fmt::format("{:.4f}", e.speed.mean);
      if (i % 2 == 1)
        text += fmt::format(" ({:.2f} x)", e.speed.mean / checks[i - 1].per_engine[k].speed.mean);
      if (ended_early(e) > 0) text += fmt::format(", {}", outcome(e));
      row.push_back(text);
    }
    speeds.add_row(row);
  }
  return fmt::format("{}\nTuned in {}\n{}", parameters.str(), start.backend, speeds.str());
}

void run(const Options& options) {
  EnvConfig start = options.env.make();
  if (!options.env.terrain && options.env.config.empty()) start.terrain = "rough";
  if (options.env.adapt.empty() && options.env.config.empty()) {
    start.adapt = {"step_height", "step_length",  "cycle_time",
                   "body_height", "stance_width", "foot_clearance"};
  }
  if (!options.env.episode_seconds && options.env.config.empty()) start.episode_seconds = 6;
  const std::vector<std::string> engines = options.engines.empty() ? available_engines() : options.engines;
  ProgressLine progress("tuning");
  const Result result = tune(options, start, progress);
  const std::vector<Check> checks = check(options, engines, start, result.tuned);
  if (!options.out.empty()) write_file_atomically(options.out, to_yaml(result.tuned));

  nlohmann::ordered_json json{
      {"backend", start.backend}, {"terrain", start.terrain}, {"history", result.history}};
  for (const ParameterRow* row : rows_of(start))
    json["parameters"][std::string(row->name)] = result.tuned.parameters.*row->member;
  for (const Check& line : checks) {
    for (std::size_t k = 0; k < engines.size(); ++k) {
      json["checks"].push_back({{"ground", line.ground},
                                {"parameters", line.parameters},
                                {"backend", engines[k]},
                                {"all", to_json(line.per_engine[k])}});
    }
  }
  options.json.emit(describe(engines, checks, result, start), json);
}

}  // namespace

void add_tune_command(CLI::App& program) {
  CLI::App* command = program.add_subcommand(
      "tune", "Search gait parameters for speed on rough ground, and try them in the other engines");
  command->footer(
      "\nExamples:\n"
      "  crossgait tune\n"
      "  crossgait tune --engine bullet --adapt step_length,cycle_time --out fast.yaml\n"
      "  crossgait rollout --config fast.yaml");
  auto options = std::make_shared<Options>();
  command->add_option("--iterations", options->iterations, "Generations")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  command->add_option("--population", options->population, "Parameter sets per generation")
      ->check(CLI::Range(4, 100000))
      ->capture_default_str();
  command->add_option("--terrains", options->terrains, "Terrain seeds that every set walks on")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--unseen", options->unseen, "Other terrain seeds for the final table")
      ->check(CLI::Range(0, 1000))
      ->capture_default_str();
  command
      ->add_option("--engines", options->engines,
                   "Engines of the final table, comma-separated; all by default")
      ->delimiter(',');
  command->add_option("--seed", options->seed, "Seed of the search and first terrain seed")
      ->capture_default_str();
  add_workers_option(*command, options->workers);
  command->add_option("--out", options->out, "Write the tuned environment as YAML, for `rollout --config`")
      ->type_name("FILE.yaml");
  options->env.add_to(*command);
  options->json.add_to(*command);
  command->callback([options] { run(*options); });
}

}  // namespace crossgait::apps
