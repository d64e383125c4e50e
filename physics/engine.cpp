#include "crossgait/physics/engine.h"

#include <algorithm>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "crossgait/physics/error.h"

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
}

}  // namespace crossgait
