#include "crossgait/apps/page_option.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "crossgait/parity/report.h"
#include "crossgait/physics/atomic_file.h"
#include "crossgait/physics/error.h"

namespace crossgait::apps {

void PageOption::add_to(CLI::App& command, const std::string& help) {
  add_output_option(command, "--report", path_, help)->type_name("FILE.html");
}

void PageOption::check(const WalkConfig& config) const {
  if (!asked()) return;
  require_page();
  if (const double most = static_cast<double>(kMaxPageSteps) * config.timing.control_dt;
      config.timing.seconds > most) {
    throw ConfigError("command line", "--report", fmt::format("a walk of at most {:g} s (--seconds)", most),
                      fmt::format("{:g} s", config.timing.seconds));
  }
}

void PageOption::write(const ReportPage& page) const { write_file_atomically(path_, report_html(page)); }

PageRecorder::PageRecorder(const WalkConfig& config, std::size_t runs) {
  const WorldSpec world = config.world();
  robot_ = world.robot;
  terrain_ = world.terrain;
  for (std::size_t i = 0; i < runs; ++i) recorders_.emplace_back(robot_);
}

ReportPage PageRecorder::page(const std::vector<WalkRun>& walked, const std::vector<PairDifference>& pairs) {
  ReportPage page;
  const WalkRun& first = walked.front();
  page.title = fmt::format("{} on {}, {:g} s", first.gait, first.terrain, first.summary.simulated_seconds);
  StatisticsTable& table = page.tables.emplace_back();
  table.header = {page.title};
  Motion motion{robot_, terrain_, {}, pairs};
  for (std::size_t i = 0; i < walked.size(); ++i) {
    const EngineInfo& engine = walked[i].engine;
    table.header.push_back(engine.name);
    motion.runs.push_back(
        {engine.name, engine.engine + " " + engine.version, recorders_[i].take(engine.name)});
  }
  table.rows = statistics_table(walked);
  page.motion = std::move(motion);
  return page;
}

}  // namespace crossgait::apps
