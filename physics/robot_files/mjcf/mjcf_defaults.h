// What the classes of an MJCF's <default> say of its elements.
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "physics/robot_files/mjcf/mjcf_document.h"

namespace crossgait {

/// Reads between `least` and `most` finite numbers of an attribute. @throws ConfigError naming the element
std::vector<double> mjcf_numbers(const MjcfElement& element, std::string_view name, std::size_t least,
                                 std::size_t most);

/// Resolves attributes for which no compiler is asked: those that only newer ones know, and those that mean
/// something to us alone. Independent of the document that it was made of, which may change.
class MjcfDefaults {
 public:
  explicit MjcfDefaults(const MjcfElement& root);
  MjcfDefaults(const MjcfDefaults&) = delete;  // it points into itself
  MjcfDefaults& operator=(const MjcfDefaults&) = delete;
  ~MjcfDefaults() = default;

  bool has(std::string_view name) const { return classes_.contains(name); }
  /// Lists the sections that apply to a class, class by class, outermost first.
  /// @param name  "": that of all elements
  std::vector<std::vector<const MjcfElement*>> sections_by_class(std::string_view name) const;
  /// Lists them all, outermost first.
  std::vector<const MjcfElement*> sections(std::string_view name) const;
  /// Finds the element that says an attribute: the element itself, or one of its kind in its class or in a
  /// class around that one. @param class_name  of the element  @returns null if none does
  const MjcfElement* find(const MjcfElement& element, std::string_view class_name,
                          std::string_view attribute) const;

 private:
  struct Class {
    std::string outer;  ///< name of the class around it; of the main one: its own
    std::vector<MjcfElement> sections;
    /// Who says an attribute last, by tag and attribute: files may have a class of very many elements.
    std::map<std::pair<std::string_view, std::string_view>, const MjcfElement*> says;
  };
  /// Visits the class of a name and those around it, no more than an XML may be deep: a file may call one its
  /// own outer one. @param visit  is called with each, until it returns true
  template <typename Visit>
  void for_each_outwards(std::string_view name, const Visit& visit) const;
  void add(const MjcfElement& section, const std::string& name, const std::string& outer);

  std::map<std::string, Class, std::less<>> classes_;  ///< the main one by the name ""
};

/// Returns the class of what stands in a body, or frame, and has none of its own. @param outer  of the body
inline std::string class_inside(const MjcfElement& body, const std::string& outer) {
  return body.attribute("childclass").empty() ? outer : std::string(body.attribute("childclass"));
}
/// Returns an element's class. @param inside  of its body
inline std::string class_of(const MjcfElement& element, const std::string& inside) {
  return element.has("class") ? std::string(element.attribute("class")) : inside;
}

/// Calls the function for every joint and geom of a body and of those below it, with its class: its own, or
/// that of the nearest body around it that has a childclass. Frames are written out before (mjcf_frames.h).
/// @param class_name  of what has none
template <typename Element, typename Function>
void for_each_with_class(Element& body, const std::string& class_name, const Function& function) {
  const std::string here = class_inside(body, class_name);
  for (auto& child : body.children) {
    if (child.tag == "body") {
      for_each_with_class(child, here, function);
    } else if (child.tag == "joint" || child.tag == "geom") {
      function(child, class_of(child, here));
    }
  }
}

}  // namespace crossgait
