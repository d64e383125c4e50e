#include "physics/robot_files/mjcf/mjcf_couplings.h"

#include <set>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "physics/core/error.h"

namespace crossgait {
namespace {

using Tendons = std::map<std::string, std::vector<std::pair<std::string, double>>>;  // joints, coefficients

Tendons fixed_tendons(const MjcfElement& root) {
  Tendons tendons;
  for (const MjcfElement& section : root.children) {
    if (section.tag != "tendon") continue;
    for (const MjcfElement& tendon : section.children) {
      if (tendon.tag != "fixed") continue;
      auto& joints = tendons[std::string(tendon.attribute("name"))];
      for (const MjcfElement& joint : tendon.children) {
        const double coefficient = joint.has("coef") ? mjcf_numbers(joint, "coef", 1, 1)[0] : 1;
        joints.emplace_back(joint.attribute("joint"), coefficient);
      }
    }
  }
  return tendons;
}

/// Makes an actuator of a tendon one of its only joint.
void drive_joint(MjcfElement& actuator, const std::pair<std::string, double>& joint,
                 const MjcfDefaults& defaults) {
  double gear = 1;
  for (const MjcfElement* section : defaults.sections(actuator.attribute("class"))) {
    for (const MjcfElement& of_class : section->children)
      if (of_class.has("gear")) gear = mjcf_numbers(of_class, "gear", 1, 6)[0];
  }
  if (actuator.has("gear")) gear = mjcf_numbers(actuator, "gear", 1, 6)[0];
  actuator.remove("tendon");
  actuator.set("joint", joint.first);
  actuator.set("gear", fmt::format("{}", gear * joint.second));
}

}  // namespace

std::map<std::string, std::string> find_couplings(MjcfDocument& document, const MjcfDefaults& defaults) {
  std::map<std::string, std::string> coupled;
  const Tendons tendons = fixed_tendons(document.root());
  std::set<std::string> driven;
  const auto couple = [&](const MjcfElement& e, const char* attribute, const char* how) {
    const auto tendon = tendons.find(std::string(e.attribute(attribute)));
    if (tendon == tendons.end()) return;
    for (const auto& [joint, coefficient] : tendon->second)
      coupled[joint] = fmt::format("{} tendon '{}' ({})", how, printable_text(tendon->first, 200),
                                   mjcf_place(e, document.path()));
  };
  for (MjcfElement& section : document.root().children) {
    for (MjcfElement& e : section.children) {
      if (section.tag != "actuator") continue;
      const auto tendon = tendons.find(std::string(e.attribute("tendon")));
      if (e.has("tendon") && tendon != tendons.end() && tendon->second.size() == 1) {
        drive_joint(e, tendon->second.front(), defaults);
      } else if (e.has("tendon")) {
        couple(e, "tendon", "is driven by");
      }
      if (e.has("joint")) driven.insert(std::string(e.attribute("joint")));
    }
  }
  std::erase_if(coupled, [&](const auto& entry) { return driven.contains(entry.first); });
  for (const MjcfElement& section : document.root().children) {
    if (section.tag != "equality") continue;
    for (const MjcfElement& e : section.children) {
      if (e.attribute("active") == "false") continue;
      if (e.tag == "joint") {
        const std::string other = printable_text(e.attribute("joint2"), 200);
        coupled[std::string(e.attribute("joint1"))] =
            fmt::format("{} ({})", other.empty() ? "is held" : fmt::format("follows '{}'", other),
                        mjcf_place(e, document.path()));
      } else if (e.tag == "tendon") {
        for (const char* name : {"tendon1", "tendon2"}) couple(e, name, "hangs on");
      }
    }
  }
  return coupled;
}

}  // namespace crossgait
