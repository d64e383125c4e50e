#include "physics/terrain/terrain.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <fmt/format.h>

#include "physics/core/text.h"
#include "physics/terrain/terrain_parameters.h"

namespace crossgait {
namespace {

bool has_suffix(std::string_view text, std::string_view suffix) {
  return text.size() >= suffix.size() &&
         equals_ignoring_case(text.substr(text.size() - suffix.size()), suffix);
}

bool is_file(std::string_view name) { return has_suffix(name, ".png") || has_suffix(name, ".csv"); }

struct NameAndList {
  std::string_view name;
  std::optional<std::string_view> list;
};

NameAndList split(std::string_view text) {
  const std::size_t colon = text.rfind(':');
  // A file's own name may contain colons.
  if (colon == std::string_view::npos || is_file(text)) return {text, std::nullopt};
  return {text.substr(0, colon), text.substr(colon + 1)};
}

}  // namespace

bool Terrain::touch_sphere(const Vector3& centre, double radius, SphereContact& contact) const noexcept {
  if (field_) return field_->touch_sphere(centre, radius, contact);
  if (!(centre.z() < radius) || !centre.allFinite()) return false;
  contact.distance = centre.z() - radius;
  contact.normal = Vector3::UnitZ();
  contact.position = Vector3(centre.x(), centre.y(), contact.distance / 2);
  return true;
}

std::array<double, kRingSize> sample_ring(const Terrain& terrain, double x, double y, double yaw,
                                          double radius) noexcept {
  std::array<double, kRingSize> heights{};
  for (int k = 0; k < kRingSize; ++k) {
    const double angle = yaw - 2 * std::numbers::pi * k / kRingSize;
    heights[static_cast<std::size_t>(k)] =
        terrain.height(x + radius * std::cos(angle), y + radius * std::sin(angle));
  }
  return heights;
}

bool is_terrain_file(std::string_view text) { return is_file(split(text).name); }

Terrain make_terrain(std::string_view text, std::uint64_t seed) {
  const auto [name, list] = split(text);
  if (is_file(name)) {
    const auto read = has_suffix(name, ".png") ? read_png : read_csv;
    return read(std::string(name), list, std::string(text));
  }
  return {std::string(text), generate_terrain(name, list, fmt::format("terrain {}", quoted(text)), seed)};
}

}  // namespace crossgait
