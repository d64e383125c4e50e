#include "view/session.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "physics/core/error.h"
#include "view/gait_lane.h"
#include "view/policy_lane.h"

namespace crossgait {
namespace {

constexpr std::string_view kSessionSource = "view";

template <typename... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};
template <typename... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

void check_engines_of(const std::vector<std::string>& engines, const std::vector<std::string>& known) {
  if (engines.empty() || engines.size() > kMaxLanes) {
    throw ConfigError(kSessionSource, "engines", fmt::format("one to {}", kMaxLanes),
                      fmt::format("{}", engines.size()));
  }
  for (const std::string& engine : engines) {
    if (std::find(known.begin(), known.end(), engine) == known.end())
      throw ConfigError(kSessionSource, "engines", fmt::format("{}", fmt::join(known, ", ")), engine);
  }
}

}  // namespace

ViewSession::ViewSession(const ViewSetup& setup, EngineShelf shelf)
    : setup_(setup), shelf_(std::move(shelf)) {
  check_engines_of(setup_.engines, shelf_.names);
  for (const std::string& engine : setup_.engines) lanes_.push_back(make_lane(engine));
}

std::unique_ptr<Lane> ViewSession::make_lane(const std::string& engine) const {
  const Engine found = shelf_.find(engine);
  if (setup_.policy)
    return std::make_unique<PolicyLane>(found, setup_.policy->environment, setup_.policy->policy);
  const GaitDrive drive(setup_.world, setup_.gait);
  return std::make_unique<GaitLane>(found, setup_.world, drive, setup_.control_dt);
}

void ViewSession::apply(const ViewCommand& command) {
  std::visit(
      Overloaded{
          [this](const DriveCommand& c) { change_all([&c](Lane& lane) { lane.set_command(c.velocity); }); },
          [this](const GaitCommand& c) { change_all([&c](Lane& lane) { lane.set_gait(c.gait); }); },
          [this](const ParameterCommand& c) {
            change_all([&c](Lane& lane) { lane.set_parameter(c.name, c.value); });
          },
          [this](const CurveCommand& c) { change_all([&c](Lane& lane) { lane.set_curve(c.curve); }); },
          [this](const PushCommand& c) { push(c.impulse); },
          [this](const TerrainCommand& c) { change_terrain(c); },
          [this](const EnginesCommand& c) { choose_engines(c.engines); },
          [this](const PauseCommand& c) { paused_ = c.on; },
          [this](const StandCommand&) {
            finish_recording();
            for (const auto& lane : lanes_) lane->stand_up();
          },
          [this](const RecordCommand& c) { record(c.on); },
      },
      command);
}

// All take the same commands, so that what the first one refuses nobody has taken.
template <typename Change>
void ViewSession::change_all(const Change& change) {
  for (const auto& lane : lanes_) change(*lane);
}

void ViewSession::push(const Vector3& impulse) {
  const double most = drive_limits(*world().robot).push;
  if (!(impulse.norm() <= most)) {
    throw ConfigError(kSessionSource, "push", fmt::format("an impulse of at most {:g} N s", most),
                      fmt::format("{:g}", impulse.norm()));
  }
  for (const auto& lane : lanes_) lane->push(impulse);
}

void ViewSession::choose_engines(const std::vector<std::string>& engines) {
  check_engines_of(engines, shelf_.names);
  std::vector<std::unique_ptr<Lane>> lanes;
  for (std::size_t i = 0; i < engines.size(); ++i) {
    // A further robot begins where the first one is.
    const Lane& before = *lanes_[i < lanes_.size() ? i : 0];
    lanes.push_back(before.in(shelf_.find(engines[i])));
  }
  finish_recording();
  lanes_ = std::move(lanes);
  setup_.engines = engines;
}

void ViewSession::change_terrain(const TerrainCommand& command) {
  if (is_terrain_file(command.terrain)) {
    throw ConfigError(kSessionSource, "terrain", "a generator: files are for the command line (--terrain)",
                      command.terrain);
  }
  const Ground ground{command.terrain, command.seed};
  std::vector<std::unique_ptr<Lane>> lanes;
  for (std::size_t i = 0; i < lanes_.size(); ++i)
    lanes.push_back(lanes_[i]->on(shelf_.find(setup_.engines[i]), ground));
  finish_recording();
  lanes_ = std::move(lanes);
  setup_.terrain_seed = command.seed;
  ++scene_revision_;
}

void ViewSession::advance(int steps) {
  if (paused_) return;
  for (int i = 0; i < steps; ++i) {
    for (const auto& lane : lanes_) lane->step();
    if (recorders_.empty()) continue;
    for (std::size_t k = 0; k < lanes_.size(); ++k) {
      // Whose time stands still has ended, or made this step with the one before.
      const double time = lanes_[k]->world().state().time;
      if (std::exchange(recorded_times_[k], time) != time)
        recorders_[k].add(TraceSample(lanes_[k]->world(), lanes_[k]->targets()));
    }
    if (++recorded_steps_ == kMaxRecordedSteps) finish_recording();
  }
}

void ViewSession::record(bool on) {
  finish_recording();
  if (!on) return;
  recorders_.assign(lanes_.size(), RunRecorder(world().robot));
  recorded_times_.clear();
  for (const auto& lane : lanes_) recorded_times_.push_back(lane->world().state().time);
}

void ViewSession::finish_recording() {
  if (recorders_.empty()) return;
  std::vector<RunRecorder> recorders = std::exchange(recorders_, {});
  const std::size_t steps = std::exchange(recorded_steps_, 0);
  Motion motion{world().robot, world().terrain, {}, {}};
  for (std::size_t lane = 0; lane < lanes_.size(); ++lane) {
    if (recorders[lane].empty()) continue;
    const EngineInfo& engine = lanes_[lane]->world().info();
    motion.runs.push_back(
        {engine.name, engine.engine + " " + engine.version, recorders[lane].take(engine.name)});
  }
  if (motion.runs.empty()) return;
  ReportPage page;
  const GaitGenerator* gait = lanes_.front()->gait();
  page.title =
      fmt::format("{} on {}, {:.2f} s, driven by hand", gait != nullptr ? gait->gait().name : "a policy",
                  world().terrain.name(), static_cast<double>(steps) * setup_.control_dt);
  page.motion = std::move(motion);
  recording_ = std::make_shared<const ReportPage>(std::move(page));
  ++recordings_;
}

}  // namespace crossgait
