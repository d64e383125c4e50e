#include "backends/dart/dart_backend.h"

#include <dart/config.hpp>

#include "backends/contact/tree_backend.h"
#include "backends/dart/law.h"
#include "backends/dart/skeleton_model.h"

namespace crossgait::dart {
namespace {

EngineInfo make_info(const DartFactors& factors) {
  EngineInfo info;
  info.library = "DART";
  info.version = DART_VERSION;
  info.name = name_of(factors);
  info.capabilities.allocates = true;
  contact::describe_law(factors, info.library, info);
  return info;
}

Engine engine_of(const DartFactors& factors) {
  const EngineInfo info = make_info(factors);
  return {info, [info, factors](const WorldSpec& spec) {
            return std::make_unique<contact::TreeBackend>(spec, info, factors, [](const WorldSpec& own) {
              return std::make_unique<SkeletonModel>(own);
            });
          }};
}

}  // namespace

std::optional<Engine> find(std::string_view name) {
  const std::optional<DartFactors> factors = find_factors(name);
  if (!factors) return std::nullopt;
  return engine_of(*factors);
}

EngineFamily family() { return contact::family_of(factor_table(), find); }

}  // namespace crossgait::dart
