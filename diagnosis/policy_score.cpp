#include "diagnosis/policy_score.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "parity/distributions.h"
#include "parity/paired_differences.h"
#include "physics/core/schema.h"
#include "physics/core/table.h"
#include "physics/core/worker_pool.h"

namespace crossgait {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kScoreConfidence = 0.95;

PolicyCell cell_of(const ScoredPolicy& policy, const std::string& engine, const WalkResult& result,
                   const WalkTest& test) {
  PolicyCell cell;
  cell.policy = policy.name;
  cell.trained_in = policy.trained_in;
  cell.engine = engine;
  cell.by_start = result.by_seed(test.seeds);
  const Interval value = PairedDifferences(cell.by_start).interval(kScoreConfidence);
  cell.value = value.estimate;
  cell.low = value.low;
  cell.high = value.high;
  cell.walks = result.walks.size();
  cell.falls = result.falls();
  constexpr double kTail = (1 - kScoreConfidence) / 2;
  cell.falls_low = share_lower_limit(cell.falls, cell.walks, kTail);
  cell.falls_high = share_upper_limit(cell.falls, cell.walks, kTail);
  const double n = static_cast<double>(cell.walks);
  for (const WalkMeasure& walk : result.walks) {
    cell.speed_error += walk.speed_error / n;
    cell.yaw_rate_error += walk.yaw_rate_error / n;
    cell.jitter += walk.jitter / n;
    cell.effort += walk.effort / n;
  }
  cell.done = does_what_is_asked(result, test.seeds);
  cell.complaint = what_is_wrong(result, test);
  return cell;
}

}  // namespace

std::vector<PolicyCell> score_policies(std::span<const ScoredPolicy> policies,
                                       std::span<const std::string> engines,
                                       const PolicyScoreOptions& options, const Progress& progress) {
  struct Part {
    const ScoredPolicy& policy;
    const std::string& engine;
    WalkTest test;
    WalkResult result;
  };
  std::vector<Part> parts;
  for (const ScoredPolicy& policy : policies) {
    for (const std::string& engine : engines) {
      for (const WalkCommand& command : walk_commands(policy.environment.config))
        parts.push_back({policy, engine, {{command}, options.starts, options.seconds, 0}, {}});
    }
  }
  SharedProgress shared(progress, parts.size());
  WorkerPool(options.workers).run(parts.size(), [&](std::size_t i) {
    if (shared.interrupted()) return;
    Part& part = parts[i];
    LoadedEnv environment = part.policy.environment;
    environment.config.engine = part.engine;
    part.result = run_walks(environment, part.policy.policy, part.test, options.seed);
    shared.part_done();
  });
  if (shared.interrupted()) throw Interrupted();
  std::vector<PolicyCell> cells;
  for (std::size_t i = 0; i < parts.size();) {
    const Part& first = parts[i];
    WalkTest whole = first.test;
    WalkResult result;
    whole.commands.clear();
    for (; i < parts.size() && &parts[i].policy == &first.policy && &parts[i].engine == &first.engine; ++i) {
      whole.commands.push_back(parts[i].test.commands.front());
      const WalkResult& one = parts[i].result;
      result.walks.insert(result.walks.end(), one.walks.begin(), one.walks.end());
      result.scores.insert(result.scores.end(), one.scores.begin(), one.scores.end());
    }
    cells.push_back(cell_of(first.policy, first.engine, result, whole));
  }
  return cells;
}

std::string summary_of(std::span<const PolicyCell> cells) {
  std::vector<std::string> policies, sentences;
  for (const PolicyCell& c : cells) {
    if (std::find(policies.begin(), policies.end(), c.policy) == policies.end()) policies.push_back(c.policy);
  }
  for (const std::string& policy : policies) {
    std::vector<std::string> done;
    std::size_t all = 0;
    for (const PolicyCell& c : cells) {
      if (c.policy != policy) continue;
      ++all;
      if (c.done) done.push_back(c.engine);
    }
    sentences.push_back(fmt::format("{} does what it is asked in {} of {}{}{}.", policy, done.size(),
                                    counted(all, "engine"), done.empty() ? "" : ": ", fmt::join(done, ", ")));
  }
  return fmt::format("{}", fmt::join(sentences, "\n"));
}

std::string describe(std::span<const PolicyCell> cells) {
  Table table({"policy", "trained in", "engine", "score", "95 %", "falls", "speed error", "yaw-rate error",
               "jitter", "effort", "says"});
  for (const PolicyCell& c : cells) {
    table.add_row({c.policy, c.trained_in.empty() ? "-" : c.trained_in, c.engine,
                   fmt::format("{:.3f}", c.value), fmt::format("{:.3f} to {:.3f}", c.low, c.high),
                   fmt::format("{} of {}", c.falls, c.walks), fmt::format("{:.3f}", c.speed_error),
                   fmt::format("{:.3f}", c.yaw_rate_error), fmt::format("{:.0f}", c.jitter),
                   fmt::format("{:.2f}", c.effort), c.done ? "does what it is asked" : c.complaint});
  }
  return summary_of(cells) + "\n\n" + table.str() +
         "\nScores: 0 is best, 3 and more a fall (docs/diagnosis.md); errors in m/s "
         "and rad/s, jitter in rad/s^2.\n";
}

nlohmann::ordered_json to_json(std::span<const PolicyCell> cells, const PolicyScoreOptions& options) {
  Json out{{"summary", summary_of(cells)},
           {"starts", options.starts},
           {"seconds", options.seconds},
           {"cells", Json::array()}};
  for (const PolicyCell& c : cells)
    out["cells"].push_back({{"policy", c.policy},
                            {"trained_in", c.trained_in.empty() ? Json() : Json(c.trained_in)},
                            {"engine", c.engine},
                            {"value", c.value},
                            {"low", c.low},
                            {"high", c.high},
                            {"walks", c.walks},
                            {"falls", c.falls},
                            {"falls_low", c.falls_low},
                            {"falls_high", c.falls_high},
                            {"speed_error_mps", c.speed_error},
                            {"yaw_rate_error_radps", c.yaw_rate_error},
                            {"jitter_radps2", c.jitter},
                            {"effort", c.effort},
                            {"done", c.done},
                            {"complaint", c.complaint}});
  return with_schema("score", out);
}

}  // namespace crossgait
