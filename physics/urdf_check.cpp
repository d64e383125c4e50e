#include "crossgait/physics/urdf_check.h"

#include <algorithm>
#include <map>
#include <set>
#include <sstream>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tinyxml.h>

#include "crossgait/physics/error.h"
#include "crossgait/physics/read_budget.h"
#include "crossgait/physics/text.h"

namespace crossgait {
namespace {

/// What an element of a URDF may hold. The number after an attribute is how many numbers it lists; 0 is text.
struct ElementRule {
  std::map<std::string_view, std::size_t> attributes;
  std::vector<std::string_view> children;
};

const std::map<std::string_view, ElementRule>& rules() {
  static const std::map<std::string_view, ElementRule> table{
      {"link", {{{"name", 0}}, {"inertial", "collision", "visual"}}},
      {"inertial", {{}, {"origin", "mass", "inertia"}}},
      {"origin", {{{"xyz", 3}, {"rpy", 3}}, {}}},
      {"mass", {{{"value", 1}}, {}}},
      {"inertia", {{{"ixx", 1}, {"ixy", 1}, {"ixz", 1}, {"iyy", 1}, {"iyz", 1}, {"izz", 1}}, {}}},
      {"collision", {{{"name", 0}}, {"origin", "geometry"}}},
      {"geometry", {{}, {"sphere", "box", "cylinder"}}},
      {"sphere", {{{"radius", 1}}, {}}},
      {"box", {{{"size", 3}}, {}}},
      {"cylinder", {{{"radius", 1}, {"length", 1}}, {}}},
      {"joint", {{{"name", 0}, {"type", 0}}, {"origin", "parent", "child", "axis", "limit", "dynamics"}}},
      {"parent", {{{"link", 0}}, {}}},
      {"child", {{{"link", 0}}, {}}},
      {"axis", {{{"xyz", 3}}, {}}},
      {"limit", {{{"lower", 1}, {"upper", 1}, {"effort", 1}, {"velocity", 1}}, {}}},
      {"dynamics", {{{"damping", 1}, {"friction", 1}}, {}}},
  };
  return table;
}

bool all_numbers(const std::string& text, std::size_t count) {
  std::istringstream words(text);
  std::size_t found = 0;
  for (std::string word; words >> word; ++found) {
    if (!parse_number(word)) return false;
  }
  return found == count;
}

class UrdfCheck {
 public:
  UrdfCheck(const TiXmlElement& robot, const std::string& source) : robot_(robot), source_(source) {}

  void run() {
    std::set<std::string> joints;
    for_each("link", [&](const TiXmlElement& link) {
      if (!links_.insert(name_of(link)).second) fail(link, "a unique name", "a second link of this name");
      if (links_.size() > kMaxUrdfLinks) fail(link, fmt::format("at most {} links", kMaxUrdfLinks), "more");
      check_element(link, label(link));
    });
    if (links_.empty()) fail(robot_, "at least one link", "none");
    for_each("joint", [&](const TiXmlElement& joint) {
      if (!joints.insert(name_of(joint)).second) fail(joint, "a unique name", "a second joint of this name");
      check_type(joint);
      check_element(joint, label(joint));
      add_edge(joint);
    });
    check_tree();
  }

 private:
  [[noreturn]] void fail(const TiXmlElement& at, std::string_view expected, std::string_view found) const {
    fail(at, label(at), expected, found);
  }
  [[noreturn]] void fail(const TiXmlElement& at, std::string_view element, std::string_view expected,
                         std::string_view found) const {
    throw ConfigError(source_, fmt::format("line {}, {}", at.Row(), element), expected, found);
  }

  template <typename Function>
  void for_each(const char* tag, Function function) const {
    for (auto* e = robot_.FirstChildElement(tag); e != nullptr; e = e->NextSiblingElement(tag)) function(*e);
  }

  static std::string attribute(const TiXmlElement& element, const char* key) {
    const char* value = element.Attribute(key);
    return value == nullptr ? "" : value;
  }

  static std::string label(const TiXmlElement& element) {
    return fmt::format("{} '{}'", element.Value(), attribute(element, "name"));
  }

  std::string name_of(const TiXmlElement& element) const {
    std::string name = attribute(element, "name");
    if (name.empty()) fail(element, "attribute 'name'", "none");
    return name;
  }

  void check_type(const TiXmlElement& joint) const {
    const std::string type = attribute(joint, "type");
    if (type != "revolute" && type != "continuous" && type != "fixed") {
      fail(joint, "type revolute, continuous or fixed", fmt::format("'{}'", type));
    }
  }

  void check_element(const TiXmlElement& element, const std::string& path) const {
    const ElementRule& rule = rules().at(element.Value());
    for (auto* a = element.FirstAttribute(); a != nullptr; a = a->Next()) {
      const auto known = rule.attributes.find(a->Name());
      if (known == rule.attributes.end()) {
        fail(element, path, "only attributes that URDF defines here", fmt::format("'{}'", a->Name()));
      }
      if (known->second > 0 && !all_numbers(a->Value(), known->second)) {
        fail(element, fmt::format("{}, {}", path, a->Name()),
             fmt::format("{} finite number(s)", known->second), fmt::format("'{}'", a->Value()));
      }
    }
    std::set<std::string> seen;
    for (auto* c = element.FirstChildElement(); c != nullptr; c = c->NextSiblingElement()) {
      const std::string tag = c->Value();
      if (std::find(rule.children.begin(), rule.children.end(), tag) == rule.children.end()) {
        fail(*c, path, fmt::format("one of the elements {}", fmt::join(rule.children, ", ")),
             fmt::format("<{}>", tag));
      }
      if (!seen.insert(tag).second && tag != "collision" && tag != "visual") {
        fail(*c, path, fmt::format("one <{}>", tag), "several");
      }
      if (tag != "visual") check_element(*c, fmt::format("{}, {}", path, tag));
    }
  }

  std::string linked(const TiXmlElement& joint, const char* role) const {
    const TiXmlElement* element = joint.FirstChildElement(role);
    std::string name = element == nullptr ? "" : attribute(*element, "link");
    if (links_.count(name) == 0) {
      fail(joint, fmt::format("a {} link of this file", role), fmt::format("'{}'", name));
    }
    return name;
  }

  void add_edge(const TiXmlElement& joint) {
    const std::string parent = linked(joint, "parent");
    const std::string child = linked(joint, "child");
    const auto [other, inserted] = parents_.emplace(child, parent);
    if (!inserted) {
      fail(joint, fmt::format("one parent of link '{}'", child),
           fmt::format("'{}' and '{}'", other->second, parent));
    }
  }

  void check_tree() const {
    std::vector<std::string> roots;
    std::map<std::string, std::string> from;  // links that a way to the root came past, by where it began
    for (const std::string& link : links_) {
      if (parents_.count(link) == 0) roots.push_back(link);
      // Up to the root, or to a link from where the way is known. Coming past a link twice: in circles.
      for (auto at = parents_.find(link); at != parents_.end(); at = parents_.find(at->second)) {
        const auto [known, is_new] = from.emplace(at->first, link);
        if (is_new) continue;
        if (known->second == link) {
          fail(robot_, fmt::format("link '{}'", link), "a tree of links", "a cycle of joints");
        }
        break;
      }
    }
    if (roots.size() != 1) {
      fail(robot_, "one root link", fmt::format("'{}'", fmt::join(roots, "', '")));
    }
  }

  const TiXmlElement& robot_;
  const std::string& source_;
  std::set<std::string> links_;
  std::map<std::string, std::string> parents_;
};

}  // namespace

void check_urdf(const std::string& text, const std::string& source) {
  check_xml_budget(text, kUrdfBudget, source);  // TinyXML calls itself for elements inside elements
  TiXmlDocument document;
  document.Parse(text.c_str(), nullptr, TIXML_ENCODING_UTF8);
  if (document.Error()) {
    throw ConfigError(source, fmt::format("line {}", document.ErrorRow()), "well-formed XML",
                      document.ErrorDesc());
  }
  const TiXmlElement* robot = document.FirstChildElement("robot");
  if (robot == nullptr) throw ConfigError(source, "file", "a <robot> element", "none");
  UrdfCheck(*robot, source).run();
}

}  // namespace crossgait
