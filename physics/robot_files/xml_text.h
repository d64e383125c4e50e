// XML of robot files, read within its budget.
#pragma once

#include <string>
#include <string_view>

#include "physics/core/read_budget.h"
#include "physics/robot_files/reader_warnings.h"

class TiXmlDocument;
class TiXmlElement;

namespace crossgait {

/// Parses XML within a budget, which is checked first: TinyXML calls itself for elements inside elements.
/// @throws ConfigError naming `source` and the line where it is not well-formed
void parse_xml(const std::string& text, const ReadBudget& budget, const std::string& source,
               TiXmlDocument& document);

/// Returns the text without the blanks around it.
std::string trimmed(std::string_view text);

/// Returns the attribute of that name, or "".
std::string attribute_of(const TiXmlElement& element, const char* name);

/// Lists the numbers of an element and of those in it, in attributes and as text.
HeldNumbers held_numbers(const TiXmlElement& element);

}  // namespace crossgait
