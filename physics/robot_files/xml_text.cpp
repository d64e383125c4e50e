#include "physics/robot_files/xml_text.h"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>
#include <tinyxml.h>

#include "physics/core/error.h"

namespace crossgait {
namespace {

/// What TinyXML cannot read: it would take the rest of the file for text.
void refuse_own_entities(std::string_view text, const std::string& source) {
  for (std::size_t at = text.find('<'); at < text.size(); at = text.find('<', at)) {
    const std::string_view here = text.substr(at);
    if (here.starts_with("<!DOCTYPE") && here.find('[') < here.find('>')) {
      const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
      throw ConfigError(source, fmt::format("line {}", line), "XML that defines no entities of its own",
                        "<!DOCTYPE ... [");
    }
    if (!here.starts_with("<!") && !here.starts_with("<?")) return;  // the element
    const std::string_view end = here.starts_with("<!--") ? "-->" : ">";
    at += std::min(here.find(end), here.size() - 1);
  }
}

}  // namespace

void parse_xml(const std::string& text, const ReadBudget& budget, const std::string& source,
               TiXmlDocument& document) {
  check_xml_budget(text, budget, source);
  refuse_own_entities(text, source);
  document.Parse(text.c_str(), nullptr, TIXML_ENCODING_UTF8);
  if (document.Error()) {
    throw ConfigError(source, fmt::format("line {}", document.ErrorRow()), "well-formed XML",
                      document.ErrorDesc());
  }
  const TiXmlElement* const root = document.RootElement();
  const TiXmlElement* const second = root == nullptr ? nullptr : root->NextSiblingElement();
  if (second != nullptr) {
    throw ConfigError(source, fmt::format("line {}", second->Row()), "one element around all others",
                      fmt::format("<{}> behind <{}>", second->Value(), root->Value()));
  }
}

std::string trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\n";
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return "";
  return std::string(text.substr(first, text.find_last_not_of(kBlanks) - first + 1));
}

std::string attribute_of(const TiXmlElement& element, const char* name) {
  const char* value = element.Attribute(name);
  return value == nullptr ? "" : value;
}

namespace {

void add_numbers(const TiXmlElement& element, HeldNumbers& numbers) {
  for (auto* a = element.FirstAttribute(); a != nullptr; a = a->Next()) numbers.add(a->Name(), a->Value());
  if (const char* text = element.GetText()) numbers.add(element.Value(), text);
  for (auto* e = element.FirstChildElement(); e != nullptr; e = e->NextSiblingElement())
    add_numbers(*e, numbers);
}

}  // namespace

HeldNumbers held_numbers(const TiXmlElement& element) {
  HeldNumbers numbers;
  add_numbers(element, numbers);
  return numbers;
}

}  // namespace crossgait
