#include "physics/robot_files/mjcf/mjcf_connects.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "physics/core/error.h"

namespace crossgait {
namespace {

struct Site {
  MjcfElement* body;
  Vector3 p_BS = Vector3::Zero();
};

class ConnectReader {
 public:
  ConnectReader(MjcfDocument& document, const MjcfDefaults& defaults, ReaderWarnings& warnings)
      : document_(document), defaults_(defaults), warnings_(warnings) {}

  MjcfConnects read() {
    for (MjcfElement& section : document_.root().children) {
      if (section.tag == "worldbody") find_sites(section, "");
    }
    for (MjcfElement& section : document_.root().children) {
      if (section.tag != "equality") continue;
      for (MjcfElement& e : section.children) {
        if (e.tag == "connect") read(e);
      }
    }
    choose_softness();
    return std::move(found_);
  }

 private:
  void find_sites(MjcfElement& body, const std::string& class_name) {
    const std::string here = class_inside(body, class_name);
    for (MjcfElement& child : body.children) {
      if (child.tag == "body") find_sites(child, here);
      if (child.tag != "site" || !child.has("name")) continue;
      Site site{&body};
      if (const MjcfElement* says = defaults_.find(child, class_of(child, here), "pos")) {
        const std::vector<double> p = mjcf_numbers(*says, "pos", 3, 3);
        site.p_BS = {p[0], p[1], p[2]};
      }
      sites_.emplace(child.attribute("name"), site);
    }
  }

  void read(MjcfElement& e) {
    const MjcfElement* active = equality_saying(defaults_, e, "active");
    if (active == nullptr || active->attribute("active") != "false")
      said_.emplace_back(softness_of_equality(e, defaults_), mjcf_place(e, document_.path()));
    if (!e.has("site1") && !e.has("site2")) return;
    const Site &a = site(e, "site1"), &b = site(e, "site2");
    if (e.attribute("name").empty()) e.set("name", fmt::format("connect_of_sites_{}", found_.ends.size()));
    e.remove("site1"), e.remove("site2");
    e.set("body1", name_of(*a.body)), e.set("body2", name_of(*b.body));
    e.set("anchor", fmt::format("{} {} {}", a.p_BS.x(), a.p_BS.y(), a.p_BS.z()));
    found_.ends[std::string(e.attribute("name"))] = b.p_BS;
  }

  const Site& site(const MjcfElement& e, const char* attribute) const {
    const auto found = sites_.find(std::string(e.attribute(attribute)));
    if (found == sites_.end())
      fail_at(e, fmt::format("a site of this file in {}", attribute),
              fmt::format("'{}'", printable_text(e.attribute(attribute), 200)));
    return found->second;
  }

  std::string name_of(MjcfElement& body) {
    if (body.tag == "worldbody") return "world";
    if (!body.has("name")) body.set("name", fmt::format("body_{}", body.line));
    return std::string(body.attribute("name"));
  }

  /// Warns of those that are not as soft as all are then.
  void choose_softness() {
    for (const auto& [softness, place] : said_) {
      if (!found_.softness) found_.softness = softness;
    }
    for (const auto& [softness, place] : said_) {
      if (text_of(softness) != text_of(found_.softness))
        warnings_.count(
            fmt::format("gave all loops the softness of the first <connect> that says one ({}), in the place "
                        "of another ({}) of ",
                        text_of(found_.softness), text_of(softness)),
            " <connect>", place);
    }
  }

  static std::string text_of(const std::optional<Softness>& s) {
    return s ? fmt::format("{:g} {:g}, {:g} {:g} {:g}", s->time_constant, s->damping_ratio, s->impedance_min,
                           s->impedance_max, s->impedance_width)
             : "none said";
  }

  MjcfDocument& document_;
  const MjcfDefaults& defaults_;
  ReaderWarnings& warnings_;
  std::map<std::string, Site> sites_;
  MjcfConnects found_;
  std::vector<std::pair<std::optional<Softness>, std::string>> said_;  ///< and where
};

}  // namespace

const MjcfElement* equality_saying(const MjcfDefaults& defaults, const MjcfElement& element,
                                   std::string_view attribute) {
  if (element.has(attribute)) return &element;
  const MjcfElement* found = nullptr;
  for (const MjcfElement* section : defaults.sections(element.attribute("class"))) {
    for (const MjcfElement& of_class : section->children)
      if (of_class.tag == "equality" && of_class.has(attribute)) found = &of_class;
  }
  return found;
}

std::optional<Softness> softness_of_equality(const MjcfElement& element, const MjcfDefaults& defaults) {
  const auto numbers = [&](const char* attribute, std::size_t most) {
    const MjcfElement* says = equality_saying(defaults, element, attribute);
    return says == nullptr ? std::vector<double>() : mjcf_numbers(*says, attribute, 1, most);
  };
  const std::vector<double> solref = numbers("solref", 2), solimp = numbers("solimp", 5);
  if (solref.empty() && solimp.empty()) return std::nullopt;
  const Softness usual;
  std::array<double, 2> all_solref{usual.time_constant, usual.damping_ratio};
  std::array<double, 5> all_solimp{usual.impedance_min, usual.impedance_max, usual.impedance_width,
                                   usual.impedance_midpoint, usual.impedance_power};
  std::copy(solref.begin(), solref.end(), all_solref.begin());
  std::copy(solimp.begin(), solimp.end(), all_solimp.begin());
  return softness_of(all_solref, all_solimp);
}

MjcfConnects take_connects(MjcfDocument& document, const MjcfDefaults& defaults, ReaderWarnings& warnings) {
  return ConnectReader(document, defaults, warnings).read();
}

}  // namespace crossgait
