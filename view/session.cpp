#include "view/session.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "physics/core/error.h"
#include "view/gait_instance.h"
#include "view/policy_instance.h"

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
  if (engines.empty() || engines.size() > kMaxInstances) {
    throw ConfigError(kSessionSource, "engines", fmt::format("one to {}", kMaxInstances),
                      fmt::format("{}", engines.size()));
  }
  for (const std::string& engine : engines) {
    if (std::find(known.begin(), known.end(), engine) == known.end())
      throw ConfigError(kSessionSource, "engines", fmt::format("{}", fmt::join(known, ", ")), engine);
  }
}

void require_one_of(const std::string& name, const std::vector<std::string>& known, const char* element) {
  if (std::find(known.begin(), known.end(), name) == known.end())
    throw ConfigError(kSessionSource, element, fmt::format("one of {}", fmt::join(known, ", ")),
                      fmt::format("'{}'", name));
}

constexpr double kLeastPace = 0.01;
constexpr double kFarthestPull = 1e4;  // m, as heights of terrains

void require_within(double value, double least, double most, const char* element) {
  if (!(value >= least && value <= most))
    throw ConfigError(kSessionSource, element, fmt::format("{:g} to {:g}", least, most),
                      fmt::format("{:g}", value));
}

}  // namespace

ViewSession::ViewSession(const ViewSetup& setup, EngineProvider provider, SubjectProvider subjects)
    : setup_(setup),
      provider_(std::move(provider)),
      subjects_(std::move(subjects)),
      history_(setup.control_dt) {
  check_engines_of(setup_.engines, provider_.names);
  instances_ = make_instances(setup_);
  nominal_ = world();
  scene_ = scene_of(world(), scene_revision_);
}

RobotInstances ViewSession::make_instances(const ViewSetup& setup) const {
  RobotInstances instances;
  for (const std::string& name : setup.engines) {
    const Engine engine = provider_.find(name);
    if (setup.policy) {
      instances.push_back(
          std::make_unique<PolicyInstance>(engine, setup.policy->environment, setup.policy->policy));
    } else {
      const GaitDrive drive(setup.world, setup.gait);
      instances.push_back(std::make_unique<GaitInstance>(engine, setup.world, drive, setup.control_dt));
    }
  }
  return instances;
}

void ViewSession::apply(const ViewCommand& command) {
  std::visit(Overloaded{
                 [this](const DriveCommand& c) {
                   change_all([&c](RobotInstance& instance) { instance.set_command(c.velocity); });
                 },
                 [this](const GaitCommand& c) {
                   change_all([&c](RobotInstance& instance) { instance.set_gait(c.gait); });
                 },
                 [this](const ParameterCommand& c) {
                   change_all([&c](RobotInstance& instance) { instance.set_parameter(c.name, c.value); });
                 },
                 [this](const CurveCommand& c) {
                   change_all([&c](RobotInstance& instance) { instance.set_curve(c.curve); });
                 },
                 [this](const PushCommand& c) { push(c.impulse); },
                 [this](const TerrainCommand& c) { change_terrain(c); },
                 [this](const EnginesCommand& c) { choose_engines(c.engines); },
                 [this](const PauseCommand& c) { paused_ = c.on; },
                 [this](const StepCommand& c) {
                   if (!paused_)
                     throw ConfigError(kSessionSource, "step", "a session that is paused", "one that runs");
                   require_within(static_cast<double>(c.steps), 1, static_cast<double>(kMostStepsAtOnce),
                                  "steps");
                   for (std::uint64_t i = 0; i < c.steps; ++i) step_once();
                 },
                 [this](const PaceCommand& c) {
                   require_within(c.pace, kLeastPace, 1, "pace");
                   pace_ = c.pace;
                 },
                 [this](const BackCommand& c) {
                   require_within(c.seconds, 0, history_.seconds(), "back, s");
                   finish_recording();
                   history_.back(c.seconds, instances_);
                 },
                 [this](const ChangeCommand& c) { change_world(c.changes); },
                 [this](const PullCommand& c) {
                   for (const double to : c.to) require_within(to, -kFarthestPull, kFarthestPull, "pull, m");
                   pulled_to_ = c.to;
                 },
                 [this](const ReleaseCommand&) { pulled_to_.reset(); },
                 [this](const KeepCommand&) {
                   finish_recording();
                   publish(history_.traces(), history_.seconds());
                 },
                 [this](const StandCommand&) {
                   finish_recording();
                   history_.forget();
                   for (const auto& instance : instances_) instance->stand_up();
                 },
                 [this](const RecordCommand& c) { record(c.on); },
                 [this](const RobotCommand& c) { choose_robot(c.robot); },
                 [this](const PolicyCommand& c) { choose_policy(c.policy); },
                 [this](const SubjectCommand& c) { change_subject(c.subject); },
             },
             command);
}

// All take the same commands, so that what the first one refuses nobody has taken.
template <typename Change>
void ViewSession::change_all(const Change& change) {
  for (const auto& instance : instances_) change(*instance);
}

void ViewSession::push(const Vector3& impulse) {
  const double most = drive_limits(*world().robot).push;
  if (!(impulse.norm() <= most)) {
    throw ConfigError(kSessionSource, "push", fmt::format("an impulse of at most {:g} N s", most),
                      fmt::format("{:g}", impulse.norm()));
  }
  for (const auto& instance : instances_) instance->push(impulse);
}

void ViewSession::choose_engines(const std::vector<std::string>& engines) {
  check_engines_of(engines, provider_.names);
  RobotInstances instances;
  for (std::size_t i = 0; i < engines.size(); ++i) {
    // A further robot begins where the first one is.
    const RobotInstance& before = *instances_[i < instances_.size() ? i : 0];
    instances.push_back(before.with_engine(provider_.find(engines[i])));
  }
  replace(std::move(instances));
  setup_.engines = engines;
}

void ViewSession::replace(RobotInstances instances) {
  finish_recording();
  history_.forget();
  instances_ = std::move(instances);
}

void ViewSession::change_world(const std::vector<std::string>& texts) {
  std::vector<QuantityChange> changes;
  for (const std::string& text : texts) changes.push_back(parse_quantity_change(text, kSessionSource));
  require_under_way(changes, kSessionSource);
  RobotInstances instances;
  for (std::size_t i = 0; i < instances_.size(); ++i)
    instances.push_back(instances_[i]->with_changes(provider_.find(setup_.engines[i]), changes));
  replace(std::move(instances));
  changes_ = texts;
}

void ViewSession::change_terrain(const TerrainCommand& command) {
  if (is_terrain_file(command.terrain)) {
    throw ConfigError(kSessionSource, "terrain", "a generator: files are for the command line (--terrain)",
                      command.terrain);
  }
  const TerrainChoice ground{command.terrain, command.seed};
  RobotInstances instances;
  for (std::size_t i = 0; i < instances_.size(); ++i)
    instances.push_back(instances_[i]->with_terrain(provider_.find(setup_.engines[i]), ground));
  replace(std::move(instances));
  setup_.terrain_seed = command.seed;
  if (!changes_.empty()) change_world(changes_);  // a new ground has the world as it was at first
  ++scene_revision_;
  scene_ = scene_of(world(), scene_revision_);
}

void ViewSession::choose_robot(const std::string& robot) {
  require_one_of(robot, subjects_.robots, "robot");
  change_subject({robot, {}, {}, {}});
}

void ViewSession::choose_policy(const std::string& policy) {
  ViewSubject subject{{}, policy, {}, {}};
  if (policy.empty()) {
    subject.robot = setup_.subject.robot;
    subject.files = setup_.subject.files;
  } else {
    require_one_of(policy, subjects_.policies, "policy");
  }
  change_subject(subject);
}

void ViewSession::change_subject(const ViewSubject& subject) {
  if (!subjects_.make) throw ConfigError(kSessionSource, "robot", "the one that there is", "another one");
  ViewSetup setup;
  RobotInstances instances;
  nlohmann::ordered_json scene;
  try {
    setup = subjects_.make(subject, {world().terrain.name(), setup_.terrain_seed});
    setup.engines = setup_.engines;
    instances = make_instances(setup);
    // What cannot be shown is refused as well.
    scene = scene_of(instances.front()->world().spec(), scene_revision_ + 1);
  } catch (const ConfigError&) {
    throw;
  } catch (const std::exception& problem) {  // whatever a file does to its reader, the session goes on
    throw ConfigError(kSessionSource, subject.policy.empty() ? subject.robot : subject.policy,
                      "a robot or a policy that can be driven", problem.what());
  }
  replace(std::move(instances));
  setup_ = std::move(setup);
  history_ = SessionHistory(setup_.control_dt);
  nominal_ = world();
  changes_.clear();
  pulled_to_.reset();
  ++subject_revision_;
  ++scene_revision_;
  scene_ = std::move(scene);
}

void ViewSession::advance(int steps) {
  if (paused_) return;
  for (int i = 0; i < steps; ++i) step_once();
}

void ViewSession::step_once() {
  pull_force_ = 0;
  if (pulled_to_) pull();
  for (const auto& instance : instances_) instance->step();
  history_.add(instances_);
  if (recorders_.empty()) return;
  for (std::size_t k = 0; k < instances_.size(); ++k) {
    // Whose time stands still has ended, or made this step with the one before.
    const double time = instances_[k]->world().state().time;
    if (std::exchange(recorded_times_[k], time) != time)
      recorders_[k].add(TraceSample(instances_[k]->world(), instances_[k]->targets()));
  }
  if (++recorded_steps_ == kMaxRecordedSteps) finish_recording();
}

// A spring that lifts the robot by a standing height, damped as that mass on it is critically; no stronger
// than twice the weight.
void ViewSession::pull() {
  const RobotDescription& robot = *world().robot;
  const double mass = robot.total_mass(), most = 2 * mass * kGravity;
  const double stiffness = mass * kGravity / std::max(robot.standing_height, 0.05);
  const double damping = 2 * std::sqrt(stiffness * mass);
  for (const auto& instance : instances_) {
    const RobotState& state = instance->world().state();
    const Vector3 wanted = stiffness * (*pulled_to_ - state.p_WB) - damping * state.v_WB;
    const Vector3 force = wanted * std::min(1.0, most / std::max(wanted.norm(), 1e-9));
    if (instance->outcome() == Outcome::kDiverged) continue;
    instance->pull(force);
    if (instance == instances_.front()) pull_force_ = force.norm();
  }
}

void ViewSession::record(bool on) {
  finish_recording();
  if (!on) return;
  recorders_.assign(instances_.size(), TraceRecorder());
  recorded_times_.clear();
  for (const auto& instance : instances_) recorded_times_.push_back(instance->world().state().time);
}

void ViewSession::finish_recording() {
  if (recorders_.empty()) return;
  std::vector<Trace> traces;
  for (TraceRecorder& recorder : recorders_) traces.push_back(recorder.take());
  recorders_.clear();
  publish(std::move(traces), static_cast<double>(std::exchange(recorded_steps_, 0)) * setup_.control_dt);
}

void ViewSession::publish(std::vector<Trace> traces, double seconds) {
  Motion motion{.robot = world().robot, .terrain = world().terrain, .runs = {}};
  for (std::size_t instance = 0; instance < traces.size(); ++instance) {
    if (traces[instance].empty()) continue;
    const EngineInfo& engine = instances_[instance]->world().info();
    motion.runs.push_back({engine.name, engine.library + " " + engine.version, std::move(traces[instance])});
  }
  if (motion.runs.empty()) return;
  ReportPage page;
  const GaitGenerator* gait = instances_.front()->gait();
  page.title = fmt::format("{} on {}, {:.2f} s, driven by hand{}",
                           gait != nullptr ? gait->gait().name : "a policy", world().terrain.name(), seconds,
                           changes_.empty() ? "" : fmt::format(", {}", fmt::join(changes_, ", ")));
  page.motions.push_back(std::move(motion));
  recording_ = std::make_shared<const ReportPage>(std::move(page));
  ++recordings_;
}

}  // namespace crossgait
