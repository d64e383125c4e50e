#include "physics/robot_files/urdf/urdf_contact.h"

#include <map>
#include <string_view>

#include <fmt/format.h>
#include <tinyxml.h>

#include "physics/core/text.h"
#include "physics/robot_files/ode_surface.h"
#include "physics/robot_files/xml_text.h"

namespace crossgait {
namespace {

constexpr double kUsualFriction = 0.5;  // Bullet's of a body that says nothing (btCollisionObject)

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

}  // namespace

ContactNumbers read_urdf_contact(const TiXmlElement& link, const UrdfErrors& errors, ReaderWarnings& warnings,
                                 std::vector<UnusedQuantity>& unused) {
  ContactNumbers numbers;
  const TiXmlElement* contact = link.FirstChildElement("contact");
  if (contact == nullptr) return numbers;
  OdeSurface surface;
  double spinning = 0, rolling = 0;
  const auto number = [&](const TiXmlElement& word) {
    return errors.number(word, fmt::format("{}, contact, {}", urdf_label(link), word.Value()),
                         trimmed(attribute_of(word, "value")), false);
  };
  for (auto* e = contact->FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
    const std::string& word = e->ValueStr();
    const auto known = unused_words().find(word);
    if (word == "lateral_friction") {
      surface.mu = number(*e);
    } else if (word == "spinning_friction") {
      spinning = number(*e);
    } else if (word == "rolling_friction") {
      rolling = number(*e);
    } else if (known != unused_words().end()) {
      unused.push_back(unused_word(urdf_label(link), word, attribute_of(*e, "value"), known->second));
    } else {
      warnings.ignore_element(fmt::format("<{}> of <contact>", word), urdf_place(link, *e), held_numbers(*e));
    }
  }
  const bool turns = spinning > 0 || rolling > 0;
  const std::string place = urdf_place(link, *contact);
  if (turns && !surface.mu) {
    surface.mu = kUsualFriction;
    warnings.count(
        fmt::format("took {:g}, Bullet's, for the lateral_friction that is missing in ", kUsualFriction),
        " <contact>", place);
  }
  take_ode_surface(surface, place, numbers, warnings);
  if (!turns) return numbers;
  // A contact that resists rolling resists turning as well, as much as the file says.
  numbers.friction[1] = spinning;
  numbers.friction[2] = rolling;
  numbers.condim = rolling > 0 ? 6 : 4;
  numbers.stated.insert({"friction", "condim"});
  return numbers;
}

}  // namespace crossgait
