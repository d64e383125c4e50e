// What a page plots over time, in units for people.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "report/page_numbers.h"
#include "report/recorded_run.h"

namespace crossgait {

struct Motion;

/// Holds how far two runs lie apart, per frame of the first.
struct PairPanels {
  std::vector<double> position_m, joint_rad, attitude_rad;
};

/// Makes the list of panels: objects with `group` (base, feet, joints, parameters,
/// rewards, differences), `title`,
/// `unit`, `log` and `series`; those of a leg say which (`leg`). A series has `run` (its time and colour),
/// `label`, `dashed` and `values`, one per frame or fewer; one of differences has `other`, too, the second
/// run.
class PanelMaker {
 public:
  /// Takes what stays the caller's. @param frames  of each run
  PanelMaker(const Motion& motion, const std::vector<RunFrames>& frames, PageNumbers& numbers);

  void add_pair(std::size_t a, std::size_t b, const PairPanels& differences);
  nlohmann::ordered_json finish();
  /// Returns the gait parameters that no run changes and all share: objects with `name`, `unit` and `value`.
  const nlohmann::ordered_json& constants() const { return constants_; }

 private:
  struct Series {
    std::size_t run;
    std::string label;
    bool dashed;
    std::vector<double> values;
  };
  void add(const char* group, const std::string& title, const std::string& unit,
           const std::vector<Series>& series, std::string_view leg = {});
  /// A number of a run's sample `row`; none where the run does not know it.
  using Value = std::function<std::optional<double>(const RecordedRun& run, std::size_t row)>;
  /// Makes one series of every run that knows the value, times `scale`.
  std::vector<Series> series_of(const Value& value, double scale, const std::string& label = {},
                                bool dashed = false) const;
  void add_base();
  void add_feet();
  void add_joints();
  void add_parameters();
  void add_rewards();

  const Motion& motion_;
  const std::vector<RunFrames>& frames_;
  PageNumbers& numbers_;
  nlohmann::ordered_json panels_ = nlohmann::ordered_json::array();
  nlohmann::ordered_json constants_ = nlohmann::ordered_json::array();
  nlohmann::ordered_json differences_;  // three panels, to which pairs add their series
};

}  // namespace crossgait
