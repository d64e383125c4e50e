#include "physics/robot_files/urdf/urdf_elements.h"

#include <algorithm>
#include <map>
#include <set>
#include <sstream>
#include <vector>

#include <fmt/format.h>
#include <tinyxml.h>

#include "physics/core/error.h"
#include "physics/core/text.h"
#include "physics/robot_files/xml_text.h"

namespace crossgait {
namespace {

/// How many numbers an attribute lists; 0 is text. Missing ones are errors where `required`.
struct AttributeRule {
  std::size_t numbers = 0;
  bool required = false;
};

/// What an element of a URDF may hold.
struct ElementRule {
  std::map<std::string_view, AttributeRule> attributes;
  std::vector<std::string_view> children;
};

constexpr AttributeRule kText{0, false}, kNumber{1, false}, kNeededNumber{1, true}, kVector{3, false};

const std::map<std::string_view, ElementRule>& rules() {
  static const std::map<std::string_view, ElementRule> table{
      {"link", {{{"name", kText}}, {"inertial", "collision"}}},
      {"inertial", {{}, {"origin", "mass", "inertia"}}},
      {"origin", {{{"xyz", kVector}, {"rpy", kVector}}, {}}},
      {"mass", {{{"value", kNeededNumber}}, {}}},
      {"inertia",
       {{{"ixx", kNeededNumber},
         {"ixy", kNeededNumber},
         {"ixz", kNeededNumber},
         {"iyy", kNeededNumber},
         {"iyz", kNeededNumber},
         {"izz", kNeededNumber}},
        {}}},
      {"collision", {{{"name", kText}}, {"origin", "geometry"}}},
      {"geometry", {{}, {"sphere", "box", "cylinder", "capsule", "mesh"}}},
      {"sphere", {{{"radius", kNeededNumber}}, {}}},
      {"box", {{{"size", {3, true}}}, {}}},
      {"cylinder", {{{"radius", kNeededNumber}, {"length", kNeededNumber}}, {}}},
      {"capsule", {{{"radius", kNeededNumber}, {"length", kNeededNumber}}, {}}},
      {"mesh", {{{"filename", {0, true}}, {"scale", kVector}}, {}}},
      {"joint",
       {{{"name", kText}, {"type", kText}}, {"origin", "parent", "child", "axis", "limit", "dynamics"}}},
      {"visual", {{{"name", kText}}, {"origin", "geometry", "material"}}},
      {"material", {{{"name", kText}}, {"color", "texture"}}},
      {"color", {{{"rgba", kText}}, {}}},
      {"texture", {{{"filename", kText}}, {}}},
      {"mimic", {{{"joint", kText}, {"multiplier", kText}, {"offset", kText}}, {}}},
      {"parent", {{{"link", kText}}, {}}},
      {"child", {{{"link", kText}}, {}}},
      {"axis", {{{"xyz", kVector}}, {}}},
      {"limit", {{{"lower", kNumber}, {"upper", kNumber}, {"effort", kNumber}, {"velocity", kNumber}}, {}}},
      {"dynamics", {{{"damping", kNumber}, {"friction", kNumber}}, {}}},
  };
  return table;
}

/// So many finite numbers, apart by one space each; empty for anything else.
std::string plain_numbers(const std::string& text, std::size_t count) {
  std::istringstream words(text);
  std::string result;
  std::size_t found = 0;
  for (std::string word; words >> word; ++found) {
    if (!parse_number(word)) return "";
    result += (result.empty() ? "" : " ") + word;
  }
  return found == count ? result : "";
}

TiXmlElement& add_child(TiXmlElement& parent, const char* tag) {
  return *parent.InsertEndChild(TiXmlElement(tag))->ToElement();
}

/// Copies one link or joint.
class ElementCopy {
 public:
  ElementCopy(const TiXmlElement& top, const UrdfErrors& errors, ReaderWarnings& warnings)
      : top_(top), errors_(errors), warnings_(warnings) {}

  void copy(const TiXmlElement& from, const std::string& path, TiXmlElement& to) {
    const ElementRule& rule = rules().at(from.ValueStr());
    copy_attributes(from, rule, path, to);
    const bool is_geometry = from.ValueStr() == "geometry";
    std::set<std::string> seen;
    for (auto* c = from.FirstChildElement(); c != nullptr; c = c->NextSiblingElement()) {
      const std::string& tag = c->ValueStr();
      const bool in_link = from.ValueStr() == "link", in_joint = from.ValueStr() == "joint";
      const bool is_contact = in_link && tag == "contact", is_mimic = in_joint && tag == "mimic";
      if ((is_contact || is_mimic) && !seen.insert(tag).second) {
        count("ignored ", fmt::format(" further <{}>", tag), *c);
      } else if (is_contact) {
        continue;  // read by urdf_contact.h, which counts what is unknown
      } else if (is_mimic || (in_link && tag == "visual")) {
        count_unknown(*c);  // read by urdf_visuals.h, urdf_check.cpp
      } else if (std::find(rule.children.begin(), rule.children.end(), tag) == rule.children.end()) {
        ignore(*c);
      } else if (tag != "collision" && (!seen.insert(tag).second || (is_geometry && seen.size() > 1))) {
        if (tag == "parent" || tag == "child")
          errors_.fail(*c, path, fmt::format("one <{}>", tag), "several");
        count("ignored ", fmt::format(" further <{}>", tag), *c);
      } else {
        copy(*c, fmt::format("{}, {}", path, tag), add_child(to, tag.c_str()));
      }
    }
    complete(from, path, to);
  }

 private:
  void count(std::string_view before, std::string_view after, const TiXmlElement& at) {
    warnings_.count(before, after, urdf_place(top_, at));
  }

  /// Of an element that is read elsewhere what nobody reads.
  void count_unknown(const TiXmlElement& element) {
    const ElementRule& rule = rules().at(element.ValueStr());
    for (auto* a = element.FirstAttribute(); a != nullptr; a = a->Next()) {
      if (!rule.attributes.contains(a->Name())) ignore(*a, element);
    }
    std::set<std::string> seen;
    for (auto* c = element.FirstChildElement(); c != nullptr; c = c->NextSiblingElement()) {
      const std::string& tag = c->ValueStr();
      if (std::find(rule.children.begin(), rule.children.end(), tag) == rule.children.end()) {
        ignore(*c);
      } else if (!seen.insert(tag).second) {
        count("ignored ", fmt::format(" further <{}>", tag), *c);
      } else {
        count_unknown(*c);
      }
    }
  }

  void ignore(const TiXmlAttribute& unknown, const TiXmlElement& of) {
    warnings_.ignore_attribute(unknown.Name(), unknown.Value(), of.Value(), urdf_place(top_, of));
  }
  void ignore(const TiXmlElement& unknown) {
    warnings_.ignore_element(fmt::format("<{}>", unknown.Value()), urdf_place(top_, unknown),
                             held_numbers(unknown));
  }

  void copy_attributes(const TiXmlElement& from, const ElementRule& rule, const std::string& path,
                       TiXmlElement& to) {
    for (auto* a = from.FirstAttribute(); a != nullptr; a = a->Next()) {
      const auto known = rule.attributes.find(a->Name());
      if (known == rule.attributes.end()) {
        ignore(*a, from);
        continue;
      }
      std::string value = a->ValueStr();
      if (const std::size_t numbers = known->second.numbers; numbers > 0) {
        value = plain_numbers(value, numbers);
        if (value.empty()) {
          errors_.fail(from, fmt::format("{}, {}", path, a->Name()),
                       fmt::format("{} finite number(s)", numbers), fmt::format("'{}'", a->Value()));
        }
      }
      to.SetAttribute(a->NameTStr(), value);
    }
    for (const auto& [name, attribute] : rule.attributes) {
      if (attribute.required && attribute_of(to, name.data()).empty()) {
        errors_.fail(from, path, fmt::format("attribute '{}'", name), "none");
      }
    }
  }

  /// What urdfdom demands and real files leave out; and takes out again what it does not take.
  void complete(const TiXmlElement& from, const std::string& path, TiXmlElement& to) {
    const std::string& tag = from.ValueStr();
    if (tag == "inertial") {
      if (to.FirstChildElement("mass") == nullptr) errors_.fail(from, path, "an element <mass>", "none");
      if (to.FirstChildElement("inertia") == nullptr) {
        count("took ", " <inertial> without <inertia> for point mass(es)", from);
        TiXmlElement& zero = add_child(to, "inertia");
        for (const char* name : {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"}) zero.SetAttribute(name, "0");
      }
    } else if (tag == "link") {
      drop_empty_collisions(from, to);
    } else if (tag == "capsule") {
      const std::string sizes = attribute_of(to, "radius") + " " + attribute_of(to, "length") + " 0";
      to.SetValue("mesh");
      to.SetAttribute("filename", kCapsuleMesh);
      to.SetAttribute("scale", sizes);
    } else if (tag == "limit") {
      for (const char* name : {"effort", "velocity"}) {
        if (to.Attribute(name) == nullptr) to.SetAttribute(name, "0");
      }
    } else if (tag == "joint") {
      complete_joint(to);
    }
  }

  void drop_empty_collisions(const TiXmlElement& from, TiXmlElement& to) {
    for (auto* collision = to.FirstChildElement("collision"); collision != nullptr;) {
      TiXmlElement* const next = collision->NextSiblingElement("collision");
      const TiXmlElement* geometry = collision->FirstChildElement("geometry");
      if (geometry == nullptr || geometry->NoChildren()) {
        count("dropped ", " <collision> without a sphere, box, cylinder, capsule or mesh", from);
        to.RemoveChild(collision);
      }
      collision = next;
    }
  }

  static void complete_joint(TiXmlElement& to) {
    if (attribute_of(to, "type") == "revolute" && to.FirstChildElement("limit") == nullptr) {
      TiXmlElement& none = add_child(to, "limit");  // lower = upper = 0: no limit
      for (const char* name : {"effort", "velocity"}) none.SetAttribute(name, "0");
    }
    TiXmlElement* dynamics = to.FirstChildElement("dynamics");
    if (dynamics != nullptr && dynamics->FirstAttribute() == nullptr) to.RemoveChild(dynamics);
  }

  const TiXmlElement& top_;
  const UrdfErrors& errors_;
  ReaderWarnings& warnings_;
};

}  // namespace

std::string urdf_label(const TiXmlElement& link_or_joint) {
  return fmt::format("{} '{}'", link_or_joint.Value(),
                     printable_text(attribute_of(link_or_joint, "name"), 200));
}

std::string urdf_place(const TiXmlElement& link_or_joint, const TiXmlElement& at) {
  return fmt::format("{} (line {})", urdf_label(link_or_joint), at.Row());
}

void UrdfErrors::fail(const TiXmlElement& at, std::string_view element, std::string_view expected,
                      std::string_view found) const {
  throw ConfigError(source_, fmt::format("line {}, {}", at.Row(), element), expected, found);
}

void UrdfErrors::fail(const TiXmlElement& link_or_joint, std::string_view expected,
                      std::string_view found) const {
  fail(link_or_joint, urdf_label(link_or_joint), expected, found);
}

double UrdfErrors::number(const TiXmlElement& at, std::string_view element, const std::string& text,
                          bool may_be_negative) const {
  const auto value = parse_number(text);
  if (!value || (!may_be_negative && *value < 0))
    fail(at, element, may_be_negative ? "1 finite number" : "a number from 0 on",
         fmt::format("'{}'", printable_text(text, kMostOfAValue)));
  return *value;
}

UnusedQuantity unused_word(const std::string& of, std::string_view word, const std::string& value,
                           std::string_view why) {
  return {of, std::string(word), printable_text(value, kMostOfAValue), "",
          fmt::format("not simulated: {}", why)};
}

void copy_urdf_element(const TiXmlElement& link_or_joint, TiXmlElement& copy, const UrdfErrors& errors,
                       ReaderWarnings& warnings) {
  ElementCopy(link_or_joint, errors, warnings).copy(link_or_joint, urdf_label(link_or_joint), copy);
}

}  // namespace crossgait
