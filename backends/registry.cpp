#include "backends/registry.h"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <optional>
#include <sstream>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "backends/bundled_engines.h"
#include "backends/plugin_loader.h"
#include "backends/served_engine.h"
#include "physics/core/error.h"
#include "physics/core/find_row.h"
#include "physics/core/undivided.h"

namespace crossgait {
namespace {

EngineListing unavailable(const std::string& name, const std::string& file, const std::string& reason) {
  EngineListing listing{name, "", {}, file, false, reason};
  listing.info.name = name;
  return listing;
}

// What a plug-in would have offered, as far as its file's name tells.
BundledEngine engine_of(const std::string& plugin) {
  for (const BundledEngine& engine : bundled_engines()) {
    if (engine.name == plugin) return engine;
  }
  return {plugin, {plugin}, "", ""};
}

const EngineRegistry& shared_registry() {
  // Made once, and not by a static's own means: of those a fork meanwhile would wait for ever.
  const Undivided alone;
  static const EngineRegistry* registry = nullptr;
  if (registry == nullptr) registry = new EngineRegistry(plugin_folders());
  return *registry;
}

}  // namespace

// Robots' files are read below the registry: this is how they come by an engine.
[[maybe_unused]] const MjcfCompiler kNoneBefore =
    set_mjcf_compiler([](const MjcfText& text) { return shared_registry().compile_mjcf(text); });

// "3.10.1" as {3, 10, 1}, which compare as versions do.
std::vector<int> numbers_of(const std::string& version) {
  std::vector<int> numbers;
  std::istringstream parts(version);
  for (std::string part; std::getline(parts, part, '.');) numbers.push_back(std::atoi(part.c_str()));
  return numbers;
}

// What is needed until the lists are in order.
struct EngineRegistry::Offers {
  std::map<std::string, std::string> file_of;  // by name of an engine
  std::map<std::string, int> rank_of;
};

EngineRegistry::EngineRegistry(const std::vector<std::string>& folders) {
  Offers offers;
  for (const std::string& file : plugin_files(folders)) add_plugin(file, offers);
  const auto place = [&](const EngineListing& listing) {
    return std::pair(!listing.available, listing.available ? offers.rank_of.at(listing.name) : 0);
  };
  std::stable_sort(listings_.begin(), listings_.end(),
                   [&](const EngineListing& a, const EngineListing& b) { return place(a) < place(b); });
  add_missing(folders);
}

void EngineRegistry::add_plugin(const std::string& file, Offers& offers) {
  const LoadedPlugin loaded = load_plugin(file);
  if (loaded.plugin == nullptr) {
    const BundledEngine engine = engine_of(plugin_name(file));
    const std::string reason =
        engine.library.empty() ? loaded.reason : fmt::format("{} ({})", loaded.reason, engine.library);
    for (const std::string& name : engine.names) listings_.push_back(unavailable(name, loaded.file, reason));
    return;
  }
  plugins_.push_back(loaded.plugin);
  for (OfferedEngine& offer : loaded.plugin->engines()) {
    const std::string name = offer.info.name;
    const auto [place, first] = offers.file_of.try_emplace(name, loaded.file);
    if (first) offers.rank_of[name] = loaded.plugin->rank;
    listings_.push_back({name, std::move(offer.summary), std::move(offer.info), loaded.file, first,
                         first ? "" : "already offered by " + place->second});
  }
  for (EngineFamily& family : loaded.plugin->families()) {
    // An end may be an engine that is known by its name alone, and in no list.
    const auto is_own = [&](const std::string& name) {
      const auto place = offers.file_of.find(std::string(split_factors(name).first));
      return place == offers.file_of.end() ? loaded.plugin->find(name).has_value()
                                           : place->second == loaded.file;
    };
    if (is_own(family.from) && is_own(family.to)) families_.push_back(std::move(family));
  }
}

void EngineRegistry::add_missing(const std::vector<std::string>& folders) {
  for (const BundledEngine& engine : bundled_engines()) {
    const std::string reason = !engine.missing.empty()
                                   ? engine.missing
                                   : fmt::format("libcrossgait_engine_{}.so is in none of {}", engine.name,
                                                 fmt::join(folders, ", "));
    for (const std::string& name : engine.names) {
      const auto same = [&](const EngineListing& listing) { return listing.name == name; };
      if (std::none_of(listings_.begin(), listings_.end(), same)) {
        listings_.push_back(unavailable(name, "", reason));
      }
    }
  }
}

std::vector<std::string> EngineRegistry::available() const {
  std::vector<std::string> names;
  for (const EngineListing& entry : listings_) {
    if (entry.available) names.push_back(entry.name);
  }
  return names;
}

Engine EngineRegistry::find(std::string_view name) const {
  for (const EnginePlugin* plugin : plugins_) {
    if (std::optional<Engine> engine = plugin->find(name)) return *std::move(engine);
  }
  for (const EngineListing& entry : listings_) {
    if (!entry.available && entry.name == split_factors(name).first) {
      throw ConfigError("engine", name, fmt::format("one of {}", fmt::join(available(), ", ")), entry.reason);
    }
  }
  if (constexpr std::string_view kRelease = "mujoco@"; name.starts_with(kRelease)) {
    throw ConfigError(
        "engine", name, fmt::format("one of {}", fmt::join(available(), ", ")),
        fmt::format("a release that is not here (scripts/install-dependencies --mujoco {}, and a "
                    "build after it, bring it)",
                    split_factors(name).first.substr(kRelease.size())));
  }
  fail_unknown_name(name, available(), "engine", "name");
}

const EnginePlugin* EngineRegistry::newest_mjcf_compiler() const {
  const EnginePlugin* newest = nullptr;
  for (const EnginePlugin* plugin : plugins_) {
    if (plugin->compile_mjcf == nullptr) continue;
    const bool is_newer =
        newest == nullptr || numbers_of(newest->library_version()) < numbers_of(plugin->library_version());
    if (is_newer) newest = plugin;
  }
  return newest;
}

MjcfModel EngineRegistry::compile_mjcf(const MjcfText& text) const {
  if (const EnginePlugin* newest = newest_mjcf_compiler()) return newest->compile_mjcf(text);
  throw ConfigError(text.source, "file",
                    "an engine that reads MJCF: MuJoCo (`crossgait engines` says why it is missing)",
                    fmt::format("{}", fmt::join(available(), ", ")));
}

const std::vector<EngineListing>& known_engines() { return shared_registry().listings(); }

std::vector<std::string> available_engines() { return shared_registry().available(); }

const std::vector<EngineFamily>& engine_families() { return shared_registry().families(); }

Engine find_engine(std::string_view name) {
  if (std::optional<Engine> engine = find_served_engine(name)) return *std::move(engine);
  return shared_registry().find(name);
}

bool compiles_mjcf() { return shared_registry().compiles_mjcf(); }

std::unique_ptr<PhysicsBackend> make_world(std::string_view name, const WorldSpec& spec) {
  return find_engine(name).make(spec);
}

}  // namespace crossgait
