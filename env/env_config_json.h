// An environment's configuration as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "env/env_config.h"

namespace crossgait {

/// Returns the configuration with the keys and values of its YAML (`to_yaml`, which writes this down); keys
/// that say nothing are left out. `parse_env_config` reads its text back unchanged.
nlohmann::ordered_json to_json(const EnvConfig& config);

}  // namespace crossgait
