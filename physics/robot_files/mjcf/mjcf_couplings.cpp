#include "physics/robot_files/mjcf/mjcf_couplings.h"

#include <algorithm>
#include <array>
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

/// Who says an attribute of an element of `<equality>`: it, or `<equality>` of its class; null: nobody.
const MjcfElement* equality_saying(const MjcfDefaults& defaults, const MjcfElement& e,
                                   std::string_view attribute) {
  if (e.has(attribute)) return &e;
  const MjcfElement* found = nullptr;
  for (const MjcfElement* section : defaults.sections(e.attribute("class"))) {
    for (const MjcfElement& of_class : section->children)
      if (of_class.tag == "equality" && of_class.has(attribute)) found = &of_class;
  }
  return found;
}

/// What an element says, or its class.
std::string_view defaults_or_own(const MjcfDefaults& defaults, const MjcfElement& e,
                                 std::string_view attribute) {
  const MjcfElement* says = equality_saying(defaults, e, attribute);
  return says == nullptr ? std::string_view() : says->attribute(attribute);
}

NamedCoupling read_follower(const MjcfElement& e, const MjcfDefaults& defaults, const std::string& file) {
  NamedCoupling coupling;
  coupling.follower = e.attribute("joint1");
  coupling.leader = e.attribute("joint2");
  if (coupling.follower.empty() || coupling.follower == coupling.leader)
    fail_at(e, "two joints: joint1 and joint2", fmt::format("'{}' alone", coupling.leader));
  if (e.has("polycoef")) {
    const std::vector<double> numbers = mjcf_numbers(e, "polycoef", 1, 5);
    coupling.coefficients = {};
    coupling.coefficients[1] = 1;  // what MuJoCo has where fewer are said
    std::copy(numbers.begin(), numbers.end(), coupling.coefficients.begin());
  }
  const auto numbers = [&](const char* attribute, std::size_t most) {
    const MjcfElement* says = equality_saying(defaults, e, attribute);
    return says == nullptr ? std::vector<double>() : mjcf_numbers(*says, attribute, 1, most);
  };
  const std::vector<double> solref = numbers("solref", 2), solimp = numbers("solimp", 5);
  const Softness usual;
  std::array<double, 2> all_solref{usual.time_constant, usual.damping_ratio};
  std::array<double, 5> all_solimp{usual.impedance_min, usual.impedance_max, usual.impedance_width,
                                   usual.impedance_midpoint, usual.impedance_power};
  std::copy(solref.begin(), solref.end(), all_solref.begin());
  std::copy(solimp.begin(), solimp.end(), all_solimp.begin());
  coupling.softness = softness_of(all_solref, all_solimp);
  coupling.place = mjcf_place(e, file);
  return coupling;
}

}  // namespace

MjcfCouplings find_couplings(MjcfDocument& document, const MjcfDefaults& defaults) {
  MjcfCouplings found;
  std::map<std::string, std::string>& coupled = found.others;
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
      if (defaults_or_own(defaults, e, "active") == "false") continue;
      if (e.tag == "joint" && e.has("joint2")) {
        found.followers.push_back(read_follower(e, defaults, document.path()));
        found.followers.back().is_driven = driven.contains(found.followers.back().follower);
      } else if (e.tag == "joint") {
        coupled[std::string(e.attribute("joint1"))] =
            fmt::format("is held ({})", mjcf_place(e, document.path()));
      } else if (e.tag == "tendon") {
        for (const char* name : {"tendon1", "tendon2"}) couple(e, name, "hangs on");
      }
    }
  }
  return found;
}

void refer_to_zero(NamedCoupling& coupling, const std::map<std::string, double>& reference,
                   const std::string& file) {
  const auto of = [&](const std::string& joint) {
    const auto found = reference.find(joint);
    if (found != reference.end()) return found->second;
    throw ConfigError(file, coupling.place, "hinges of this file in joint1 and joint2",
                      fmt::format("'{}'", printable_text(joint, 200)));
  };
  const double of_follower = of(coupling.follower), of_leader = of(coupling.leader);
  // Horner's scheme with x - ref in the place of x.
  std::array<double, 5> shifted{};
  for (auto c = coupling.coefficients.rbegin(); c != coupling.coefficients.rend(); ++c) {
    for (std::size_t power = shifted.size() - 1; power > 0; --power)
      shifted[power] = shifted[power - 1] - of_leader * shifted[power];
    shifted[0] = *c - of_leader * shifted[0];
  }
  shifted[0] += of_follower;
  coupling.coefficients = shifted;
}

}  // namespace crossgait
