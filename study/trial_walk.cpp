#include "study/trial_walk.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "backends/registry.h"
#include "motion/gait_source.h"
#include "motion/statistic_rows.h"
#include "motion/walk.h"
#include "physics/core/table.h"
#include "physics/robot/actuator.h"

namespace crossgait {
namespace {

// What is worth a failure: two seconds of a good trot are far inside all of them (docs/robots-measured.md).
constexpr double kLeastSpeed = 0.7, kMostSpeed = 1.3;  // of the commanded one
constexpr double kMostTilt = 5, kMostTurn = 10;        // deg, RMS and largest
constexpr double kMostSwingContact = 0.2, kMostSaturation = 0.1;

constexpr const char* kAdvice = ": stiffer servos (kp)?";

// The statistics that tell how well a robot walks, 0 where a walk has none.
struct Column {
  StatisticSource source;
  const char* header;
  int digits;

  const StatisticRow& row() const { return statistic_row(source); }
  double value(const MotionSummary& motion) const { return number_of(row(), motion).value_or(0); }
};
const Column kColumns[] = {{&MotionSummary::rms_roll_deg, "roll, deg", 2},
                           {&MotionSummary::rms_pitch_deg, "pitch, deg", 2},
                           {&MotionSummary::heading_error_deg, "turned, deg", 1},
                           {&MotionSummary::swing_contact_ratio, "swing contact", 3},
                           {&MotionSummary::slip_per_path, "slip/path", 3}};

std::vector<std::string> complaints_of(const TrialWalk& walk) {
  std::vector<std::string> list;
  const MotionSummary& s = walk.summary;
  if (s.outcome != Outcome::kWalked)
    list.push_back(fmt::format("it {}", fmt::format(fmt::runtime(outcome_row(s.outcome).phrase),
                                                    fmt::format("{:.2f} m", s.distance_m))));
  if (!(walk.speed_ratio >= kLeastSpeed && walk.speed_ratio <= kMostSpeed))
    list.push_back(fmt::format("it went {:.2f} of the speed it was told", walk.speed_ratio));
  if (s.rms_roll_deg > kMostTilt || s.rms_pitch_deg > kMostTilt)
    list.push_back(
        fmt::format("it rolled by {:.1f} and pitched by {:.1f} deg RMS", s.rms_roll_deg, s.rms_pitch_deg));
  if (s.heading_error_deg.value_or(0) > kMostTurn)
    list.push_back(fmt::format("it turned by {:.0f} deg", *s.heading_error_deg));
  if (s.swing_contact_ratio.value_or(0) > kMostSwingContact)
    list.push_back(fmt::format("its feet dragged for {:.0f} % of their swings{}",
                               100 * *s.swing_contact_ratio, kAdvice));
  if (walk.torque_limit_fraction > kMostSaturation)
    list.push_back(fmt::format("servos were at their torque limit for {:.0f} % of the time (effort)",
                               100 * walk.torque_limit_fraction));
  if (s.ik_clamped > 0)
    list.push_back(
        fmt::format("{} foot targets were out of reach (home, standing_height, joint limits)", s.ik_clamped));
  return list;
}

bool saturated(const RobotDescription& robot, const std::vector<int>& servos, const PhysicsBackend& world) {
  return std::any_of(servos.begin(), servos.end(), [&](int i) {
    const Joint& joint = robot.joint(i);
    const double torque = world.servo_torques()[i];
    return torque >= joint.effort_limit || -torque >= negative_effort(joint);
  });
}

}  // namespace

bool Trial::passed() const {
  return std::all_of(walks.begin(), walks.end(), [](const TrialWalk& w) { return w.failures.empty(); });
}

Trial try_robot(std::shared_ptr<const RobotDescription> robot, const std::vector<std::string>& engines,
                double seconds) {
  constexpr double kFroudeSpeed = 0.25;
  WorldSpec spec;
  spec.robot = robot;
  spec.contact = resolve_contact(robot->contact, {}, robot->source);
  Trial trial;
  trial.commanded_mps =
      kFroudeSpeed * std::sqrt(-spec.gravity.z() * gait_scale(*robot).length * kReferenceHeight);
  const GaitChoice trot =
      choose_gait("trot", {}, VelocityCommand{trial.commanded_mps, 0, 0}, gait_scale(*robot));
  const std::vector<int> servos = robot->actuated_joints();
  for (const std::string& engine : engines) {
    const auto world = find_engine(engine).make(spec);
    std::int64_t steps = 0, at_limit = 0;
    TrialWalk walk;
    walk.engine = engine;
    walk.summary = run_walk(*world, make_gait_controller(trot, spec), {.seconds = seconds},
                            [&](const WalkSample& sample) {
                              ++steps;
                              at_limit += saturated(*robot, servos, sample.world);
                              return true;
                            });
    walk.speed_ratio = walk.summary.mean_speed_mps / trial.commanded_mps;
    if (steps > 0) walk.torque_limit_fraction = static_cast<double>(at_limit) / static_cast<double>(steps);
    walk.failures = complaints_of(walk);
    trial.walks.push_back(std::move(walk));
  }
  return trial;
}

Trial without_advice(Trial trial) {
  for (TrialWalk& walk : trial.walks) {
    for (std::string& failure : walk.failures) {
      if (failure.ends_with(kAdvice)) failure.erase(failure.size() - std::string_view(kAdvice).size());
    }
  }
  return trial;
}

nlohmann::ordered_json to_json(const Trial& trial) {
  nlohmann::ordered_json json{{"commanded_mps", trial.commanded_mps},
                              {"walks", nlohmann::ordered_json::array()}};
  for (const TrialWalk& walk : trial.walks) {
    const MotionSummary& s = walk.summary;
    json["walks"].push_back(
        {{"engine", walk.engine}, {"outcome", name(s.outcome)}, {"speed_ratio", walk.speed_ratio}});
    nlohmann::ordered_json& entry = json["walks"].back();
    for (const Column& column : kColumns) entry[std::string(column.row().key)] = column.value(s);
    entry["torque_limit_fraction"] = walk.torque_limit_fraction;
    entry["failures"] = walk.failures;
  }
  return json;
}

std::string describe(const Trial& trial) {
  std::vector<std::string> header{"trot", "outcome", "speed over told"};
  for (const Column& column : kColumns) header.emplace_back(column.header);
  header.emplace_back("at torque limit");
  Table table(std::move(header));
  std::string wrong;
  for (const TrialWalk& walk : trial.walks) {
    const MotionSummary& s = walk.summary;
    std::vector<std::string> cells{walk.engine, std::string(outcome_row(s.outcome).words),
                                   fmt::format("{:.2f}", walk.speed_ratio)};
    for (const Column& column : kColumns)
      cells.push_back(fmt::format("{:.{}f}", column.value(s), column.digits));
    cells.push_back(fmt::format("{:.0f} %", 100 * walk.torque_limit_fraction));
    table.add_row(std::move(cells));
    for (const std::string& failure : walk.failures) wrong += fmt::format("{}: {}\n", walk.engine, failure);
  }
  return fmt::format("{}\nTold to go at {:.2f} m/s, 0.25 sqrt(g h).\n{}", table.str(), trial.commanded_mps,
                     wrong.empty() ? "Nothing is wrong.\n" : wrong);
}

}  // namespace crossgait
