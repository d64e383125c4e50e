// Names of the settings between two ends of an engine, one switch per factor.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/core/find_row.h"
#include "physics/engine/engine.h"

namespace crossgait::contact {

template <typename Factors>
struct FactorRow {
  ModelFactor factor;
  bool Factors::*member;
};

/// @tparam Factors  a struct of switches, all of them off at one end and on at the other
template <typename Factors>
struct FactorTable {
  std::string off, on;  ///< names of the ends, "bullet:matched" and "bullet"
  /// All switches, in the order in which `needs` are satisfied.
  std::vector<FactorRow<Factors>> rows;

  /// Returns `base` with changes `+NAME` (on) and `-NAME` (off), one after the other.
  /// @throws ConfigError for an unknown factor, a change that changes nothing, or a combination without
  /// meaning; messages name `engine`
  Factors changed(Factors base, std::string_view changes, std::string_view engine) const {
    while (!changes.empty()) {
      const std::string_view change = pop_modifier(changes);
      bool& factor = base.*find_factor(change.substr(1), engine).member;
      const bool adds = change.front() == '+';
      if (factor == adds)
        throw ConfigError("engine", engine, "changes that change something", std::string(change));
      factor = adds;
    }
    check_meaning(base, engine);
    return base;
  }

  /// Returns the shortest name: "bullet", "bullet:matched", "bullet:matched+surface", "bullet-sweeps".
  std::string name_of(const Factors& factors) const {
    std::string added, removed;
    std::size_t count = 0;
    for (const FactorRow<Factors>& row : rows) {
      (factors.*row.member ? added : removed) +=
          fmt::format("{}{}", factors.*row.member ? '+' : '-', row.factor.name);
      count += factors.*row.member ? 1 : 0;
    }
    return count <= rows.size() / 2 ? off + added : on + removed;
  }

 private:
  const FactorRow<Factors>& find_factor(std::string_view name, std::string_view engine) const {
    return find_row(rows, name, "engine", engine,
                    [](const FactorRow<Factors>& row) { return row.factor.name; });
  }

  void check_meaning(const Factors& factors, std::string_view engine) const {
    for (const FactorRow<Factors>& row : rows) {
      if (!(factors.*row.member)) continue;
      for (const std::string_view need : row.factor.needs) {
        if (!(factors.*find_factor(need, engine).member)) {
          throw ConfigError("engine", engine, fmt::format("{} along with {}", need, row.factor.name),
                            fmt::format("{} without {}", row.factor.name, need));
        }
      }
    }
  }
};

/// Lists engines between the two ends of a table. @param find  the engine of a name, of those that it knows
template <typename Factors>
EngineFamily family_of(const FactorTable<Factors>& table, std::optional<Engine> (*find)(std::string_view)) {
  EngineFamily family{table.off, table.on, {}, {}};
  for (const FactorRow<Factors>& row : table.rows) family.factors.push_back(row.factor);
  family.with = [off = table.off, find](const std::vector<std::string>& names) {
    std::string name = off;
    for (const std::string& factor : names) name += "+" + factor;
    return *find(name);
  };
  return family;
}

}  // namespace crossgait::contact
