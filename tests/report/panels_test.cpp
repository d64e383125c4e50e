// Every panel of a motion holds its quantity of every run, frame by frame.
#include <algorithm>
#include <cmath>
#include <functional>

#include "gait/parameters.h"
#include "physics/core/math.h"
#include "tests/report/walked_motion.h"
#include "tests/support/engine_test.h"

namespace crossgait {
namespace {

using nlohmann::ordered_json;

/// What a panel of the base shows of a state, in its unit.
struct OfTheBase {
  const char* title;
  std::function<double(const RobotState&)> value;
};

std::vector<OfTheBase> panels_of_the_base() {
  const auto in_heading = [](const RobotState& s) {
    const double yaw = roll_pitch_yaw(s.q_WB).z();
    return Vector3(Eigen::AngleAxisd(-yaw, Vector3::UnitZ()) * s.v_WB);
  };
  return {{"Roll", [](const RobotState& s) { return kDegreesPerRadian * roll_pitch_yaw(s.q_WB).x(); }},
          {"Pitch", [](const RobotState& s) { return kDegreesPerRadian * roll_pitch_yaw(s.q_WB).y(); }},
          {"Height of the base", [](const RobotState& s) { return 1e3 * s.p_WB.z(); }},
          {"Speed along the heading", [=](const RobotState& s) { return in_heading(s).x(); }},
          {"Speed to the left", [=](const RobotState& s) { return in_heading(s).y(); }},
          {"Yaw rate", [](const RobotState& s) { return kDegreesPerRadian * s.w_WB.z(); }}};
}

class PanelsOfEngine : public EngineTest {
 protected:
  /// Two runs of different lengths, turning: forward is not x.
  PanelsOfEngine() {
    config_.gait = choose_gait("trot", {}, VelocityCommand{0.1, 0.05, 1.5}, gait_scale(*robot_));
    for (const double seconds : {0.6, 0.4}) {
      config_.timing.seconds = seconds;
      walked_.push_back(walk_in(GetParam(), config_));
    }
    document_ = motion_document({robot_, LoadedWalk(config_).world.terrain, walked_, {}}, numbers_);
  }

  const std::shared_ptr<const RobotDescription> robot_ = scenes::quadruped();
  WalkConfig config_ = short_rough_walk();
  std::vector<RecordedRun> walked_;
  PageNumbers numbers_;
  ordered_json document_;
};
CROSSGAIT_FOR_EVERY_BACKEND(PanelsOfEngine);

TEST_P(PanelsOfEngine, HoldEveryRunFrameByFrame) {
  std::size_t seen = 0;
  for (const ordered_json& panel : document_.at("panels")) {
    if (panel.at("group") == "differences") continue;
    std::vector<std::size_t> series_of(walked_.size());
    for (const ordered_json& series : panel.at("series")) {
      const std::size_t run = series.at("run");
      ++series_of.at(run);
      EXPECT_EQ(floats(numbers_, series.at("values")).size(), frame_rows(walked_.at(run).times()).size())
          << panel.at("title") << ", run " << run;
    }
    EXPECT_GT(series_of[0], 0U) << panel.at("title");
    EXPECT_EQ(series_of[0], series_of[1]) << panel.at("title");
    ++seen;
  }
  // Six of the base, two a foot, and of each servo its angle and its torque.
  EXPECT_EQ(seen, 6 + 2 * kLegCount + 2 * robot_->actuated_joints().size());
}

TEST_P(PanelsOfEngine, ParametersThatNeverChangeAreNamedInstead) {
  const ordered_json& constants = document_.at("constants");
  ASSERT_EQ(constants.size(), gait_parameters().size());
  for (std::size_t i = 0; i < constants.size(); ++i) {
    const ParameterRow& row = gait_parameters()[i];
    EXPECT_EQ(constants.at(i).at("value"), *walked_[0].samples.front().parameters.*row.member) << row.name;
    EXPECT_EQ(constants.at(i).at("unit"), row.unit) << row.name;
  }
}

TEST_P(PanelsOfEngine, ParametersThatChangeOrDifferHaveAPanel) {
  const auto panels = [this](const RecordedRun& a, const RecordedRun& b) {
    const ordered_json document = motion_document({robot_, {}, {a, b}, {}}, numbers_);
    std::vector<std::string> titles;
    for (const ordered_json& panel : document.at("panels")) {
      if (panel.at("group") == "parameters") titles.push_back(panel.at("title"));
    }
    return titles;
  };
  using Titles = std::vector<std::string>;
  RecordedRun higher = walked_[0];
  higher.samples.back().parameters->step_height += 1e-3;
  EXPECT_EQ(panels(higher, walked_[1]), Titles{"step height"});
  // Of nobody's gait, as other programs may write it.
  RecordedRun bold = walked_[1];
  bold.columns.push_back({"param.boldness", std::vector<double>(bold.samples.size(), 1)});
  EXPECT_EQ(panels(walked_[0], bold), Titles{});
  bold.columns.back().values.back() += 1;
  EXPECT_EQ(panels(walked_[0], bold), Titles{"boldness"});
}

TEST_P(PanelsOfEngine, OfTheBaseAreWhatItsStatesSay) {
  for (const auto& [title, value] : panels_of_the_base()) {
    const auto& panels = document_.at("panels");
    const auto panel = std::find_if(panels.begin(), panels.end(),
                                    [title = title](const auto& p) { return p.at("title") == title; });
    ASSERT_NE(panel, panels.end()) << title;
    for (std::size_t run = 0; run < walked_.size(); ++run) {
      const std::vector<double> shown = floats(numbers_, panel->at("series").at(run).at("values"));
      const std::vector<std::size_t> rows = frame_rows(walked_[run].times());
      ASSERT_EQ(shown.size(), rows.size()) << title;
      for (std::size_t frame = 0; frame < rows.size(); ++frame) {
        const double truth = value(walked_[run].samples[rows[frame]].state);
        // Floats have 7 digits; a trace's quaternion is turned into angles and back: 1e-5 of the unit
        // besides.
        EXPECT_NEAR(shown[frame], truth, 1e-5 + 1e-6 * std::abs(truth)) << title << ", frame " << frame;
      }
    }
  }
}

}  // namespace
}  // namespace crossgait
