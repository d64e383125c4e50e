#include "physics/robot_files/mjcf/mjcf_newer.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "physics/core/error.h"

namespace crossgait {
namespace {

/// An attribute that changes motion and is not simulated.
struct NotSimulated {
  std::string_view tag, attribute, neutral;  ///< the value with which it changes nothing
};
constexpr std::array kNotSimulated{
    NotSimulated{"body", "gravcomp", "0"},
    NotSimulated{"joint", "actuatorgravcomp", "false"},
    NotSimulated{"joint", "springyield", "0"},
    NotSimulated{"geom", "adhesion", "0"},
    NotSimulated{"geom", "surfacevel", "0"},
    NotSimulated{"joint", "solreffriction", "0.02 1"},
    NotSimulated{"joint", "solimpfriction", "0.9 0.95 0.001 0.5 2"},
};
constexpr std::array<std::string_view, 2> kPolynomials{"damping", "stiffness"};

class Translator {
 public:
  Translator(MjcfDocument& document, const MjcfDefaults& defaults, ReaderWarnings& warnings)
      : document_(document), defaults_(defaults), warnings_(warnings) {}

  MjcfJointForces run() {
    for (MjcfElement& section : document_.root().children) {
      if (section.tag == "compiler" && section.has("autolimits"))
        autolimits_ = section.attribute("autolimits") != "false";
    }
    for (MjcfElement& section : document_.root().children) {
      if (section.tag == "worldbody")
        for_each_with_class(section, "", [this](MjcfElement& e, const auto& name) {
          if (e.tag == "joint") read_force(e, name);
        });
    }
    for (MjcfElement& section : document_.root().children) {
      if (section.tag == "worldbody" || section.tag == "default")
        for_each_mjcf_element(section, [this](MjcfElement& e) { translate(e); });
    }
    return std::move(forces_);
  }

 private:
  void read_force(const MjcfElement& joint, const std::string& class_name) {
    const MjcfElement* range = defaults_.find(joint, class_name, "actuatorfrcrange");
    if (range == nullptr) return;
    const MjcfElement* limited = defaults_.find(joint, class_name, "actuatorfrclimited");
    const std::string_view word = limited == nullptr ? "auto" : limited->attribute("actuatorfrclimited");
    if (word == "false" || (word != "true" && !autolimits_)) return;
    const std::vector<double> numbers = mjcf_numbers(*range, "actuatorfrcrange", 2, 2);
    if (numbers[0] < numbers[1]) forces_[std::string(joint.attribute("name"))] = {numbers[0], numbers[1]};
  }

  void translate(MjcfElement& e) {
    if (e.tag == "joint") {
      e.remove("actuatorfrcrange"), e.remove("actuatorfrclimited");
      for (const std::string_view name : kPolynomials) keep_first(e, name);
    }
    for (const NotSimulated& row : kNotSimulated) {
      if (e.tag != row.tag || !e.has(row.attribute)) continue;
      const std::string value(e.attribute(row.attribute));
      if (value != row.neutral)
        warnings_.count(
            "did not simulate ",
            fmt::format(" attribute(s) {}=\"{}\" of <{}>", row.attribute, printable_text(value, 50), row.tag),
            mjcf_place(e, document_.path()));
      e.remove(row.attribute);
    }
  }

  /// Older compilers know one coefficient of a polynomial in speed or angle.
  void keep_first(MjcfElement& e, std::string_view name) {
    const std::string written(e.attribute(name));
    if (written.find_first_of(" \t\n\r") == std::string::npos) return;
    const std::vector<double> numbers = mjcf_numbers(e, name, 1, 3);
    if (std::any_of(numbers.begin() + 1, numbers.end(), [](double c) { return c != 0; }))
      warnings_.count("took the first coefficient alone of ",
                      fmt::format(" {}=\"{}\"", name, printable_text(written, 100)),
                      mjcf_place(e, document_.path()));
    e.set(name, fmt::format("{}", numbers[0]));
  }

  MjcfDocument& document_;
  const MjcfDefaults& defaults_;
  ReaderWarnings& warnings_;
  MjcfJointForces forces_;
  bool autolimits_ = true;
};

}  // namespace

MjcfJointForces take_newer(MjcfDocument& document, const MjcfDefaults& defaults, ReaderWarnings& warnings) {
  return Translator(document, defaults, warnings).run();
}

}  // namespace crossgait
