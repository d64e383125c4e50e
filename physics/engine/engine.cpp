#include "physics/engine/engine.h"

#include <algorithm>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "physics/core/error.h"

namespace crossgait {

Engine with_change(Engine engine, std::function<void(WorldSpec&)> change) {
  engine.make = [make = std::move(engine.make), change = std::move(change)](const WorldSpec& asked) {
    WorldSpec spec = asked;
    change(spec);
    return make(spec);
  };
  return engine;
}

std::pair<std::string_view, std::string_view> split_factors(std::string_view name) {
  const std::size_t end = std::min(name.find_first_of("+-"), name.size());
  return {name.substr(0, end), name.substr(end)};
}

std::string_view pop_modifier(std::string_view& changes) {
  const std::string_view first = changes.substr(0, changes.find_first_of("+-", 1));
  changes.remove_prefix(first.size());
  return first;
}

void EngineFamily::validate() const {
  constexpr std::size_t kMost = 10;
  if (factors.empty() || factors.size() > kMost) {
    throw ConfigError("attribution", "factors", fmt::format("1 to {}", kMost),
                      fmt::format("{}", factors.size()));
  }
  std::set<std::string> known;
  for (const ModelFactor& factor : factors) {
    for (const std::string& need : factor.needs) {
      if (!known.contains(need))
        throw ConfigError("attribution", factor.name, "needs that come before it", need);
    }
    known.insert(factor.name);
  }
  // Groups stand together, so that an order can put one in whole.
  std::set<std::string> ended;
  for (std::size_t i = 1; i < factors.size(); ++i) {
    const std::string &before = factors[i - 1].group, &own = factors[i].group;
    if (before != own) ended.insert(before);
    if (!own.empty() && ended.contains(own))
      throw ConfigError("attribution", factors[i].name, "factors of a group side by side", own);
  }
}

EngineFamily family_for(EngineFamily family, const RobotDescription& robot) {
  EngineFamily concerned{family.from, family.to, {}, {}};
  for (const ModelFactor& factor : family.factors) {
    if (factor.applies_to == nullptr || factor.applies_to(robot)) concerned.factors.push_back(factor);
  }
  concerned.with = [whole = std::move(family.factors),
                    with = std::move(family.with)](const std::vector<std::string>& names) {
    std::set<std::string> wanted(names.begin(), names.end());
    for (auto factor = whole.rbegin(); factor != whole.rend(); ++factor) {
      if (wanted.contains(factor->name)) wanted.insert(factor->needs.begin(), factor->needs.end());
    }
    std::vector<std::string> in_order;
    for (const ModelFactor& factor : whole) {
      if (wanted.contains(factor.name)) in_order.push_back(factor.name);
    }
    return with(in_order);
  };
  for (ModelFactor& factor : concerned.factors) {
    std::erase_if(factor.needs, [&](const std::string& need) {
      return std::none_of(concerned.factors.begin(), concerned.factors.end(),
                          [&need](const ModelFactor& f) { return f.name == need; });
    });
  }
  return concerned;
}

}  // namespace crossgait
