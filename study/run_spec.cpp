#include "study/run_spec.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include <fmt/format.h>

#include "backends/registry.h"
#include "env/env_model.h"
#include "physics/core/error.h"
#include "physics/core/hash.h"
#include "physics/core/text.h"
#include "physics/robot_files/data_path.h"
#include "policy/bundled_policies.h"
#include "study/rollout.h"

namespace crossgait {
namespace {

using Json = nlohmann::json;

bool is_file(const std::string& path) {
  std::error_code error;
  return std::filesystem::is_regular_file(path, error);
}

// A file counts by what is in it, and by what is in the files that it names beside itself; a name as it is.
// @param seen files that are in already: files may name each other
void add_file(Fnv1a& hash, const std::string& path, std::set<std::string>& seen) {
  if (!seen.insert(std::filesystem::weakly_canonical(path).string()).second) return;
  const std::string text = read_text_file(path, kTerrainTableBudget);  // the largest that a run reads
  hash.add(text);
  if (!path.ends_with(".yaml")) return;
  constexpr std::string_view kBetween = " \t\r\n\"',:{}[]";
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find_first_of(kBetween, begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    begin = end + 1;
    if (!word.ends_with(".safetensors") && !word.ends_with(".yaml")) continue;
    const std::string beside = (std::filesystem::path(path).parent_path() / word).string();
    if (is_file(beside)) add_file(hash, beside, seen);
  }
}

Json content_of(const std::string& name_or_file) {
  if (!is_file(name_or_file)) return name_or_file;
  return {{"file", file_hash(name_or_file)}};
}

// As `make_terrain` takes it: FILE.png may have settings behind a colon.
Json terrain_json(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  if (is_file(text) || colon == std::string::npos || !is_file(text.substr(0, colon))) return content_of(text);
  Json terrain = content_of(text.substr(0, colon));
  terrain["settings"] = text.substr(colon + 1);
  return terrain;
}

Json to_json(const GaitParameters& p) {
  Json parameters{{"swing", name(p.swing)}};
  for (const ParameterRow& row : gait_parameters()) parameters[std::string(row.name)] = p.*row.member;
  return parameters;
}

Json to_json(const std::optional<VelocityCommand>& c) {
  if (!c) return nullptr;
  return {{"vx", c->vx}, {"vy", c->vy}, {"yaw_rate", c->yaw_rate}};
}

Json to_json(const std::vector<SpeedBand>& bands) {
  Json result = Json::array();
  for (const SpeedBand& band : bands)
    result.push_back(
        {{"gait", band.gait.name}, {"below_mps", band.below}, {"parameters", to_json(band.gait.preferred)}});
  return result;
}

// What engines are told of it, whatever the files look like that say it.
Json identity_of(const RobotDescription& robot) {
  Fnv1a hash;
  const auto add = [&hash](const auto& values) {
    for (Eigen::Index i = 0; i < values.size(); ++i) hash.add(fmt::format("{:.17g};", values.data()[i]));
  };
  const auto add_number = [&hash](double value) { hash.add(fmt::format("{:.17g};", value)); };
  for (const Body& b : robot.bodies) {
    hash.add(b.name);
    for (const double v : {static_cast<double>(b.parent), b.inertia.mass, b.joint.lower, b.joint.upper,
                           b.joint.damping, b.joint.friction, b.joint.armature, b.joint.actuated ? 1.0 : 0.0,
                           b.joint.kp, b.joint.kd, b.joint.effort_limit, b.joint.corner_speed,
                           b.joint.no_load_speed, b.joint.backlash, b.joint.delay, b.joint.sensor_noise})
      add_number(v);
    add(b.X_PB.matrix());
    add(b.joint.axis);
    add(b.inertia.p_BC);
    add(b.inertia.I_C);
    for (const CollisionShape& shape : b.shapes) {
      add_number(static_cast<double>(shape.type));
      add(shape.size);
      add(shape.X_BG.matrix());
      for (const Vector3& vertex : shape.vertices) add(vertex);
    }
  }
  for (const LoopClosure& loop : robot.loops) {
    add_number(loop.body_a);
    add_number(loop.body_b);
    add(loop.p_AP);
    add(loop.p_BP);
  }
  for (const Softness& s : {robot.loop_softness, robot.friction_softness}) {
    for (const double v :
         {s.time_constant, s.damping_ratio, s.impedance_min, s.impedance_max, s.impedance_width})
      add_number(v);
  }
  add(robot.home);
  add_number(robot.home_height);
  if (robot.legs) {
    for (const LegModel& leg : *robot.legs) {
      for (const int joint : leg.joints()) add_number(joint);
      add_number(leg.foot_body);
      add(leg.p_BF);
      add_number(leg.foot_radius);
    }
  }
  return {{"name", robot.name}, {"description", hash.hex()}};
}

Json to_json(const LoadedWalk& walk) {
  const WalkConfig& c = walk.config;
  return {{"kind", "walk"},
          {"robot", identity_of(*walk.world.robot)},
          {"terrain", terrain_json(c.terrain)},
          {"terrain_seed", c.terrain_seed},
          {"friction", c.friction},
          {"physics_dt", c.physics_dt},
          {"gait", c.gait.name()},
          {"parameters", to_json(c.gait.parameters)},
          {"bands", to_json(c.gait.bands)},
          {"command", to_json(c.gait.command)},
          {"compensation", c.compensation},
          {"heading_hold", c.heading_hold},
          {"ends", outcome_names(c.ends)},
          {"seconds", c.timing.seconds},
          {"control_dt", c.timing.control_dt},
          {"settle_seconds", c.timing.settle_seconds}};
}

Json to_json(const LoadedPolicy& c) {
  // With everything that follows from the robot, so that a default which changes makes another run.
  EnvConfig config = c.model->stated();
  // The run says which engine; robot and terrain stand beside it by their contents.
  config.engine.clear();
  config.robot.clear();
  config.terrain.clear();
  return {{"kind", "policy"},
          {"robot", identity_of(*c.model->robot)},
          {"terrain", terrain_json(c.model->config.terrain)},
          {"environment", to_yaml(config)},
          {"policy", content_of(find_policy_file(c.policy))}};
}

// @param r  stated for its robot
Json to_json(const StartRanges& r) {
  return {{"position_m", *r.position_m},
          {"heading_rad", r.heading_rad},
          {"tilt_rad", r.tilt_rad},
          {"push_mps", *r.push_mps}};
}

const RobotDescription& robot_of(const LoadedWalk& walk) { return *walk.world.robot; }
const RobotDescription& robot_of(const LoadedPolicy& policy) { return *policy.model->robot; }

Json described_in_runs(const LoadedBehaviour& loaded) {
  return std::visit(
      [&](const auto& what) -> Json {
        return {{"behaviour", to_json(what)},
                {"starts", to_json(loaded.starts.stated_for(robot_of(what)))},
                {"seed", loaded.seed}};
      },
      loaded.what);
}

std::variant<LoadedWalk, LoadedPolicy> loaded_of(const std::variant<WalkConfig, PolicyConfig>& what) {
  if (const auto* walk = std::get_if<WalkConfig>(&what)) return LoadedWalk(*walk);
  const auto& [environment, policy] = std::get<PolicyConfig>(what);
  return LoadedPolicy{EnvModel::make(environment), policy};
}

}  // namespace

std::string file_hash(const std::string& path) {
  Fnv1a hash;
  std::set<std::string> seen;
  add_file(hash, path, seen);
  return hash.hex();
}

Json identity_of_robot(const std::string& name_or_file) {
  return identity_of(load_robot(find_robot(name_or_file)));
}

LoadedBehaviour::LoadedBehaviour(const BehaviourSpec& spec)
    : what(loaded_of(spec.what)), starts(spec.starts), seed(spec.seed), described(described_in_runs(*this)) {}

LoadedBehaviour::LoadedBehaviour(LoadedWalk walk, const StartRanges& ranges, std::uint64_t of_starts)
    : what(std::move(walk)), starts(ranges), seed(of_starts), described(described_in_runs(*this)) {}

LoadedBehaviour::LoadedBehaviour(const PolicyConfig& policy, const StartRanges& ranges,
                                 std::uint64_t of_starts)
    : LoadedBehaviour(BehaviourSpec{policy, ranges, of_starts}) {}

LoadedBehaviour::LoadedBehaviour(const LoadedEnv& environment, std::string policy, const StartRanges& ranges,
                                 std::uint64_t of_starts)
    : what(LoadedPolicy{EnvModel::make(environment), std::move(policy)}),
      starts(ranges),
      seed(of_starts),
      described(described_in_runs(*this)) {}

const WorldSpec& LoadedBehaviour::world() const {
  if (const auto* walk = std::get_if<LoadedWalk>(&what)) return walk->world;
  return std::get<LoadedPolicy>(what).model->world;
}

Json describe_run(Json behaviour, const EngineInfo& engine, const Variation& v, std::size_t start) {
  Json run = std::move(behaviour);
  run["schema"] = {{"name", "run"}, {"version", 1}};
  run["crossgait"] = crossgait_version();
  run["engine"] = engine.name;
  run["engine_version"] = engine.version;
  run["variation"] = {{"step", v.step}, {"tolerance", v.tolerance}, {"iterations", v.iterations}};
  run["start"] = start;
  return run;
}

Json to_json(const RunSpec& spec) {
  EngineInfo engine;
  engine.name = spec.engine;
  engine.version = spec.engine_version;
  Json run = describe_run(LoadedBehaviour(spec.behaviour).described, engine, spec.variation, spec.start);
  run["crossgait"] = spec.crossgait;
  return run;
}

std::string canonical_json(const RunSpec& run) { return to_json(run).dump(); }

std::string run_hash(const RunSpec& run) { return fnv1a_hex(canonical_json(run)); }

Behaviour make_behaviour(const LoadedWalk& walk, const WalkSetup& setup, const StartRanges& starts,
                         std::uint64_t seed) {
  const auto terrain = [ground = walk.ground, first = walk.config.terrain_seed](std::size_t k) {
    return ground.make(first + k);
  };
  return walk_behaviour(walk.world, setup, terrain, starts, seed);
}

Behaviour make_behaviour(const LoadedBehaviour& loaded) {
  if (const auto* walk = std::get_if<LoadedWalk>(&loaded.what))
    return make_behaviour(*walk, walk->config.setup(), loaded.starts, loaded.seed);
  const auto& [model, policy] = std::get<LoadedPolicy>(loaded.what);
  const PolicyFactory factory = find_policy(policy).make;
  static_cast<void>(factory(model->interface));  // a bad one before long runs
  return policy_behaviour(model->loaded(), factory, std::filesystem::path(policy).filename(), loaded.starts,
                          loaded.seed);
}

RunResult run(const Behaviour& behaviour, const Engine& engine, const Variation& variation,
              std::size_t start) {
  RunResult result;
  for (const Statistic& s : behaviour.statistics) result.names.push_back(s.name);
  result.values = behaviour.run(engine, variation, start);
  return result;
}

RunResult run(const RunSpec& spec) {
  if (spec.crossgait != crossgait_version())
    throw ConfigError("run", "crossgait", "version " + spec.crossgait, std::string(crossgait_version()));
  const Engine engine = find_engine(spec.engine);
  if (engine.info.version != spec.engine_version) {
    throw ConfigError("run", spec.engine, "version " + spec.engine_version, engine.info.version);
  }
  return run(make_behaviour(spec.behaviour), engine, spec.variation, spec.start);
}

}  // namespace crossgait
