#include "crossgait/physics/engine.h"

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
