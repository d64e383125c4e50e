#include "apps/policy_option.h"

#include <fmt/format.h>

#include "apps/env_options.h"
#include "physics/core/error.h"
#include "policy/bundled_policies.h"
#include "study/notes.h"

namespace crossgait::apps {

void PolicyOption::add_to(CLI::App& command) {
  command_ = &command;
  CLI::Option* option =
      command
          .add_option(
              "--policy", policy,
              "A policy in its environment, in the place of a gait (docs/policies.md): its first episode")
          ->type_name("zero|random|FILE.safetensors|FILE.yaml|FOLDER");
  command.add_option("--config", config, "The policy's environment as YAML")->needs(option);
}

LoadedEnv PolicyOption::environment(const WalkOptions& walk) const {
  const std::string file = environment_file(config, policy);
  if (file.empty()) {
    const LoadedWalk made = walk.make();
    return {made.config.environment(), made.world.robot};
  }
  const auto given = [this](const char* option) { return command_->get_option(option)->count() > 0; };
  for (const char* option : {"--robot", "--physics-dt", "--gait", "--control-dt", "--settle",
                             "--terminations", "--no-compensation", "--no-heading-hold"}) {
    if (given(option))
      throw ConfigError("command line", option, fmt::format("no option that {} says", file), "one");
  }
  EnvConfig made = load_env_config(file);
  if (given("--terrain")) made.terrain = walk.config.terrain;
  if (given("--seed")) made.terrain_seed = walk.config.terrain_seed;
  made.contact.add(walk.contact.make());
  if (given("--seconds")) made.episode_seconds = walk.config.timing.seconds;
  if (const auto velocity = walk.velocity_command()) made.command = velocity;
  apply_settings(walk.settings, made);
  made.validate("command line");
  LoadedEnv loaded = load_with_warnings(made);
  print_notes(notes_on(loaded));
  return loaded;
}

}  // namespace crossgait::apps
