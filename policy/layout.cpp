#include "policy/layout.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "physics/core/hash.h"

namespace crossgait {
namespace {

/// What versions 1, 2, ... say that a layout's numbers mean.
constexpr std::array<std::string_view, kLayoutVersion> kVersions{
    "leg frames with z down", "the guide's ranges of parameters", "ranges of gaits that step"};

/// A share of a bound.
constexpr double kBoundRounding = 1e-9;

// With an end, so that "ab" "c" and "a" "bc" differ.
void add(Fnv1a& hash, std::string_view text) { hash.add(text).add(std::string_view("\0", 1)); }

void add(Fnv1a& hash, const Layout& layout) {
  add(hash, std::to_string(layout.size()));
  for (const LayoutEntry& entry : layout.entries) {
    add(hash, entry.name);
    add(hash, entry.unit);
  }
}

}  // namespace

double LayoutEntry::low() const { return std::isfinite(min) ? min - kBoundRounding * std::abs(min) : -reach; }

double LayoutEntry::high() const { return std::isfinite(max) ? max + kBoundRounding * std::abs(max) : reach; }

std::string layout_version_in_words() {
  return fmt::format("{} ({})", kLayoutVersion, kVersions[kLayoutVersion - 1]);
}

std::optional<std::string> layout_version_error(const std::optional<std::string>& stated,
                                                std::string_view made) {
  if (!stated) return fmt::format("none, which means 1: {} for {}", made, kVersions[0]);
  for (std::size_t i = 0; i < kVersions.size(); ++i) {
    if (*stated != std::to_string(i + 1)) continue;
    if (i + 1 == kLayoutVersion) return std::nullopt;
    return fmt::format("{}: {} for {}", *stated, made, kVersions[i]);
  }
  return fmt::format("'{}', which is not known here", *stated);
}

std::optional<std::size_t> Layout::find(std::string_view name) const {
  const auto it = std::find_if(entries.begin(), entries.end(),
                               [name](const LayoutEntry& entry) { return entry.name == name; });
  if (it == entries.end()) return std::nullopt;
  return static_cast<std::size_t>(it - entries.begin());
}

std::vector<std::string> Layout::names() const {
  std::vector<std::string> names;
  names.reserve(size());
  for (const LayoutEntry& entry : entries) names.push_back(entry.name);
  return names;
}

std::string layout_hash(const Layout& observation, const Layout& action) {
  Fnv1a hash;
  add(hash, std::to_string(kLayoutVersion));
  add(hash, observation);
  add(hash, action);
  return hash.hex();
}

std::string layout_difference(const std::vector<std::string>& expected,
                              const std::vector<std::string>& found) {
  if (expected == found) return {};
  std::string words;
  if (expected.size() != found.size()) {
    words = fmt::format("has {} entries where {} were expected; ", found.size(), expected.size());
  }
  const auto [e, f] = std::mismatch(expected.begin(), expected.end(), found.begin(), found.end());
  const auto name = [](auto it, const auto& list) { return it == list.end() ? std::string("none") : *it; };
  return words +
         fmt::format("entry {} is {}, expected {}", e - expected.begin(), name(f, found), name(e, expected));
}

}  // namespace crossgait
