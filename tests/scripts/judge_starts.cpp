// Judges chosen starts of two set-ups by the rule of a verdict, for scripts/quality/calibrate-verdict.
//
//   crossgait_judge_starts --runs STORE.jsonl [--workers N] < requests > answers
//
// A request is a line of JSON, and so is its answer:
//   {"setup": {"robot", "terrain", "gait", "seconds", "friction", "speed", "seed", "push", "offset",
//   "heading"}
//             or {"policy", "config", "seed", "push", "offset", "heading"},
//    "a": {"engine": "mujoco"}, "b": {"engine": "mujoco", "planted": {"friction": 0.9}},
//    "starts_a": [0, 1, ...], "starts_b": [5, 6, ...], "margins": {"slip_m": 0.1}, "steps": true,
//    "differences": false}
// With "differences" the answer holds those of every statistic, and of each whether a run of the pair ended
// early. Pair i is start starts_a[i] in `a` and starts_b[i] in `b`, so that the same starts may be drawn
// again, and two sets of starts of one engine be judged as if they were two engines. What is planted changes
// the world of that engine and nothing else. Everything behind that is the program's: VerdictRuns cuts and
// pairs, `judge` gives the words. Runs are kept as `crossgait verdict --runs` keeps them, and those of
// engines as they are are shared with it. Settings of contact, which change no word, and a quarter of the
// time step, which neither does, are not run; without "steps" nor is half of it, as where a control step is
// no whole number of such steps.
#include <array>
#include <iostream>
#include <map>
#include <mutex>
#include <tuple>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "backends/registry.h"
#include "parity/verdict_runs.h"
#include "physics/core/error.h"
#include "physics/core/find_row.h"
#include "physics/engine/world_quantities.h"
#include "study/run_store.h"

namespace crossgait {
namespace {

using Json = nlohmann::json;

// What can be planted: quantities of a world (world_quantities) by a factor, or set where it says so.
struct Plant {
  std::string_view name;
  std::vector<std::string_view> quantities;
  bool is_value = false;
};

const std::vector<Plant> kPlants{{"friction", {"friction"}}, {"mass", {"mass"}},
                                 {"stiffness", {"kp"}},      {"damping", {"kd", "damping"}},
                                 {"delay", {"delay"}, true}, {"slope", {"slope"}, true},
                                 {"gravity", {"gravity"}}};

void plant(const Plant& what, double value, WorldSpec& world) {
  for (const std::string_view quantity : what.quantities)
    QuantityChange{&find_world_quantity(quantity, "request"), {value}, !what.is_value}.apply(world);
}

// Keys are taken out as they are read: what is left over nobody knows.
template <typename T>
T take(Json& from, const char* key, T otherwise) {
  if (!from.contains(key)) return otherwise;
  T value = from.at(key).get<T>();
  from.erase(key);
  return value;
}

void expect_all_taken(const Json& request, const char* what) {
  if (!request.empty()) throw ConfigError("request", what, "known keys", request.begin().key());
}

LoadedBehaviour load(Json setup) {
  StartRanges ranges;
  if (setup.contains("push")) ranges.push_mps = take(setup, "push", 0.0);
  if (setup.contains("offset")) ranges.position_m = take(setup, "offset", 0.0);
  ranges.heading_rad = take(setup, "heading", ranges.heading_rad);
  const auto seed = take<std::uint64_t>(setup, "seed", 0);
  if (setup.contains("config")) {
    const auto file = take<std::string>(setup, "config", ""),
               policy = take<std::string>(setup, "policy", "zero");
    expect_all_taken(setup, "setup");
    return {PolicyConfig{load_env_config(file), policy}, ranges, seed};
  }
  WalkConfig walk;
  walk.robot = take(setup, "robot", walk.robot);
  walk.terrain = take(setup, "terrain", walk.terrain);
  walk.terrain_seed = seed;
  walk.timing.seconds = take(setup, "seconds", walk.timing.seconds);
  if (setup.contains("friction"))
    walk.contact.set("friction", {take(setup, "friction", 0.0)}, "request", "friction");
  std::optional<VelocityCommand> command;
  if (setup.contains("speed")) command = VelocityCommand{take(setup, "speed", 0.0), 0, 0};
  const auto gait = take<std::string>(setup, "gait", "trot");
  expect_all_taken(setup, "setup");
  const LoadedWalk loaded(walk);
  walk.gait = choose_gait(gait, {}, command, gait_scale(*loaded.world.robot));
  return {LoadedWalk(walk, loaded.world.robot), ranges, seed};
}

/// One behaviour and its runs, in any engine, with anything planted.
class Pool {
 public:
  Pool(const Json& setup, std::shared_ptr<RunStore> store)
      : loaded_(load(setup)),
        behaviour_(make_behaviour(loaded_)),
        keys_(keys_of(behaviour_)),
        store_(std::move(store)) {}

  const Behaviour& behaviour() const { return behaviour_; }

  /// @param party  {"engine", "planted"}
  const BehaviourRun& run(const Json& party, const Variation& variation, std::size_t start, double horizon) {
    const auto key = std::make_tuple(party.dump(), std::string(variation.name), start, horizon);
    {
      const std::lock_guard lock(mutex_);
      if (const auto made = runs_.find(key); made != runs_.end()) return made->second;
    }
    BehaviourRun run = find_or_make(party, variation, start, horizon);
    const std::lock_guard lock(mutex_);
    return runs_.emplace(key, std::move(run)).first->second;
  }

 private:
  BehaviourRun find_or_make(Json party, const Variation& variation, std::size_t start, double horizon) {
    const Json planted = take(party, "planted", Json());
    Engine engine = find_engine(take<std::string>(party, "engine", ""));
    expect_all_taken(party, "a or b");
    Json described = describe_run(loaded_.described, engine.info, variation, start, horizon);
    for (const auto& [name, value] : planted.items()) {
      described["planted"] = planted;
      engine = with_change(std::move(engine),
                           [&what = find_row(kPlants, name, "request", "planted"),
                            value = value.get<double>()](WorldSpec& spec) { plant(what, value, spec); });
    }
    if (const auto stored = store_->find(described); stored && stored->keys == keys_) return stored->run;
    BehaviourRun made = behaviour_.run(engine, variation, start, horizon);
    store_->add(described, {keys_, made});
    return made;
  }

  LoadedBehaviour loaded_;
  Behaviour behaviour_;
  std::vector<std::string> keys_;
  std::shared_ptr<RunStore> store_;
  std::mutex mutex_;
  std::map<std::tuple<std::string, std::string, std::size_t, double>, BehaviourRun> runs_;
};

// The engine of a party as the rule sees it: without settings of its own.
Engine bare_engine(const Json& party, const char* name) {
  Engine engine = find_engine(party.at("engine").get<std::string>());
  engine.info.name = name;
  engine.info.capabilities = {};
  return engine;
}

Json answer(const StatisticVerdict& v) {
  return {{"key", v.statistic.key},     {"word", name(v.word)}, {"estimand", name(v.estimand)},
          {"estimate", v.gap.estimate}, {"low", v.gap.low},     {"high", v.gap.high},
          {"margin", v.margin},         {"pairs", v.pairs}};
}

Json judge_request(Json request, Pool& pool, std::size_t workers) {
  const Json a = request.at("a"), b = request.at("b");
  const auto starts_a = request.at("starts_a").get<std::vector<std::size_t>>(),
             starts_b = request.at("starts_b").get<std::vector<std::size_t>>();
  if (starts_a.size() != starts_b.size() || starts_a.empty())
    throw ConfigError("request", "starts_b", "as many as starts_a", std::to_string(starts_b.size()));
  const bool with_differences = take(request, "differences", false),
             with_steps = take(request, "steps", true);
  VerdictOptions options;
  options.starts = starts_a.size();
  options.workers = workers;
  const Json margins = take(request, "margins", Json(Json::object()));
  for (const auto& [key, margin] : margins.items())
    options.margins[key] = {0, margin.get<double>(), false, "planted"};
  for (const char* key : {"setup", "a", "b", "starts_a", "starts_b"}) request.erase(key);
  expect_all_taken(request, "key");
  if (const auto failures = options.margins.find("failures"); failures != options.margins.end()) {
    options.failures = failures->second.absolute;
    options.margins.erase(failures);
  }

  Behaviour behaviour = with_margins(pool.behaviour(), options.margins);
  if (!with_steps) behaviour.control_dt = 0.75 * behaviour.physics_dt;  // 1.5 of half the step
  behaviour.run = [&](const Engine& engine, const Variation& variation, std::size_t k, double horizon) {
    return engine.name() == "a" ? pool.run(a, variation, starts_a[k], horizon)
                                : pool.run(b, variation, starts_b[k], horizon);
  };
  const std::array engines{bare_engine(a, "a"), bare_engine(b, "b")};
  VerdictRuns runs(behaviour, engines, options);
  std::vector<StatisticRuns> rows = runs.rows({0, 1}, options.starts, false);
  while (!runs.campaign().is_complete()) {
    runs.campaign().make_missing({});
    rows = runs.rows({0, 1}, options.starts, false);
  }
  std::erase_if(rows, [](const StatisticRuns& row) { return !row.is_defined; });
  const std::vector<StatisticVerdict> judged = judge(rows, options);
  Json statistics = Json::array();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    statistics.push_back(answer(judged[i]));
    statistics.back()["is_share"] = rows[i].is_share;
    // A median of too few has no interval of that confidence, and none is claimed.
    const double error = (1 - options.confidence) / static_cast<double>(rows.size());
    statistics.back()["has_interval"] =
        judged[i].estimand == Estimand::kMean || judged[i].pairs >= fewest_for_median(error);
    if (!with_differences) continue;
    statistics.back()["differences"] = rows[i].as_asked.differences();
    statistics.back()["early"] = rows[i].ends_early;
  }
  const std::optional<PairCut> cut = runs.cut({0, 1}, options.starts);
  return {
      {"word", name(worst_word(judged))}, {"cut_pairs", cut ? cut->pairs : 0}, {"statistics", statistics}};
}

int serve(const std::string& store_file, std::size_t workers) {
  const auto store = std::make_shared<RunStore>(store_file);
  std::unique_ptr<Pool> pool;
  std::string loaded;
  for (std::string line; std::getline(std::cin, line);) {
    const Json request = Json::parse(line);
    if (const std::string setup = request.at("setup").dump(); setup != loaded) {
      pool = std::make_unique<Pool>(request.at("setup"), store);
      loaded = setup;
    }
    std::cout << judge_request(request, *pool, workers).dump() << std::endl;  // each as soon as it is there
  }
  return 0;
}

}  // namespace
}  // namespace crossgait

int main(int count, char** arguments) {
  std::string store;
  std::size_t workers = 1;
  try {
    for (int i = 1; i < count; i += 2) {
      const std::string option = arguments[i];
      if ((option != "--runs" && option != "--workers") || i + 1 == count)
        throw crossgait::ConfigError("command line", option, "--runs STORE.jsonl or --workers N",
                                     "something else");
      if (option == "--runs") store = arguments[i + 1];
      if (option == "--workers") workers = std::stoul(arguments[i + 1]);
    }
    if (store.empty()) throw crossgait::ConfigError("command line", "--runs", "a file", "none");
    return crossgait::serve(store, workers);
  } catch (const std::exception& error) {
    std::cerr << "crossgait_judge_starts: " << error.what() << '\n';
    return 2;
  }
}
