// Reads `key=value,...` against a table of parameters. Private to the terrain part of physics/.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>

#include "physics/terrain/terrain.h"

namespace crossgait {

/// Quotes foreign text for a message: in quotes, shortened, control characters as `\xNN`.
std::string quoted(std::string_view text);

/// Holds values of one terrain's parameters: those given, and the table's defaults for the rest.
class TerrainValues {
 public:
  /// @param table  the parameters there are; its names must outlive this object
  /// @param list   `key=value,...`; null when the text had none
  /// @param source the terrain as it was asked for, for messages
  /// @throws ConfigError for an unknown or repeated key, a value that is no number or lies outside its range
  TerrainValues(std::span<const TerrainParameter> table, const std::optional<std::string_view>& list,
                std::string source);

  /// Returns the value, given or default. `name` must be in the table.
  double operator[](std::string_view name) const { return values_.at(name); }
  bool given(std::string_view name) const { return given_.contains(name); }
  const std::string& source() const { return source_; }

 private:
  void read(std::span<const TerrainParameter> table, std::string_view item);

  std::string source_;
  std::map<std::string_view, double> values_;
  std::set<std::string_view> given_;
};

/// Makes a field or, for `flat`, nothing. @throws ConfigError
std::shared_ptr<const HeightField> generate_terrain(std::string_view name,
                                                    const std::optional<std::string_view>& list,
                                                    const std::string& source, std::uint64_t seed);

/// Reads FILE.png or FILE.csv with the keys that `make_terrain` describes. @throws ConfigError
/// @returns the terrain, called `name`, with its scale in words
Terrain read_png(const std::string& path, const std::optional<std::string_view>& list,
                 const std::string& name);
Terrain read_csv(const std::string& path, const std::optional<std::string_view>& list,
                 const std::string& name);

}  // namespace crossgait
