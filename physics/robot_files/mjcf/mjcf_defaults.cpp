#include "physics/robot_files/mjcf/mjcf_defaults.h"

#include <algorithm>
#include <sstream>

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/core/text.h"

namespace crossgait {

std::vector<double> mjcf_numbers(const MjcfElement& element, std::string_view name, std::size_t least,
                                 std::size_t most) {
  std::vector<double> numbers;
  std::istringstream words{std::string(element.attribute(name))};
  bool fine = true;
  for (std::string word; fine && words >> word;) {
    const auto number = parse_number(word);
    fine = number.has_value() && numbers.size() < most;
    if (fine) numbers.push_back(*number);
  }
  if (!fine || numbers.size() < least) {
    const std::string count = least == most ? fmt::format("{}", most) : fmt::format("{} to {}", least, most);
    fail_at(element, fmt::format("{} finite number(s) in {}", count, name),
            fmt::format("'{}'", printable_text(element.attribute(name), 200)));
  }
  return numbers;
}

MjcfDefaults::MjcfDefaults(const MjcfElement& root) {
  classes_[""];
  for (const MjcfElement& section : root.children) {
    if (section.tag == "default") add(section, "", "");
  }
}

void MjcfDefaults::add(const MjcfElement& section, const std::string& name, const std::string& outer) {
  MjcfElement own = section;
  std::erase_if(own.children, [](const MjcfElement& e) { return e.tag == "default"; });
  Class& known = classes_[name];
  known.outer = outer;
  known.sections.push_back(std::move(own));
  for (const MjcfElement& child : section.children) {
    if (child.tag == "default") add(child, std::string(child.attribute("class")), name);
  }
  // The main class has a name of its own as well.
  const std::string alias(section.attribute("class"));
  if (name.empty() && !alias.empty()) classes_[alias];
}

std::vector<const MjcfElement*> MjcfDefaults::sections(std::string_view name) const {
  std::vector<const MjcfElement*> inner_first;
  std::string_view next = name;
  // As deep as there are classes: a file may call one its own outer one.
  for (std::size_t level = 0; level <= classes_.size(); ++level) {
    const auto found = classes_.find(next);
    if (found == classes_.end()) break;
    for (auto section = found->second.sections.rbegin(); section != found->second.sections.rend(); ++section)
      inner_first.push_back(&*section);
    if (next.empty()) break;
    next = found->second.outer;
  }
  return {inner_first.rbegin(), inner_first.rend()};
}

const MjcfElement* MjcfDefaults::find(const MjcfElement& element, std::string_view class_name,
                                      std::string_view attribute) const {
  if (element.has(attribute)) return &element;
  const std::vector<const MjcfElement*> outer_first = sections(class_name);
  for (auto section = outer_first.rbegin(); section != outer_first.rend(); ++section) {
    const auto& children = (*section)->children;
    const auto says = std::find_if(children.rbegin(), children.rend(), [&](const MjcfElement& e) {
      return e.tag == element.tag && e.has(attribute);
    });
    if (says != children.rend()) return &*says;
  }
  return nullptr;
}

}  // namespace crossgait
