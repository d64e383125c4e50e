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
}

std::string attribute_of(const TiXmlElement& element, const char* name) {
  const char* value = element.Attribute(name);
  return value == nullptr ? "" : value;
}

}  // namespace crossgait
