#include "physics/robot_files/xml_text.h"

#include <fmt/format.h>
#include <tinyxml.h>

#include "physics/core/error.h"

namespace crossgait {

void parse_xml(const std::string& text, const ReadBudget& budget, const std::string& source,
               TiXmlDocument& document) {
  check_xml_budget(text, budget, source);
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
