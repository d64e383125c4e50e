// Grounds as somebody asks for them: one text, a terrain for every seed.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "physics/terrain/terrain.h"

namespace crossgait {

/// Makes the terrains of one text. A file is read when its terrain is first made, and never again: what
/// becomes of it later changes nothing. Cheap to copy; copies share what was read. May be used from several
/// threads.
class TerrainSource {
 public:
  /// @param text  as `make_terrain` takes it
  explicit TerrainSource(std::string text);

  const std::string& text() const noexcept;
  /// Makes what `make_terrain` does; of a file, whatever the seed, what was first read. @throws ConfigError
  Terrain make(std::uint64_t seed) const;

 private:
  struct Shared;
  std::shared_ptr<Shared> shared_;
};

}  // namespace crossgait
