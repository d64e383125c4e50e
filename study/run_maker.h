// Many runs of one behaviour, whose robot and files are read once.
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <string>

#include <nlohmann/json.hpp>

#include "study/run_spec.h"

namespace crossgait {

/// Describes and makes runs as `to_json(RunSpec)` and `run` do. May be called from several threads.
class RunMaker {
 public:
  /// @throws ConfigError for a robot, ground or environment that cannot be read
  explicit RunMaker(LoadedBehaviour loaded);

  /// Returns `to_json` of one run in an available engine. @throws ConfigError
  nlohmann::json describe(const std::string& engine, const Variation& variation, std::size_t start) const;
  /// Tells if a variation keeps time steps whole (Behaviour::allows). @throws ConfigError as `make_behaviour`
  bool allows(const std::string& engine, const Variation& variation) const;
  /// Makes the run. @returns its `stored_run`  @throws ConfigError
  std::string make(const std::string& engine, const Variation& variation, std::size_t start) const;

 private:
  const Behaviour& behaviour() const;  ///< made when it is first asked for

  LoadedBehaviour loaded_;
  mutable std::mutex mutex_;
  mutable std::unique_ptr<const Behaviour> behaviour_;
};

}  // namespace crossgait
