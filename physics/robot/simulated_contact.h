// What of the contact that is asked for is simulated in steps of a length.
#pragma once

#include "physics/robot/contact_settings.h"

namespace crossgait {

/// Resolves settings of contact as `resolve_contact` does, with the time constant that steps of `physics_dt`
/// (s) have (time_constant_in_steps). @throws ConfigError as that does
ContactSpec simulated_contact(const ContactSettings& of_robot, const ContactSettings& asked,
                              double physics_dt, std::string_view source);

}  // namespace crossgait
