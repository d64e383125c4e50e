#include "apps/contact_option.h"

#include <fmt/format.h>

#include "physics/core/error.h"

namespace crossgait::apps {

void ContactOptions::add_to(CLI::App& command) {
  command.add_option("--friction", friction,
                     "Coefficient of friction between feet and ground (default: the robot file's, or 0.6)");
  std::string help = "Settings of contact, over those of the robot's file:";
  for (const ContactSetting& setting : contact_settings())
    help += fmt::format(" {} ({});", setting.name, setting.help);
  help.back() = '.';
  command.add_option("--contact", settings, help + " Numbers of one setting have a colon between them")
      ->type_name("NAME=VALUE,...");
}

ContactSettings ContactOptions::make() const {
  ContactSettings contact;
  if (!settings.empty()) contact = parse_contact_settings(settings, "--contact");
  if (!friction) return contact;
  if (contact.find("friction") != nullptr)
    throw ConfigError("--contact", "friction", "one value", "another one in --friction");
  contact.set("friction", std::vector{*friction}, "--friction", "friction");
  return contact;
}

}  // namespace crossgait::apps
