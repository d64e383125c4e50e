#include "parity/margin.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/core/text.h"
#include "physics/core/yaml_reader.h"

namespace crossgait {
namespace {

// One part of a margin onto `margin`; false if it is none.
bool add_part(std::string_view text, Margin& margin) {
  double factor = 1;
  double* member = &margin.absolute;
  if (text.ends_with('%')) {
    text.remove_suffix(1);
    factor = 0.01;
    member = &margin.relative;
  } else if (text.ends_with("/s")) {
    text.remove_suffix(2);
    margin.per_second = true;
  }
  const std::optional<double> number = parse_number(text);
  if (!number || *number <= 0 || *member != 0) return false;
  *member = factor * *number;
  return true;
}

}  // namespace

double Margin::at(double size, double seconds) const noexcept {
  return std::max(relative * size, per_second ? absolute * seconds : absolute);
}

std::string Margin::words(std::string_view unit) const {
  const std::string share = fmt::format("{:g} %", 100 * relative);
  std::string amount = fmt::format("{:g}{}{}{}", absolute, unit == "-" ? "" : " ", unit == "-" ? "" : unit,
                                   per_second ? " a second" : "");
  if (relative == 0) return amount;
  return absolute == 0 ? share : fmt::format("{} or {}", share, amount);
}

Margin parse_margin(std::string_view text, std::string_view source, std::string_view key) {
  Margin margin;
  margin.reason = kStatedByUser;
  const std::size_t comma = text.find(',');
  const bool ok = add_part(text.substr(0, comma), margin) &&
                  (comma == std::string_view::npos || add_part(text.substr(comma + 1), margin));
  if (!ok) {
    throw ConfigError(source, key, "a share (5%), an amount (0.02, or 0.02/s) or both (5%,0.02), above zero",
                      std::string(text));
  }
  return margin;
}

void add_margins(const std::vector<std::string>& assignments, Margins& margins) {
  for (const std::string& assignment : assignments) {
    const std::size_t equals = assignment.find('=');
    if (equals == std::string::npos) throw ConfigError("command line", "--margin", "KEY=MARGIN", assignment);
    const std::string key = assignment.substr(0, equals);
    margins[key] = parse_margin(std::string_view(assignment).substr(equals + 1), "--margin", key);
  }
}

Margins read_margins(const std::string& path) {
  const YamlValue root = YamlValue::load(path);
  Margins margins;
  for (const auto& [key, value] : root.entries())
    margins[key] = parse_margin(value.text(), path, value.element());
  return margins;
}

}  // namespace crossgait
