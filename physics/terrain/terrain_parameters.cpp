#include "physics/terrain/terrain_parameters.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "physics/core/error.h"
#include "physics/core/find_row.h"
#include "physics/core/text.h"

namespace crossgait {

std::string quoted(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  std::string result = "'";
  for (const char c : text.substr(0, kLongest)) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte >= 0x7f) {
      result += fmt::format("\\x{:02x}", byte);
    } else {
      result += c;
    }
  }
  return result + (text.size() > kLongest ? "...'" : "'");
}

TerrainValues::TerrainValues(std::span<const TerrainParameter> table,
                             const std::optional<std::string_view>& list, std::string source)
    : source_(std::move(source)) {
  for (const TerrainParameter& parameter : table) values_[parameter.name] = parameter.value;
  if (!list) return;
  for (const std::string_view item : parts_of(*list, ",")) read(table, item);
}

void TerrainValues::read(std::span<const TerrainParameter> table, std::string_view item) {
  const std::size_t equals = item.find('=');
  if (equals == std::string_view::npos)
    throw ConfigError(source_, "parameters", "key=value,...", quoted(item));
  const std::string_view name = item.substr(0, equals);
  const std::string_view text = item.substr(equals + 1);
  if (table.empty()) throw ConfigError(source_, "parameters", "no parameters", quoted(name));
  const TerrainParameter* const parameter = &find_row(table, name, source_, "parameters");
  if (!given_.insert(parameter->name).second) {
    throw ConfigError(source_, name, "one value", "a second one, " + quoted(text));
  }
  const std::optional<double> value = parse_number(text);
  const bool whole_enough = !parameter->whole || (value && std::floor(*value) == *value);
  if (!value || !whole_enough || *value < parameter->min || *value > parameter->max) {
    throw ConfigError(
        source_, name,
        fmt::format("a {}number in [{:.16g}, {:.16g}]{}{}", parameter->whole ? "whole " : "", parameter->min,
                    parameter->max, parameter->unit.empty() ? "" : " ", parameter->unit),
        quoted(text));
  }
  values_[parameter->name] = *value;
}

}  // namespace crossgait
