// Engines by name, at run time. They are plug-ins: nothing here is linked to an engine.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "physics/engine/engine.h"
#include "physics/robot_files/mjcf/mjcf_model.h"

namespace crossgait {

struct EnginePlugin;

/// Describes one name a user can choose, or could.
struct EngineListing {
  std::string name;        ///< "mujoco", "bullet", "bullet:matched"
  std::string summary;     ///< one line; empty if no plug-in could say
  EngineInfo info;         ///< its name alone, if no plug-in could say more
  std::string file;        ///< the plug-in's; empty if there is none
  bool available = false;  ///< can be made
  std::string reason;      ///< why not, when not
};

/// Holds the engines of the plug-ins in some folders. The first plug-in that offers a name has it, in the
/// order of the folders and then of file names.
class EngineRegistry {
 public:
  /// Opens every plug-in of these folders. What cannot be used is listed with the reason.
  explicit EngineRegistry(const std::vector<std::string>& folders);

  /// Lists what is available by rank (EnginePlugin::rank), then the rest: refused plug-ins, names that an
  /// earlier plug-in has, and engines that come with Crossgait but were not built or not found.
  const std::vector<EngineListing>& listings() const noexcept { return listings_; }
  /// Names the available engines.
  std::vector<std::string> available() const;
  const std::vector<EngineFamily>& families() const noexcept { return families_; }
  /// @throws ConfigError for an unknown or unavailable name (listing the available ones)
  Engine find(std::string_view name) const;
  /// Compiles `text` by the plug-in with the newest library of those that can (EnginePlugin::compile_mjcf).
  /// @throws ConfigError naming `text.source` if none can, std::runtime_error with the engine's words
  MjcfModel compile_mjcf(const MjcfText& text) const;
  /// Tells whether a plug-in can compile MJCF.
  bool compiles_mjcf() const { return newest_mjcf_compiler() != nullptr; }

 private:
  const EnginePlugin* newest_mjcf_compiler() const;
  struct Offers;
  void add_plugin(const std::string& file, Offers& offers);
  void add_missing(const std::vector<std::string>& folders);

  std::vector<const EnginePlugin*> plugins_;
  std::vector<EngineListing> listings_;
  std::vector<EngineFamily> families_;
};

// The functions below share one registry of plugin_folders(), made when the first of them is called, by any
// thread, or when a program that is linked to one of them reads an MJCF (set_mjcf_compiler). They throw
// ConfigError as plugin_folders() does.

/// Lists every engine Crossgait knows, available or not, in a fixed order.
const std::vector<EngineListing>& known_engines();
/// Names the available engines. The first is what commands use by default.
std::vector<std::string> available_engines();

/// Lists the available families.
const std::vector<EngineFamily>& engine_families();

/// Finds the engine of a name: one of `available_engines()`; "bullet:native" is an alias of "bullet". A
/// family's `from` may be followed by factors "+NAME", its `to` by "-NAME": "bullet:matched+surface+coulomb",
/// "bullet-sweeps"; "python:FILE.py" is the one that a file serves (backends/served_engine.h).
/// @throws ConfigError for an unknown or unavailable name (listing the available ones)
Engine find_engine(std::string_view name);

/// Tells whether an available engine reads robots' files of MuJoCo's format
/// (physics/robot_files/mjcf/mjcf_reader.h).
bool compiles_mjcf();

/// Calls find_engine(name).make(spec).
std::unique_ptr<PhysicsBackend> make_world(std::string_view name, const WorldSpec& spec);

}  // namespace crossgait
