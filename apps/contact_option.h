// --friction and --contact, the same in every command that simulates.
#pragma once

#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "physics/robot/contact_settings.h"

namespace crossgait::apps {

struct ContactOptions {
  std::optional<double> friction;
  std::string settings;  ///< NAME=VALUE,...

  void add_to(CLI::App& command);
  /// Makes the settings that the options ask for. @throws ConfigError naming the option
  ContactSettings make() const;
};

}  // namespace crossgait::apps
