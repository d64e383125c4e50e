#include "benchmarks/bench.h"

#include <algorithm>
#include <cmath>
#include <thread>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "backends/registry.h"
#include "benchmarks/accuracy.h"
#include "benchmarks/convergence.h"
#include "benchmarks/feet.h"
#include "benchmarks/machine.h"
#include "benchmarks/regression.h"
#include "benchmarks/scaling.h"
#include "benchmarks/speed.h"
#include "physics/core/error.h"
#include "physics/core/schema.h"
#include "physics/core/text.h"
#include "scenes/analytic.h"
#include "scenes/incline.h"

namespace crossgait::benchmarks {
namespace {

using nlohmann::ordered_json;

void set(ordered_json& record, const std::string& key, const Quartiles& value) {
  record[key] = value.median;
  record[key + "_quartiles"] = {value.low, value.high};
}

// JSON has no NaN.
ordered_json number_or_null(double value) { return std::isfinite(value) ? ordered_json(value) : nullptr; }
ordered_json number_or_null(const std::optional<double>& value) {
  return value ? ordered_json(*value) : nullptr;
}

ordered_json speed(const BenchOptions& options, const Progress& progress) {
  ordered_json result{
      {"scenes", ordered_json::array()}, {"eta", ordered_json::array()}, {"threads", ordered_json::array()}};
  for (const SpeedScene& scene : speed_scenes(options.robot)) result["summaries"][scene.name] = scene.summary;
  constexpr double kStep = 1e-3;  // of WorldSpec
  SpeedSettings settings{.engines = options.engines, .robot = options.robot};
  if (options.quick) settings.rounds = 5;
  for (const SceneSpeed& s : measure_speed(settings, part_of(progress, 0, 0.5))) {
    ordered_json record{{"scene", s.scene}, {"engine", s.engine}, {"contacts", s.contacts}};
    set(record, "us_per_step", s.us_per_step);
    set(record, "ratio", s.ratio);
    record["steps_per_core_second"] = 1e6 / s.us_per_step.median;
    record["real_time_factor"] = kStep * 1e6 / s.us_per_step.median;
    result["scenes"].push_back(std::move(record));
  }
  OverheadSettings overhead{.engines = options.engines, .robot = options.robot};
  if (options.quick) overhead.rounds = 3;
  for (const Overhead& o : measure_overhead(overhead, part_of(progress, 0.5, 0.7))) {
    ordered_json record{{"terrain", o.terrain}, {"engine", o.engine}};
    set(record, "eta", o.eta);
    record["walk_us_per_step"] = o.walk_us;
    record["engine_us_per_step"] = o.alone_us;
    result["eta"].push_back(std::move(record));
  }
  ScalingSettings scaling{.engines = options.engines, .robot = options.robot};
  scaling.max_threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  if (options.quick) scaling.rounds = 3, scaling.repeats = 2;
  for (const ThreadSpeed& t : measure_scaling(scaling, part_of(progress, 0.7, 1))) {
    ordered_json record{{"engine", t.engine}, {"threads", t.threads}};
    record["steps_per_second"] = t.steps_per_second;
    set(record, "efficiency", t.efficiency);
    result["threads"].push_back(std::move(record));
  }
  return result;
}

ordered_json accuracy(const BenchOptions& options, const Progress& progress) {
  AccuracySettings settings{.engines = options.engines, .robot = options.robot};
  if (options.quick) settings.rounds = 1;
  const Accuracy measured = measure_accuracy(settings, progress);
  ordered_json result{{"command_step_s", kCommandStep},  {"reference_step_s", kReferenceStep},
                      {"horizon_s", kAccuracyHorizon},   {"stability_horizon_s", kStabilityHorizon},
                      {"points", ordered_json::array()}, {"stable_steps", ordered_json::array()}};
  for (const AccuracyPoint& p : measured.points) {
    result["points"].push_back({{"terrain", p.terrain},
                                {"engine", p.engine},
                                {"step_s", p.step_s},
                                {"position_error_m", number_or_null(p.position_error_m)},
                                {"joint_error_rad", number_or_null(p.joint_error_rad)},
                                {"cost", p.cost},
                                {"cost_ratio", p.cost_ratio}});
  }
  for (const StableStep& s : measured.stable) {
    result["stable_steps"].push_back({{"terrain", s.terrain},
                                      {"engine", s.engine},
                                      {"largest_s", number_or_null(s.largest_s)},
                                      {"tried_s", s.tried_s}});
  }
  return result;
}

ordered_json analytic(const BenchOptions& options, const Progress& progress) {
  ordered_json result{{"convergence", ordered_json::array()},
                      {"friction", ordered_json::array()},
                      {"rebound", ordered_json::array()}};
  for (const Convergence& c : measure_convergence(options.engines, part_of(progress, 0, 0.5))) {
    result["convergence"].push_back({{"quantity", c.quantity},
                                     {"unit", c.unit},
                                     {"engine", c.engine},
                                     {"order", number_or_null(c.order)},
                                     {"step_s", c.step_s},
                                     {"error", c.error}});
  }
  const std::vector<std::pair<const char*, scenes::MakeIncline>> grounds{
      {"plane", scenes::tilted_gravity}, {"height field", scenes::inclined_field}};
  for (const auto& [ground, make_incline] : grounds) {
    for (const std::string& engine : options.engines) {
      const scenes::FrictionCone cone = scenes::measure_friction_cone(find_engine(engine), make_incline);
      result["friction"].push_back({{"ground", ground},
                                    {"engine", engine},
                                    {"creep_inside_mps", cone.creep_speed},
                                    {"distance_error_outside", cone.distance_error},
                                    {"range_over_headings", cone.range},
                                    {"off_line", cone.off_line}});
      progress(0.5 + 0.5 * static_cast<double>(result["friction"].size()) /
                         static_cast<double>(grounds.size() * options.engines.size()));
    }
  }
  constexpr double kStep = 1e-3;  // s
  for (const std::string& engine : options.engines) {
    result["rebound"].push_back({{"engine", engine},
                                 {"step_s", kStep},
                                 {"share_of_speed", scenes::rebound(find_engine(engine), kStep)}});
  }
  return result;
}

ordered_json feet(const BenchOptions& options, const Progress& progress) {
  ordered_json result = ordered_json::array();
  FeetSettings settings{.engines = options.engines, .robot = options.robot};
  if (options.quick) settings.stand_seconds = 10;
  for (const FootCard& c : measure_feet(settings, progress)) {
    result.push_back({{"terrain", c.terrain},
                      {"engine", c.engine},
                      {"stand_seconds", c.stand_seconds},
                      {"creep_mps", c.creep_mps},
                      {"penetration_m", c.penetration_m},
                      {"force_error", c.force_error},
                      {"strides", c.strides},
                      {"touchdowns", c.touchdowns},
                      {"touchdown_impulse_Ns", c.touchdown_impulse},
                      {"touchdown_peak_over_weight", c.touchdown_peak},
                      {"slip_per_stride_m", c.slip_per_stride_m},
                      {"toe_drag_per_stride_m", c.toe_drag_per_stride_m},
                      {"deepest_penetration_m", c.deepest_m}});
  }
  return result;
}

struct Section {
  const char* name;
  ordered_json (*measure)(const BenchOptions& options, const Progress& progress);
  double effort;  // roughly, for the progress
};
constexpr std::array<Section, 4> kSections{
    {{"speed", speed, 6}, {"accuracy", accuracy, 6}, {"analytic", analytic, 0.3}, {"feet", feet, 2}}};

void check_once(const std::vector<std::string>& given, const char* option) {
  for (auto it = given.begin(); it != given.end(); ++it) {
    if (std::find(given.begin(), it, *it) != it) {
      throw ConfigError("benchmark", option, "each once", "\"" + *it + "\" again");
    }
  }
}

void check_sections(const std::vector<std::string>& given) {
  const std::vector<std::string>& known = bench_sections();
  for (const std::string& name : given) {
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      throw ConfigError("benchmark", "section", fmt::format("one of {}", fmt::join(known, ", ")),
                        "\"" + name + "\"");
    }
  }
  check_once(given, "section");
}

}  // namespace

const std::vector<std::string>& bench_sections() {
  static const std::vector<std::string> kNames = [] {
    std::vector<std::string> names;
    for (const Section& section : kSections) names.emplace_back(section.name);
    return names;
  }();
  return kNames;
}

ordered_json run_bench(const BenchOptions& options, const Progress& progress) {
  for (const std::string& name : options.engines) find_engine(name);  // says what is wrong with a name
  check_once(options.engines, "engine");
  check_sections(options.sections);
  if (!options.robot->legs) {
    throw ConfigError("benchmark", "robot", "four legs", "'" + options.robot->name + "', which has none");
  }
  if (options.engines.empty()) throw ConfigError("benchmark", "engine", "at least one engine", "none");

  ordered_json result = with_schema("bench", {{"quick", options.quick}});
  result["machine"] = describe_machine();
  result["robot"] = options.robot->name;
  result["engines"] = ordered_json::array();
  for (const std::string& name : options.engines) {
    const EngineInfo info = make_world(name, scenes::world_of(options.robot))->info();
    result["engines"].push_back(
        {{"name", name}, {"library", info.library}, {"version", info.version}, {"mode", info.mode}});
  }
  const auto wanted = [&options](const char* name) {
    return options.sections.empty() ||
           std::find(options.sections.begin(), options.sections.end(), name) != options.sections.end();
  };
  double all = 0, done = 0;
  for (const Section& section : kSections) all += wanted(section.name) ? section.effort : 0;
  for (const Section& section : kSections) {
    if (!wanted(section.name)) continue;
    const double after = done + section.effort;
    try {
      result[section.name] = section.measure(options, part_of(progress, done / all, after / all));
    } catch (const Interrupted&) {
      result["interrupted"] = true;
      break;
    }
    done = after;
  }
  result["machine"]["load_at_end"] = describe_machine().value("load", 0.0);
  return result;
}

ordered_json read_bench(const std::string& path) {
  const std::string text = read_text_file(path, kJsonBudget);
  check_json_budget(text, kJsonBudget, path);
  ordered_json result = ordered_json::parse(text, nullptr, false);
  const ordered_json expected = schema("bench");
  if (!result.is_object() || result.value("schema", ordered_json()) != expected) {
    const bool has = result.is_object() && result.contains("schema");
    throw ConfigError(path, "schema", expected.dump(),
                      result.is_discarded() ? "no JSON"
                      : has                 ? result.at("schema").dump()
                                            : "none");
  }
  try {  // whatever is made of a result later reads these keys
    if (result.at("engines").empty()) throw ConfigError(path, "engines", "at least one", "none");
    describe_bench(result);
    comparable_figures(result);
  } catch (const ordered_json::exception& error) {
    throw ConfigError(path, "contents", "the keys of a result of `crossgait bench`", json_error_text(error));
  }
  return result;
}

}  // namespace crossgait::benchmarks
