#include "physics/terrain/terrain_source.h"

#include <mutex>
#include <optional>
#include <utility>

namespace crossgait {

struct TerrainSource::Shared {
  std::string text;
  std::mutex mutex;
  std::optional<Terrain> of_file;  // once it has been read
};

TerrainSource::TerrainSource(std::string text) : shared_(std::make_shared<Shared>()) {
  shared_->text = std::move(text);
}

const std::string& TerrainSource::text() const noexcept { return shared_->text; }

Terrain TerrainSource::make(std::uint64_t seed) const {
  Shared& s = *shared_;
  {
    const std::scoped_lock lock(s.mutex);
    if (!s.of_file && is_terrain_file(s.text)) s.of_file = make_terrain(s.text, seed);
    if (s.of_file) return *s.of_file;
  }
  return make_terrain(s.text, seed);
}

}  // namespace crossgait
