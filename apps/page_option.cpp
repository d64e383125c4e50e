#include "apps/page_option.h"

#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/open_address.h"
#include "parity/answer.h"
#include "parity/report.h"
#include "physics/core/atomic_file.h"
#include "physics/core/error.h"

namespace crossgait::apps {

CLI::Option* PageOption::add_to(CLI::App& command, const std::string& help) {
  command_ = command.get_name();
  CLI::Option* option = add_output_option(command, "--report", path_, help)->type_name("FILE.html");
  command.add_flag("--open", open_, "Open that page in the browser; without --report it is a temporary file")
      ->group(kOutputs);
  return option;
}

void PageOption::check(const WalkConfig& config) const {
  check_length(config.timing.seconds, config.timing.control_dt, "a walk", "--seconds");
}

void PageOption::check(const EnvConfig& config) const {
  check_length(config.episode_seconds, config.policy_dt, "an episode", "--episode-seconds");
}

void PageOption::check() const {
  if (asked()) require_page();
}

void PageOption::check_length(double seconds, double dt, const char* of, const char* option) const {
  check();
  const double most = static_cast<double>(kMaxPageSteps) * dt;
  if (asked() && seconds > most) {
    throw ConfigError("command line", "--report", fmt::format("{} of at most {:g} s ({})", of, most, option),
                      fmt::format("{:g} s", seconds));
  }
}

void PageOption::write(ReportPage page, const Provenance& provenance) const {
  page.provenances.push_back(to_json(with_files_read(provenance)));
  const std::string path = path_.empty() ? temporary_file(command_ + ".html") : path_;
  write_file_atomically(path, report_html(page));
  print_written(path);
  if (open_) open_page(path);
}

RunRecording::RunRecording(std::shared_ptr<const RobotDescription> robot, const std::string& trace,
                           bool page) {
  if (!trace.empty()) file_ = std::make_unique<TraceWriter>(std::move(robot), trace);
  trace_ = trace;
  if (page) samples_.emplace(kMaxPageSteps);
}

void RunRecording::add(const TraceSample& sample) {
  if (file_) file_->add(sample);
  if (samples_) samples_->add(sample);
}

void RunRecording::finish_trace() {
  if (!file_) return;
  file_->finish();
  print_written(trace_);
}

ReportPage page_of_walks(const WorldSpec& world, const std::vector<WalkRun>& walked,
                         const std::vector<PairDifference>& pairs, std::vector<RunRecording>& recordings) {
  ReportPage page;
  const WalkRun& first = walked.front();
  page.title = fmt::format("{} on {}, {:g} s", first.gait, first.terrain, first.summary.simulated_seconds);
  Motion motion{.robot = world.robot, .terrain = world.terrain, .runs = {}, .pairs = pairs};
  for (std::size_t i = 0; i < walked.size(); ++i) {
    const EngineInfo& engine = walked[i].engine;
    const MotionSummary& summary = walked[i].summary;
    RecordedRun run{engine.name, engine.library + " " + engine.version, recordings[i].take_samples()};
    run.outcome = outcome_phrase(summary);
    run.outcome_at_s = summary.first_at_s[static_cast<std::size_t>(summary.outcome)];
    motion.runs.push_back(std::move(run));
  }
  page.tables.push_back({statistics_table(page.title, walked)});
  page.motions.push_back(std::move(motion));
  return page;
}

}  // namespace crossgait::apps
