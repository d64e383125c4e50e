// Settings of contact in configurations and results.
#pragma once

#include <span>

#include <nlohmann/json_fwd.hpp>

#include "physics/robot/contact_settings.h"

namespace crossgait {

/// Returns the value of a setting: a word, a number, or a list of numbers.
nlohmann::ordered_json to_json(const ContactSetting& setting, std::span<const double> numbers);

}  // namespace crossgait
