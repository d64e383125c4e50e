#include "physics/robot_files/urdf/urdf_check.h"

#include <algorithm>
#include <map>
#include <set>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tinyxml.h>

#include "physics/core/error.h"
#include "physics/core/read_budget.h"
#include "physics/core/text.h"
#include "physics/robot_files/urdf/urdf_elements.h"
#include "physics/robot_files/urdf/urdf_visuals.h"
#include "physics/robot_files/xml_text.h"

namespace crossgait {
namespace {

/// The first element that xacro would have expanded, or null.
const TiXmlElement* find_xacro(const TiXmlElement& element) {
  if (element.ValueStr().starts_with("xacro:")) return &element;
  for (auto* e = element.FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
    if (const TiXmlElement* found = find_xacro(*e)) return found;
  }
  return nullptr;
}

bool has_mass(const TiXmlElement& link) {
  const TiXmlElement* inertial = link.FirstChildElement("inertial");
  const TiXmlElement* mass = inertial == nullptr ? nullptr : inertial->FirstChildElement("mass");
  return mass != nullptr && parse_number(attribute_of(*mass, "value")) != 0.0;
}

class UrdfCheck {
 public:
  UrdfCheck(const TiXmlElement& robot, const std::string& source, ReaderWarnings& warnings)
      : robot_(robot), errors_(source), warnings_(warnings) {}

  /// Appends what is left of links and joints to `copy`.
  void run(TiXmlElement& copy) {
    for (const char* name : {"name", "version"}) {
      if (robot_.Attribute(name) != nullptr) copy.SetAttribute(name, robot_.Attribute(name));
    }
    for_each("link", [&](const TiXmlElement& link) {
      if (links_.count(name_of(link)) > 0) errors_.fail(link, "a unique name", "a second link of this name");
      if (links_.size() == kMaxUrdfLinks) {
        errors_.fail(link, fmt::format("at most {} links", kMaxUrdfLinks), "more");
      }
      links_.emplace(name_of(link), &add_copy(link, copy));
    });
    if (links_.empty()) errors_.fail(robot_, "at least one link", "none");
    std::set<std::string> joints;
    for_each("joint", [&](const TiXmlElement& joint) {
      if (!joints.insert(name_of(joint)).second) {
        errors_.fail(joint, "a unique name", "a second joint of this name");
      }
      check_type(joint);
      TiXmlElement& copied = add_copy(joint, copy);
      add_edge(joint);
      add_coupling(joint);
      if (attribute_of(joint, "type") == "floating") floating_.emplace_back(&joint, &copied);
    });
    check_couplings();
    free_base(find_root(), copy);
  }

  std::vector<NamedCoupling> couplings() const {
    std::vector<NamedCoupling> found;
    for (const auto& [mimic, coupling] : couplings_) found.push_back(coupling);
    return found;
  }

 private:
  template <typename Function>
  void for_each(const char* tag, Function function) const {
    for (auto* e = robot_.FirstChildElement(tag); e != nullptr; e = e->NextSiblingElement(tag)) function(*e);
  }

  TiXmlElement& add_copy(const TiXmlElement& element, TiXmlElement& robot) {
    TiXmlElement& copy = *robot.InsertEndChild(TiXmlElement(element.Value()))->ToElement();
    copy_urdf_element(element, copy, errors_, warnings_);
    return copy;
  }

  std::string name_of(const TiXmlElement& element) const {
    std::string name = attribute_of(element, "name");
    if (name.empty()) errors_.fail(element, "attribute 'name'", "none");
    if (name.size() > kMaxUrdfName) {
      errors_.fail(element, fmt::format("a name of at most {}", size_in_words(kMaxUrdfName)),
                   size_in_words(name.size()));
    }
    return name;
  }

  void check_type(const TiXmlElement& joint) const {
    const std::string type = attribute_of(joint, "type");
    if (type != "revolute" && type != "continuous" && type != "fixed" && type != "floating") {
      errors_.fail(joint, "type revolute, continuous or fixed", fmt::format("'{}'", type));
    }
  }

  std::string linked(const TiXmlElement& joint, const char* role) const {
    const TiXmlElement* element = joint.FirstChildElement(role);
    std::string name = element == nullptr ? "" : attribute_of(*element, "link");
    if (links_.count(name) == 0) {
      errors_.fail(joint, fmt::format("a {} link of this file", role), fmt::format("'{}'", name));
    }
    return name;
  }

  void add_edge(const TiXmlElement& joint) {
    const std::string parent = linked(joint, "parent");
    const std::string child = linked(joint, "child");
    const auto [other, inserted] = parents_.emplace(child, parent);
    if (!inserted) {
      errors_.fail(joint, fmt::format("one parent of link '{}'", child),
                   fmt::format("'{}' and '{}'", other->second, parent));
    }
  }

  void add_coupling(const TiXmlElement& joint) {
    const TiXmlElement* mimic = joint.FirstChildElement("mimic");
    const std::string type = attribute_of(joint, "type");
    if (type == "revolute" || type == "continuous") moving_.insert(name_of(joint));
    if (mimic == nullptr) return;
    const auto number = [&](const char* name, double usual) {
      if (mimic->Attribute(name) == nullptr) return usual;
      return errors_.number(*mimic, fmt::format("joint '{}', mimic, {}", name_of(joint), name),
                            attribute_of(*mimic, name), true);
    };
    NamedCoupling coupling;
    coupling.follower = name_of(joint);
    coupling.leader = attribute_of(*mimic, "joint");
    coupling.coefficients = {number("offset", 0), number("multiplier", 1)};
    coupling.place = fmt::format("mimic (line {})", mimic->Row());
    couplings_.emplace_back(mimic, std::move(coupling));
  }

  /// Of what is fixed a `<mimic>` means nothing.
  void check_couplings() {
    for (const auto& [mimic, coupling] : couplings_) {
      if (moving_.contains(coupling.follower) && !moving_.contains(coupling.leader))
        errors_.fail(*mimic, fmt::format("joint '{}', mimic, joint", coupling.follower),
                     "a joint of this file that moves",
                     fmt::format("'{}'", printable_text(coupling.leader, 200)));
    }
    std::erase_if(couplings_, [this](const auto& c) { return !moving_.contains(c.second.follower); });
  }

  std::string find_root() const {
    std::vector<std::string> roots;
    std::map<std::string, std::string> from;  // links that a way to the root came past, by where it began
    for (const auto& [link, element] : links_) {
      if (parents_.count(link) == 0) roots.push_back(link);
      // Up to the root, or to a link from where the way is known. Coming past a link twice: in circles.
      for (auto at = parents_.find(link); at != parents_.end(); at = parents_.find(at->second)) {
        const auto [known, is_new] = from.emplace(at->first, link);
        if (is_new) continue;
        if (known->second == link) {
          errors_.fail(robot_, fmt::format("link '{}'", link), "a tree of links", "a cycle of joints");
        }
        break;
      }
    }
    if (roots.size() != 1) {
      errors_.fail(robot_, "one root link", fmt::format("'{}'", fmt::join(roots, "', '")));
    }
    return roots.front();
  }

  /// Takes away a root that stands for the world. Every other floating joint is an error.
  void free_base(const std::string& root, TiXmlElement& copy) {
    if (floating_.empty()) {
      if (root == "world" && !has_mass(*links_.at(root)))
        warnings_.add("the file fixes its base to link 'world'; here the base is free");
      return;
    }
    const auto& [joint, copied] = floating_.front();
    const auto below_root = std::count_if(parents_.begin(), parents_.end(),
                                          [&](const auto& edge) { return edge.second == root; });
    TiXmlElement* const link = links_.at(root);
    if (floating_.size() > 1 || linked(*joint, "parent") != root || below_root > 1 || has_mass(*link)) {
      errors_.fail(
          *floating_.back().first,
          "type revolute, continuous or fixed (floating only below a root without mass that has no other "
          "joint)",
          "'floating'");
    }
    warnings_.add(fmt::format("left out root link '{}' and joint '{}': link '{}' is the free base", root,
                              attribute_of(*joint, "name"), linked(*joint, "child")));
    copy.RemoveChild(link);
    copy.RemoveChild(copied);
  }

  const TiXmlElement& robot_;
  UrdfErrors errors_;
  ReaderWarnings& warnings_;
  std::map<std::string, TiXmlElement*> links_;  ///< their copies
  std::map<std::string, std::string> parents_;
  std::vector<std::pair<const TiXmlElement*, TiXmlElement*>> floating_;  ///< joints and their copies
  std::set<std::string> moving_;                                         ///< joints
  std::vector<std::pair<const TiXmlElement*, NamedCoupling>> couplings_;
};

}  // namespace

CheckedUrdf check_urdf(const std::string& text, const std::string& source, ReaderWarnings& warnings) {
  TiXmlDocument document;
  parse_xml(text, kUrdfBudget, source, document);
  const TiXmlElement* robot = document.FirstChildElement("robot");
  if (robot == nullptr) {
    const TiXmlElement* root = document.RootElement();
    throw ConfigError(source, "file", "a <robot> element",
                      root == nullptr ? "none" : fmt::format("<{}>", printable_text(root->ValueStr(), 200)));
  }
  if (const TiXmlElement* xacro = find_xacro(*robot)) {
    throw ConfigError(source, fmt::format("line {}", xacro->Row()),
                      "an expanded URDF, or a file whose name ends in .xacro, which xacro expands",
                      fmt::format("<{}>", xacro->Value()));
  }
  TiXmlDocument checked;
  UrdfCheck check(*robot, source, warnings);
  check.run(*checked.InsertEndChild(TiXmlElement("robot"))->ToElement());
  TiXmlPrinter printer;
  printer.SetStreamPrinting();
  checked.Accept(&printer);
  return {printer.Str(), read_urdf_visuals(*robot, source, warnings), check.couplings(),
          read_urdf_extensions(*robot, UrdfErrors(source), warnings)};
}

}  // namespace crossgait
