// `--report FILE.html` of the commands that walk, and what they put into the page.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "apps/command.h"
#include "env/env_config.h"
#include "parity/comparison.h"
#include "report/page.h"
#include "study/walk_config.h"

namespace crossgait::apps {

class PageOption {
 public:
  CLI::Option* add_to(
      CLI::App& command,
      const std::string& help = "Write a page that replays it in 3D, with plots, as one HTML file");
  bool asked() const { return !path_.empty(); }

  /// Before anything long. @throws ConfigError if no page could be made, or of so long a walk
  void check(const WalkConfig& config) const;
  void check(const EnvConfig& config) const;
  void check() const;
  void write(ReportPage page, const Provenance& provenance) const;

 private:
  void check_length(double seconds, double dt, const char* of, const char* option) const;

  std::string path_;
};

/// Keeps the steps of every run for a page.
class PageRecorder {
 public:
  /// @param runs  how many there are
  PageRecorder(const WorldSpec& world, std::size_t runs);
  void add(std::size_t run, const TraceSample& sample) { recorders_[run].add(sample); }

  /// @param walked  the runs, in the same order; the recorder is empty then
  ReportPage page(const std::vector<WalkRun>& walked, const std::vector<PairDifference>& pairs);

 private:
  std::shared_ptr<const RobotDescription> robot_;
  Terrain terrain_;
  std::vector<RunRecorder> recorders_;
};

}  // namespace crossgait::apps
