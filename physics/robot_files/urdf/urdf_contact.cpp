#include "physics/robot_files/urdf/urdf_contact.h"

#include <map>
#include <string_view>

#include <fmt/format.h>
#include <tinyxml.h>

#include "physics/core/error.h"
#include "physics/core/text.h"
#include "physics/robot/contact_settings.h"
#include "physics/robot_files/ode_surface.h"
#include "physics/robot_files/xml_text.h"

namespace crossgait {
namespace {

/// Words that nothing here follows, and why.
const std::map<std::string_view, std::string_view>& unused_words() {
  static constexpr std::string_view kWorld = "one setting of the world here (--contact erp=, cfm=)";
  static constexpr std::string_view kSpring = "a spring of Bullet's; solref and solimp are settings here";
  static const std::map<std::string_view, std::string_view> table{
      {"contact_erp", kWorld},
      {"contact_cfm", kWorld},
      {"stiffness", kSpring},
      {"damping", kSpring},
      {"restitution", "nothing bounces by a rule here"},
      {"inertia_scaling", "inertia is what <inertia> says"},
      {"friction_anchor", "Bullet's, a spring along the ground"},
  };
  return table;
}

double number_of(const TiXmlElement& link, const TiXmlElement& word, const UrdfErrors& errors) {
  const std::string text = trimmed(attribute_of(word, "value"));
  const auto value = parse_number(text);
  if (!value || *value < 0)
    errors.fail(word, fmt::format("{}, contact, {}", urdf_label(link), word.Value()), "a number from 0 on",
                fmt::format("'{}'", printable_text(text, kMostOfAValue)));
  return *value;
}

}  // namespace

ContactNumbers read_urdf_contact(const TiXmlElement& link, const UrdfErrors& errors, ReaderWarnings& warnings,
                                 std::vector<UnusedQuantity>& unused) {
  ContactNumbers numbers;
  const TiXmlElement* contact = link.FirstChildElement("contact");
  if (contact == nullptr) return numbers;
  OdeSurface surface;
  double spinning = 0, rolling = 0;
  const std::map<std::string_view, double*> turning{{"spinning_friction", &spinning},
                                                    {"rolling_friction", &rolling}};
  for (auto* e = contact->FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
    const std::string& word = e->ValueStr();
    const auto unused_word = unused_words().find(word);
    if (word == "lateral_friction") {
      surface.mu = number_of(link, *e, errors);
    } else if (const auto place = turning.find(word); place != turning.end()) {
      *place->second = number_of(link, *e, errors);
    } else if (unused_word != unused_words().end()) {
      unused.push_back({urdf_label(link), word, printable_text(attribute_of(*e, "value"), kMostOfAValue), "",
                        fmt::format("not simulated: {}", unused_word->second)});
    } else {
      warnings.count("ignored ", fmt::format(" <{}> of <contact>", word), urdf_place(link, *e));
    }
  }
  take_ode_surface(surface, urdf_place(link, *contact), numbers, warnings);
  if (spinning == 0 && rolling == 0) return numbers;
  // A contact that resists rolling resists turning as well, as much as the file says.
  numbers.friction[1] = spinning;
  numbers.friction[2] = rolling;
  numbers.condim = rolling > 0 ? 6 : 4;
  numbers.stated.insert({"friction", "condim"});
  return numbers;
}

}  // namespace crossgait
