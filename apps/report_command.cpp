// crossgait report: stored results and traces as a page that replays in 3D.
#include <algorithm>
#include <filesystem>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/recorded_command.h"
#include "parity/stances.h"
#include "physics/core/atomic_file.h"
#include "physics/core/error.h"
#include "physics/core/read_budget.h"
#include "physics/core/schema.h"
#include "physics/core/table.h"
#include "physics/robot_files/data_path.h"
#include "report/page.h"
#include "report/verdict_document.h"

namespace crossgait::apps {
namespace {

using Json = nlohmann::json;

struct ReportCommand {
  std::vector<std::string> files;
  std::string out, robot = "scara_quadruped", terrain = "flat";
  std::uint64_t seed = 0;
  double shortest_contact = kShortestContact;  // of traces, s
};

// A page of these shows more than the result says, for which they are made again.
const std::set<std::string> kMadeAgain{"walk", "compare",   "rollout",  "transfer", "tune",
                                       "gait", "workspace", "diagnose", "course"};
constexpr const char* kResults =
    "walk, compare, verdict, rollout, transfer, tune, gait, workspace, diagnose, course or bench";

std::string schema_of(const Recorded& recorded) {
  try {
    return recorded.result.at("schema").at("name").get<std::string>();
  } catch (const Json::exception& problem) {
    throw ConfigError(recorded.file, "schema", "a result as `--json` writes it", problem.what());
  }
}

// "rms_roll_deg" stays as it is: its unit is in its name.
std::string cell(const Json& value) {
  if (value.is_number_float()) return fmt::format("{:.6g}", value.get<double>());
  return value.is_string() ? value.get<std::string>() : value.is_null() ? "-" : value.dump();
}

// Of runs as `walk` and `compare` write them.
Table table_of(const std::vector<Json>& runs, const std::string& file) {
  try {
    const Json& first = runs.at(0);
    std::vector<std::string> header{
        fmt::format("{} on {}", first.at("gait").get<std::string>(), first.at("terrain").get<std::string>())};
    for (const Json& run : runs) header.push_back(run.at("engine").get<std::string>());
    Table table(std::move(header));
    for (const auto& [key, value] : first.items()) {
      if (value.is_structured() || key == "engine" || key == "gait" || key == "terrain") continue;
      std::vector<std::string> row{key};
      for (const Json& run : runs) row.push_back(cell(run.at(key)));
      table.add_row(std::move(row));
    }
    return table;
  } catch (const std::exception& problem) {
    throw ConfigError(file, "runs", "those of `crossgait walk` or `compare`", problem.what());
  }
}

void add_result(ReportPage& page, const Recorded& recorded) {
  const Json& result = recorded.result;
  const std::string kind = schema_of(recorded);
  if (result.contains("provenance")) page.provenances.emplace_back(result.at("provenance"));
  if (kind == "verdict") {
    verdict_document(result, recorded.file).add_to(page);
  } else if (kind == "walk") {
    page.tables.push_back({table_of({result}, recorded.file)});
  } else if (kind == "compare") {
    page.tables.push_back({table_of(result.value("runs", std::vector<Json>()), recorded.file)});
    if (result.contains("verdict")) verdict_document(result.at("verdict"), recorded.file).add_to(page);
  } else {
    throw ConfigError(
        recorded.file, "schema.name",
        kMadeAgain.contains(kind) ? "a result to stand beside others: walk, compare or verdict" : kResults,
        kind);
  }
}

bool is_trace(const std::string& file) { return std::filesystem::path(file).extension() == ".csv"; }

Motion motion_of(const ReportCommand& options, const std::vector<std::string>& traces) {
  Motion motion{.robot = std::make_shared<const RobotDescription>(load_robot_with_warnings(options.robot)),
                .terrain = make_terrain(options.terrain, options.seed),
                .runs = {},
                .shortest_contact = options.shortest_contact};
  for (const std::string& file : traces) {
    motion.runs.push_back(
        recorded_run(std::filesystem::path(file).stem().string(), TraceTable(file), *motion.robot));
  }
  return motion;
}

std::string title_of(const ReportPage& page) {
  if (!page.verdicts.empty()) return page.verdicts.front().at("behaviour").get<std::string>();
  if (!page.tables.empty()) return page.tables.front().table.rows().front().front();
  std::vector<std::string> names;
  for (const RecordedRun& run : page.motions.front().runs) names.push_back(run.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

/// @param program  with all commands
void run(const ReportCommand& options, const CLI::App& program, Invocation& invocation) {
  require_page();
  std::vector<std::string> traces;
  std::vector<Recorded> results;
  for (const std::string& file : options.files) {
    if (is_trace(file)) {
      traces.push_back(file);
    } else {
      results.push_back(read_recorded(file));
    }
  }
  const std::string kind = results.size() == 1 && traces.empty() ? schema_of(results.front()) : "";
  if (kind == "bench") {
    // A measurement cannot be made again: it is shown as it was measured.
    invocation.next = {{"", {"bench", "--from=" + results.front().file, "--report=" + options.out}}};
    return;
  }
  if (kMadeAgain.contains(kind)) {
    // A run is the same to the last bit when it is made again, which is how its motion is known.
    std::vector<std::string> again = recorded_command(program, results.front());
    if (again.front() != kind)
      throw ConfigError(results.front().file, "provenance.command", kind, again.front());
    again.push_back("--report=" + options.out);
    invocation = {{{"", std::move(again)}}, std::move(results.front())};
    return;
  }
  ReportPage page;
  for (const Recorded& recorded : results) add_result(page, recorded);
  if (!traces.empty()) page.motions.push_back(motion_of(options, traces));
  page.title = title_of(page);
  const std::string html = report_html(page);
  write_file_atomically(options.out, html);
  print(fmt::format("{}: {}, {} and {}\n", options.out, page.title, counted(traces.size(), "trace"),
                    counted(results.size(), "result")));
  print_written(options.out);
}

}  // namespace

void add_report_command(CLI::App& program, Invocation& invocation) {
  CLI::App* command = program.add_subcommand(
      "report", "A page that replays walks in 3D, with plots, or shows a verdict: one HTML file");
  command->footer(
      "\nOne result of `walk`, `compare`, `rollout`, `transfer`, `tune`, `gait` or `workspace` is made "
      "again, as "
      "`crossgait rerun`\ndoes, and shown; those commands write the page at once with --report. Traces "
      "(--trace) are "
      "replayed as "
      "they are, on the\nrobot and ground of the options, together with the numbers of results beside them.\n"
      "\nExamples:\n"
      "  crossgait compare --terrain rough --report compare.html\n"
      "  crossgait compare --terrain rough --json compare.json && crossgait report compare.json --out "
      "compare.html\n"
      "  crossgait report walk.mujoco.csv walk.bullet.csv --terrain rough --out traces.html\n"
      "  crossgait verdict --explain --json verdict.json && crossgait report verdict.json --out "
      "verdict.html");
  auto options = std::make_shared<ReportCommand>();
  command
      ->add_option("files", options->files,
                   "Results (--json of walk, compare, verdict, rollout, transfer, tune, bench, gait, "
                   "workspace) and traces (--trace)")
      ->type_name("FILE.json|TRACE.csv")
      ->required();
  add_output_option(*command, "--out", options->out, "The page")->type_name("FILE.html")->required();
  add_robot_option(*command, options->robot);
  command->add_option("--terrain", options->terrain, "The ground that traces walked on")
      ->type_name("NAME[:k=v,...]|FILE.png|FILE.csv")
      ->capture_default_str();
  add_seed_option(*command, "--seed", options->seed, "Seed of a random terrain")->capture_default_str();
  command
      ->add_option(
          "--shortest-contact", options->shortest_contact,
          "Touches of traces, and gaps between them, that the gait diagram leaves out if they are shorter, s")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  on_run(*command, [options, &program, &invocation] { run(*options, program, invocation); });
}

}  // namespace crossgait::apps
