#include "study/tune.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "env/env_model.h"
#include "physics/core/error.h"
#include "physics/core/schema.h"
#include "physics/core/table.h"
#include "physics/core/worker_pool.h"

namespace crossgait {
namespace {

// Parameters as the optimiser sees them: every range mapped to [-1, 1].
using Point = std::vector<double>;

// The rows that are tuned.
std::vector<ParameterRow> rows_of(const EnvConfig& config) {
  std::vector<ParameterRow> rows;
  for (const std::string& name : config.adapt) rows.push_back(config.adaptation.row(name));
  if (rows.empty()) throw ConfigError("tune", "adapt", "at least one parameter to tune", "none");
  return rows;
}

EnvConfig with_parameters(EnvConfig config, const std::vector<ParameterRow>& rows, const Point& point) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const ParameterRow& row = rows[i];
    config.parameters[row.name] = row.clip(row.min + (point[i] + 1) / 2 * (row.max - row.min));
  }
  return config;
}

// The parameters of a configuration that states those that are tuned.
GaitParameters parameters_of(const EnvConfig& config) {
  return config.parameters.over(find_gait(config.gait).preferred);
}

// The zero policy on so many terrains from `first` on.
Evaluation walk(LoadedEnv environment, std::uint64_t first, std::size_t terrains) {
  std::vector<EpisodeSummary> episodes;
  for (std::size_t k = 0; k < terrains; ++k) {
    environment.config.terrain_seed = first + k;
    const auto one = evaluate_policy(env_factory(environment), find_policy("zero").make, 1, 0);
    episodes.insert(episodes.end(), one.begin(), one.end());
  }
  return sum_up(episodes);
}

// Mean speed, less a metre per second for every terrain that it did not stay on, and a little for reaching
// beyond the legs.
double score(const Evaluation& e) {
  const double clamped = static_cast<double>(e.motion.of(&MotionSummary::ik_clamped)) /
                         static_cast<double>(std::max<std::int64_t>(1, e.steps));
  return e.mean_speed() - static_cast<double>(e.ended_early()) - 0.1 * clamped;
}

// Minus the cost of transport, which is unknown of a robot that did not move; what falls or is slower than
// asked for comes behind everything that does not.
double cost_score(const Evaluation& e, double commanded) {
  constexpr double kSlow = 0.95, kPenalty = 100;  // costs of gaits are 5 to 20
  const double share = e.mean_speed() / commanded;
  const double lacking = std::max(0.0, kSlow - share) + static_cast<double>(e.ended_early());
  const auto& cost = e.motion.of(&MotionSummary::cost_of_transport);
  return -(cost ? cost->mean : kPenalty) - kPenalty * lacking;
}

// A set of runs: of terrain seeds from `first` on, or of a course from a seed.
struct Ground {
  std::uint64_t first;
  std::size_t runs;
};

CourseResult run_zero(const Course& course, const LoadedEnv& environment, const std::string& engine,
                      const Ground& ground, std::size_t workers) {
  return run_course(course, environment, find_policy("zero"), {engine},
                    {.episodes = ground.runs, .workers = workers, .seed = ground.first});
}

// What a set of parameters is worth: on a course, in the engine where that is the least.
double worth(const LoadedEnv& environment, const std::vector<std::string>& engines,
             const TuneOptions& options) {
  const Ground ground{options.seed, options.terrains};
  if (!options.course) {
    const Evaluation walked = walk(environment, ground.first, ground.runs);
    return options.aim == TuneFor::kCost ? cost_score(walked, environment.config.command->vx) : score(walked);
  }
  double least = std::numeric_limits<double>::infinity();
  for (const std::string& engine : engines)
    least = std::min(least, run_zero(*options.course, environment, engine, ground, 1).score(engine).mean);
  return least;
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

void search(const LoadedEnv& method, const TuneOptions& options, const Progress& progress, Tuning& result) {
  const EnvConfig& start = result.start;
  const std::vector<ParameterRow> rows = rows_of(start);
  Distribution distribution;
  // Within the ranges, also where the start is not.
  for (const ParameterRow& row : rows)
    distribution.mean.push_back(row.normalise(row.clip(parameters_of(start).*row.member)));
  distribution.deviation.assign(rows.size(), 0.5);
  Point best = distribution.mean;
  Random random(options.seed);
  WorkerPool pool(options.workers);
  const std::size_t elite = std::max<std::size_t>(2, options.population / 4);
  for (std::size_t iteration = 0; iteration < options.iterations; ++iteration) {
    std::vector<Point> points;
    for (std::size_t k = 0; k < options.population; ++k) points.push_back(distribution.sample(random));
    points.front() = best;  // the best so far stays in the race
    std::vector<double> scores(points.size());
    const auto done = static_cast<double>(iteration), all = static_cast<double>(options.iterations);
    const Progress generation = part_of(progress, done / all, (done + 1) / all);
    SharedProgress shared(generation, points.size());
    pool.run(points.size(), [&](std::size_t k) {
      if (shared.interrupted()) return;
      scores[k] = worth(method.with(with_parameters(start, rows, points[k])), result.engines, options);
      shared.part_done();
    });
    if (shared.interrupted()) throw Interrupted();
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
  }
}

void add_checks(const LoadedEnv& method, const TuneOptions& options, const Progress& progress,
                Tuning& result) {
  const auto add = [&](const std::string& name, const Ground& ground) {
    for (const auto& [parameters, config] :
         {std::pair{"default", &result.start}, std::pair{"tuned", &result.tuned}}) {
      TuneCheck line{name, parameters, {}, {}};
      for (const std::string& engine : result.engines) {
        EnvConfig here = *config;
        if (options.course) {
          line.course.push_back(
              run_zero(*options.course, method.with(here), engine, ground, options.workers));
        } else {
          here.engine = engine;
          line.per_engine.push_back(walk(method.with(here), ground.first, ground.runs));
        }
        if (progress) progress(1);
      }
      result.checks.push_back(std::move(line));
    }
  };
  add("seeds tuned on", {options.seed, options.terrains});
  if (options.unseen > 0) add("unseen seeds", {options.seed + options.terrains, options.unseen});
}

// NaN for the cost of a robot that did not move.
double value_of(const TuneCheck& line, TuneFor aim, std::size_t engine) {
  if (!line.course.empty()) return line.course[engine].score(line.course[engine].cells.front().engine).mean;
  const Evaluation& e = line.per_engine[engine];
  if (aim == TuneFor::kSpeed) return e.mean_speed();
  const auto& cost = e.motion.of(&MotionSummary::cost_of_transport);
  return cost ? cost->mean : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

Tuning tune_gait(const LoadedEnv& method, const std::vector<std::string>& engines, const TuneOptions& options,
                 const Progress& progress) {
  const EnvConfig& start = method.config;
  if (start.action != ActionKind::kGait)
    throw ConfigError(start.source, "action", "gait, whose parameters are tuned", name(start.action));
  if (options.aim == TuneFor::kCost && !(start.command && start.command->vx > 0))
    throw ConfigError(start.source, "command", "a speed forward, at which the cost is tuned", "none");
  const EnvConfig whole = EnvModel::make(method)->resolved();
  Tuning result{whole, whole, options.course ? options.course->name : "", options.aim, 0, {}, engines, {}};
  try {
    result.score = worth(method.with(whole), engines, options);
    search(method, options, progress, result);
    add_checks(method, options, progress, result);
  } catch (const Interrupted&) {
    result.interrupted = true;
  }
  return result;
}

nlohmann::ordered_json to_json(const Tuning& t) {
  using nlohmann::ordered_json;
  ordered_json json{{"engine", t.start.engine},
                    {"terrain", t.start.terrain},
                    {"history", t.history},
                    {"checks", ordered_json::array()}};
  if (t.course.empty()) {
    json["for"] = t.aim == TuneFor::kCost ? "cost" : "speed";
  } else {
    json["course"] = t.course;
  }
  if (t.interrupted) json["interrupted"] = true;
  for (const ParameterRow& row : rows_of(t.start))
    json["parameters"][std::string(row.name)] = parameters_of(t.tuned).*row.member;
  for (const TuneCheck& line : t.checks) {
    for (std::size_t k = 0; k < t.engines.size(); ++k) {
      ordered_json check{{"ground", line.ground}, {"parameters", line.parameters}, {"engine", t.engines[k]}};
      if (line.course.empty()) {
        check["all"] = to_json(line.per_engine[k]);
      } else {
        check["course"] = to_json(line.course[k]);
      }
      json["checks"].push_back(std::move(check));
    }
  }
  return with_schema("tune", json);
}

std::array<Table, 2> tables(const Tuning& t) {
  Table parameters({"parameter", "default", "tuned", "unit"});
  for (const ParameterRow& row : rows_of(t.start)) {
    parameters.add_row({std::string(row.name), fmt::format("{:.4f}", parameters_of(t.start).*row.member),
                        fmt::format("{:.4f}", parameters_of(t.tuned).*row.member), std::string(row.unit)});
  }
  const bool cost = t.aim == TuneFor::kCost;
  std::string measure = fmt::format("mean speed on {}, m/s", t.start.terrain);
  if (cost)
    measure = fmt::format("cost of transport on {} at {:g} m/s", t.start.terrain, t.start.command->vx);
  if (!t.course.empty()) measure = fmt::format("score on course {}", t.course);
  std::vector<std::string> header{measure, "parameters"};
  header.insert(header.end(), t.engines.begin(), t.engines.end());
  Table speeds(header);
  for (std::size_t i = 0; i < t.checks.size(); ++i) {
    std::vector<std::string> row{t.checks[i].ground, t.checks[i].parameters};
    for (std::size_t k = 0; k < t.engines.size(); ++k) {
      std::string text = fmt::format("{:.4f}", value_of(t.checks[i], t.aim, k));
      if (i % 2 == 1)
        text +=
            fmt::format(" ({:.2f} x)", value_of(t.checks[i], t.aim, k) / value_of(t.checks[i - 1], t.aim, k));
      if (cost && t.course.empty())
        text += fmt::format(", {:.2f} m/s", t.checks[i].per_engine[k].mean_speed());
      if (t.course.empty() && t.checks[i].per_engine[k].ended_early() > 0)
        text += fmt::format(", {}", outcomes_in_words(t.checks[i].per_engine[k]));
      row.push_back(text);
    }
    speeds.add_row(row);
  }
  return {std::move(parameters), std::move(speeds)};
}

std::string describe(const Tuning& t) {
  const auto [parameters, speeds] = tables(t);
  const std::string where = t.course.empty() ? t.start.engine : fmt::format("{}", fmt::join(t.engines, ", "));
  return fmt::format("{}\nTuned in {}\n{}", parameters.str(), where, speeds.str());
}

}  // namespace crossgait
