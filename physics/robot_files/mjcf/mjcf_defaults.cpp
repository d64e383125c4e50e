#include "physics/robot_files/mjcf/mjcf_defaults.h"

#include <sstream>

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/core/read_budget.h"
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
  for (auto& [name, known] : classes_) {
    for (const MjcfElement& section : known.sections) {
      for (const MjcfElement& e : section.children) {
        for (const auto& [attribute, value] : e.attributes) known.says[{e.tag, attribute}] = &e;
      }
    }
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

template <typename Visit>
void MjcfDefaults::for_each_outwards(std::string_view name, const Visit& visit) const {
  std::string_view next = name;
  for (int level = 0; level <= kMjcfBudget.depth; ++level) {
    const auto found = classes_.find(next);
    if (found == classes_.end() || visit(found->second) || next.empty()) return;
    next = found->second.outer;
  }
}

std::vector<std::vector<const MjcfElement*>> MjcfDefaults::sections_by_class(std::string_view name) const {
  std::vector<std::vector<const MjcfElement*>> inner_first;
  for_each_outwards(name, [&](const Class& known) {
    std::vector<const MjcfElement*>& own = inner_first.emplace_back();
    for (const MjcfElement& section : known.sections) own.push_back(&section);
    return false;
  });
  return {inner_first.rbegin(), inner_first.rend()};
}

std::vector<const MjcfElement*> MjcfDefaults::sections(std::string_view name) const {
  std::vector<const MjcfElement*> all;
  for (const auto& of_one : sections_by_class(name)) all.insert(all.end(), of_one.begin(), of_one.end());
  return all;
}

const MjcfElement* MjcfDefaults::find(const MjcfElement& element, std::string_view class_name,
                                      std::string_view attribute) const {
  if (element.has(attribute)) return &element;
  const MjcfElement* result = nullptr;
  for_each_outwards(class_name, [&](const Class& known) {
    const auto says = known.says.find({element.tag, attribute});
    if (says != known.says.end()) result = says->second;
    return result != nullptr;
  });
  return result;
}

}  // namespace crossgait
