// `--report FILE.html` of the commands that walk, and what they put into the page.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/command.h"
#include "env/env_config.h"
#include "motion/trace.h"
#include "parity/comparison.h"
#include "report/page.h"
#include "study/walk_config.h"

namespace crossgait::apps {

class PageOption {
 public:
  CLI::Option* add_to(
      CLI::App& command,
      const std::string& help = "Write a page that replays it in 3D, with plots, as one HTML file");
  bool asked() const { return open_ || !path_.empty(); }

  /// Checks the page before anything long. @throws ConfigError if no page could be made, or of so long a walk
  void check(const WalkConfig& config) const;
  void check(const EnvConfig& config) const;
  void check() const;
  /// Writes the page where --report says, or where temporary files are; says so, and opens it if asked to.
  void write(ReportPage page, const Provenance& provenance) const;

 private:
  void check_length(double seconds, double dt, const char* of, const char* option) const;

  std::string path_, command_;
  bool open_ = false;
};

/// Takes the steps of one walk for `--trace` and `--report`.
class RunRecording final : public TraceSink {
 public:
  /// @param trace  the file of `--trace`; empty: none  @param page  a page is to show the walk
  /// @throws ConfigError if the file cannot be written
  RunRecording(std::shared_ptr<const RobotDescription> robot, const std::string& trace, bool page);

  void add(const TraceSample& sample) override;
  /// Returns null where nothing is asked for.
  TraceSink* sink() { return file_ || samples_ ? this : nullptr; }
  /// Closes the trace once the walk is over. @throws ConfigError if the file cannot be written
  void finish_trace();
  /// Returns what a page shows, which is gone then.
  Trace take_samples() { return samples_->take(); }

 private:
  std::unique_ptr<TraceWriter> file_;
  std::string trace_;
  std::optional<TraceRecorder> samples_;
};

/// Makes the page of walks in one world. @param recordings  of the walks, in their order
ReportPage page_of_walks(const WorldSpec& world, const std::vector<WalkRun>& walked,
                         const std::vector<PairDifference>& pairs, std::vector<RunRecording>& recordings);

}  // namespace crossgait::apps
