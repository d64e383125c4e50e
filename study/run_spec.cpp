#include "study/run_spec.h"

#include <filesystem>

#include <fmt/format.h>

#include "backends/registry.h"
#include "env/env_model.h"
#include "physics/core/error.h"
#include "physics/core/hash.h"
#include "physics/robot/robot_identity.h"

namespace crossgait {
namespace {

using Json = nlohmann::json;

bool is_file(const std::string& path) {
  std::error_code error;
  return std::filesystem::is_regular_file(path, error);
}

// A file counts by what is in it, a name as it is.
Json content_of(const std::string& name_or_file) {
  if (!is_file(name_or_file)) return name_or_file;
  return {{"sha256", file_sha256(name_or_file)}};
}

Json policy_json(const LoadedPolicy& loaded) {
  if (loaded.files.empty()) return loaded.policy.name;
  Json policy{{"sha256", Json::array()}};
  for (const FileRead& file : loaded.files) policy["sha256"].push_back(file.sha256);
  return policy;
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

Json contact_json(const ContactSpec& contact) {
  Json json;
  for (const ContactSetting& setting : contact_settings())
    json[std::string(setting.name)] = setting.get(contact);
  return json;
}

Json to_json(const LoadedWalk& walk) {
  const WalkConfig& c = walk.config;
  return {{"kind", "walk"},
          {"robot", identity_of_robot(*walk.world.robot)},
          {"terrain", terrain_json(c.terrain)},
          {"terrain_seed", c.terrain_seed},
          {"contact", contact_json(walk.world.contact)},
          {"physics_dt", c.physics_dt},
          {"gait", c.gait.name()},
          {"parameters", to_json(c.gait.parameters)},
          {"bands", to_json(c.gait.bands)},
          {"command", to_json(c.gait.command)},
          {"compensation", c.compensation},
          {"heading_hold", c.heading_hold},
          {"terminations", outcome_names(c.terminations)},
          {"seconds", c.timing.seconds},
          {"control_dt", c.timing.control_dt},
          {"settle_seconds", c.timing.settle_seconds}};
}

Json to_json(const LoadedPolicy& c) {
  // With everything that follows from the robot, so that a default which changes makes another run.
  EnvConfig config = c.model->resolved();
  // The run says which engine; robot and terrain stand beside it by their contents.
  config.engine.clear();
  config.robot.clear();
  config.terrain.clear();
  return {{"kind", "policy"},
          {"robot", identity_of_robot(*c.model->robot)},
          {"terrain", terrain_json(c.model->config.terrain)},
          {"environment", to_yaml(config)},
          {"policy", policy_json(c)}};
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
                {"starts", to_json(loaded.starts.with_defaults(robot_of(what)))},
                {"seed", loaded.seed}};
      },
      loaded.what);
}

std::variant<LoadedWalk, LoadedPolicy> loaded_of(const std::variant<WalkConfig, PolicyConfig>& what) {
  if (const auto* walk = std::get_if<WalkConfig>(&what)) return LoadedWalk(*walk);
  const auto& [environment, policy] = std::get<PolicyConfig>(what);
  return LoadedPolicy(environment, policy);
}

}  // namespace

Json identity_of_robot(const RobotDescription& robot) {
  return {{"name", robot.name}, {"description", identity_hash(robot)}};
}

LoadedPolicy::LoadedPolicy(const LoadedEnv& environment, const std::string& name)
    : model(EnvModel::make(environment)) {
  const FilesRead read;
  policy = find_policy(name);
  static_cast<void>(policy.make(model->interface));  // a bad one before long runs
  files = read.list();
}

LoadedBehaviour::LoadedBehaviour(const BehaviourSpec& spec)
    : what(loaded_of(spec.what)), starts(spec.starts), seed(spec.seed), described(described_in_runs(*this)) {}

LoadedBehaviour::LoadedBehaviour(LoadedWalk walk, const StartRanges& ranges, std::uint64_t of_starts)
    : what(std::move(walk)), starts(ranges), seed(of_starts), described(described_in_runs(*this)) {}

LoadedBehaviour::LoadedBehaviour(const PolicyConfig& policy, const StartRanges& ranges,
                                 std::uint64_t of_starts)
    : LoadedBehaviour(BehaviourSpec{policy, ranges, of_starts}) {}

LoadedBehaviour::LoadedBehaviour(const LoadedEnv& environment, const std::string& policy,
                                 const StartRanges& ranges, std::uint64_t of_starts)
    : what(LoadedPolicy(environment, policy)),
      starts(ranges),
      seed(of_starts),
      described(described_in_runs(*this)) {}

const WorldSpec& LoadedBehaviour::world() const {
  if (const auto* walk = std::get_if<LoadedWalk>(&what)) return walk->world;
  return std::get<LoadedPolicy>(what).model->world;
}

Json describe_run(Json behaviour, const EngineInfo& engine, const Variation& v, std::size_t start,
                  double horizon) {
  Json run = std::move(behaviour);
  run["schema"] = {{"name", "run"}, {"version", 5}};
  run["crossgait"] = crossgait_version();
  run["engine"] = engine.name;
  run["engine_version"] = engine.version;
  run["variation"] = {{"step", v.step},
                      {"iterations", v.iterations},
                      {"impratio", v.impratio},
                      {"softness", v.softness},
                      {"erp", v.erp}};
  run["start"] = start;
  run["horizon_s"] = horizon == kToTheEnd ? Json(nullptr) : Json(horizon);
  return run;
}

Json to_json(const RunSpec& spec) {
  EngineInfo engine;
  engine.name = spec.engine;
  engine.version = spec.engine_version;
  Json run = describe_run(LoadedBehaviour(spec.behaviour).described, engine, spec.variation, spec.start,
                          spec.horizon);
  run["crossgait"] = spec.crossgait;
  return run;
}

std::string canonical_json(const RunSpec& run) { return to_json(run).dump(); }

std::string run_hash(const RunSpec& run) { return fnv1a_hex(canonical_json(run)); }

Behaviour make_behaviour(const LoadedWalk& walk, const WalkSetup& setup, const StartRanges& starts,
                         std::uint64_t seed) {
  const auto terrain = [ground = walk.ground, seed = walk.config.terrain_seed](std::size_t k) {
    return ground.make(terrain_seed_of_start(seed, k));
  };
  return walk_behaviour(walk.world, setup, terrain, starts, seed);
}

Behaviour make_behaviour(const LoadedBehaviour& loaded) {
  if (const auto* walk = std::get_if<LoadedWalk>(&loaded.what))
    return make_behaviour(*walk, walk->config.setup(), loaded.starts, loaded.seed);
  const auto& policy = std::get<LoadedPolicy>(loaded.what);
  return policy_behaviour(policy.model->loaded(), policy.policy.make,
                          std::filesystem::path(policy.policy.name).filename(), loaded.starts, loaded.seed);
}

RunResult run(const Behaviour& behaviour, const Engine& engine, const Variation& variation, std::size_t start,
              double horizon) {
  return {keys_of(behaviour), behaviour.run(engine, variation, start, horizon)};
}

RunResult run(const RunSpec& spec) {
  if (spec.crossgait != crossgait_version())
    throw ConfigError("run", "crossgait", "version " + spec.crossgait, std::string(crossgait_version()));
  const Engine engine = find_engine(spec.engine);
  if (engine.info.version != spec.engine_version) {
    throw ConfigError("run", spec.engine, "version " + spec.engine_version, engine.info.version);
  }
  return run(make_behaviour(spec.behaviour), engine, spec.variation, spec.start, spec.horizon);
}

}  // namespace crossgait
