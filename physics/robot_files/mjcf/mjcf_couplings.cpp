#include "physics/robot_files/mjcf/mjcf_couplings.h"

#include <algorithm>
#include <array>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/robot_files/mjcf/mjcf_connects.h"

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

/// What an element says, or its class.
std::string_view defaults_or_own(const MjcfDefaults& defaults, const MjcfElement& e,
                                 std::string_view attribute) {
  const MjcfElement* says = equality_saying(defaults, e, attribute);
  return says == nullptr ? std::string_view() : says->attribute(attribute);
}

/// Reads polycoef, of which MuJoCo has 1 for the second number where fewer are said.
std::array<double, 5> polynomial_of(const MjcfElement& e) {
  std::array<double, 5> coefficients{0, 1, 0, 0, 0};
  if (e.has("polycoef")) std::ranges::copy(mjcf_numbers(e, "polycoef", 1, 5), coefficients.begin());
  return coefficients;
}

/// Reads its softness; without any word of it MuJoCo's defaults.
void read_softness_of(const MjcfElement& e, const MjcfDefaults& defaults, NamedCoupling& coupling) {
  const std::optional<Softness> said = softness_of_equality(e, defaults);
  coupling.softness = said.value_or(Softness());
  coupling.says_softness = said.has_value();
}

NamedCoupling read_follower(const MjcfElement& e, const MjcfDefaults& defaults, const std::string& file) {
  NamedCoupling coupling;
  coupling.follower = e.attribute("joint1");
  coupling.leader = e.attribute("joint2");
  if (coupling.follower.empty() || coupling.follower == coupling.leader)
    fail_at(e, "two joints: joint1 and joint2", fmt::format("'{}' alone", coupling.leader));
  coupling.coefficients = polynomial_of(e);
  read_softness_of(e, defaults, coupling);
  coupling.place = mjcf_place(e, file);
  return coupling;
}

/// Reads a `<tendon>` in `<equality>` that ties two joints: one tendon of both, or two of one each. Lengths
/// count from those at the joints' references, and what of them a joint makes is its coefficient times its
/// angle.
/// @param driven  joints with an actuator, which lead where the other one has none
std::optional<NamedCoupling> read_tied(const MjcfElement& e, const MjcfDefaults& defaults,
                                       const Tendons& tendons, const std::set<std::string>& driven,
                                       const std::string& file) {
  const auto joints_of = [&](const char* attribute) {
    const auto tendon = tendons.find(std::string(e.attribute(attribute)));
    return tendon == tendons.end() ? Tendons::mapped_type() : tendon->second;
  };
  const Tendons::mapped_type first = joints_of("tendon1"), second = joints_of("tendon2");
  const std::array<double, 5> p = polynomial_of(e);
  NamedCoupling coupling;
  const auto tie = [&](const auto& follower, const auto& leader) {
    coupling.follower = follower.first, coupling.leader = leader.first;
    return follower.second != 0 && follower.first != leader.first;
  };
  if (!e.has("tendon2") && first.size() == 2) {
    // a f + b l = p0
    const bool first_leads = driven.contains(first[0].first) && !driven.contains(first[1].first);
    const auto &follower = first[first_leads ? 1 : 0], &leader = first[first_leads ? 0 : 1];
    if (!tie(follower, leader)) return std::nullopt;
    coupling.coefficients = {p[0] / follower.second, -leader.second / follower.second};
  } else if (first.size() == 1 && second.size() == 1) {
    // a f = p(b l)
    if (!tie(first[0], second[0])) return std::nullopt;
    double power = 1;
    for (std::size_t i = 0; i < p.size(); ++i, power *= second[0].second)
      coupling.coefficients[i] = p[i] * power / first[0].second;
  } else {
    return std::nullopt;
  }
  read_softness_of(e, defaults, coupling);
  coupling.place = mjcf_place(e, file);
  return coupling;
}

/// Reads actuators before equalities: who has a motor leads.
class CouplingReader {
 public:
  CouplingReader(MjcfDocument& document, const MjcfDefaults& defaults)
      : document_(document), defaults_(defaults), tendons_(fixed_tendons(document.root())) {}

  MjcfCouplings read() {
    for_sections("actuator", [this](MjcfElement& section) {
      for (MjcfElement& e : section.children) read_actuator(e);
    });
    std::erase_if(found_.others, [this](const auto& entry) { return driven_.contains(entry.first); });
    for_sections("equality", [this](MjcfElement& section) {
      std::erase_if(section.children, [this](const MjcfElement& e) { return takes_equality(e); });
    });
    for (NamedCoupling& coupling : found_.followers) coupling.is_driven = driven_.contains(coupling.follower);
    for_sections("tendon", [this](MjcfElement& section) {
      std::erase_if(section.children, [this](const MjcfElement& e) {
        return e.tag == "fixed" && taken_.contains(std::string(e.attribute("name")));
      });
    });
    return std::move(found_);
  }

 private:
  template <typename Function>
  void for_sections(std::string_view tag, Function function) {
    for (MjcfElement& section : document_.root().children)
      if (section.tag == tag) function(section);
  }

  /// Notes what the joints of a tendon do that is not simulated.
  void couple(const MjcfElement& e, const char* attribute, const char* how) {
    const auto tendon = tendons_.find(std::string(e.attribute(attribute)));
    if (tendon == tendons_.end()) return;
    for (const auto& [joint, coefficient] : tendon->second)
      found_.others[joint] =
          fmt::format("{} tendon '{}' of {} joint(s) ({})", how, printable_text(tendon->first, 200),
                      tendon->second.size(), mjcf_place(e, document_.path()));
  }

  void read_actuator(MjcfElement& e) {
    const auto tendon = tendons_.find(std::string(e.attribute("tendon")));
    if (e.has("tendon") && tendon != tendons_.end() && tendon->second.size() == 1) {
      drive_joint(e, tendon->second.front(), defaults_);
      taken_.insert(tendon->first);
    } else if (e.has("tendon")) {
      couple(e, "tendon", "is driven by");
      pulled_.emplace(e.attribute("tendon"));
    }
    if (e.has("joint")) driven_.insert(std::string(e.attribute("joint")));
  }

  /// @returns whether nothing is left to be said of the element
  bool takes_equality(const MjcfElement& e) {
    const bool is_joint = e.tag == "joint";
    if (defaults_or_own(defaults_, e, "active") == "false") return is_joint;
    if (e.tag == "tendon") return takes_tendons(e);
    if (is_joint && e.has("joint2")) {
      found_.followers.push_back(read_follower(e, defaults_, document_.path()));
    } else if (is_joint) {
      found_.held.push_back(
          {std::string(e.attribute("joint1")), polynomial_of(e)[0], mjcf_place(e, document_.path())});
    }
    return is_joint;
  }

  bool takes_tendons(const MjcfElement& e) {
    const std::string one(e.attribute("tendon1")), other(e.attribute("tendon2"));
    const bool moves_by_itself = pulled_.contains(one) || pulled_.contains(other);
    auto tied = moves_by_itself ? std::nullopt : read_tied(e, defaults_, tendons_, driven_, document_.path());
    if (!tied) {
      for (const char* name : {"tendon1", "tendon2"}) couple(e, name, "hangs on");
      return false;
    }
    found_.followers.push_back(std::move(*tied));
    taken_.insert({one, other});
    return true;
  }

  MjcfDocument& document_;
  const MjcfDefaults& defaults_;
  const Tendons tendons_;
  std::set<std::string> driven_, pulled_;  ///< joints and tendons with an actuator
  std::set<std::string> taken_;            ///< tendons that became couplings or gears
  MjcfCouplings found_;
};

}  // namespace

MjcfCouplings find_couplings(MjcfDocument& document, const MjcfDefaults& defaults) {
  return CouplingReader(document, defaults).read();
}

std::map<std::string, double> held_angles(const std::vector<MjcfHeld>& held,
                                          const std::map<std::string, double>& reference,
                                          const std::string& file) {
  std::map<std::string, double> angles;
  for (const MjcfHeld& one : held) {
    const auto of = reference.find(one.joint);
    if (of == reference.end())
      throw ConfigError(file, one.place, "a hinge of this file in joint1",
                        fmt::format("'{}'", printable_text(one.joint, 200)));
    angles[one.joint] = of->second + one.offset;
  }
  return angles;
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
