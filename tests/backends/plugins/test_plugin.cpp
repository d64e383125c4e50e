// A plug-in that can be made to say something wrong: the environment variable CROSSGAIT_TEST_FAULT says what,
// when it is opened.
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "statue.h"

#include "crossgait/physics/core/error.h"
#include "crossgait/physics/engine/engine_plugin.h"
#include "crossgait/physics/robot_files/mjcf/mjcf_model.h"

extern "C" {
int test_library_version();  // NOLINT(misc-use-internal-linkage): the library's
extern int test_library_state;
}

namespace {

using namespace crossgait;

std::string fault() {
  const char* fault = std::getenv("CROSSGAIT_TEST_FAULT");
  return fault != nullptr ? fault : "";
}

std::string version() { return std::to_string(test_library_version()); }

/// Ends in what the library behind it says: "stone@1".
std::string name() { return "stone@" + version(); }

Engine make_engine() {
  Engine engine = statue::engine(name(), version());
  // A global variable of the library counts worlds: each version has its own.
  engine.make = [make = engine.make](const WorldSpec& spec) {
    ++test_library_state;
    return make(spec);
  };
  engine.info.mode = std::to_string(test_library_state) + " made";
  return engine;
}

std::vector<OfferedEngine> engines() {
  return {{make_engine().info, "Stone"}, {statue::engine("stone", version()).info, "Stone of any version"}};
}

std::optional<Engine> find(std::string_view wanted) {
  const auto [base, factors] = split_factors(wanted);
  if (base != name() && base != "stone") return std::nullopt;
  if (!factors.empty()) throw ConfigError("engine", wanted, "no factors", factors);
  return base == "stone" ? statue::engine("stone", version()) : make_engine();
}

MjcfModel compile(const MjcfText& text) {
  MjcfModel model;
  model.name = text.xml + " by " + name();
  return model;
}

// This program's own stamp with one figure changed.
const char* wrong_stamp() {
  static const std::string kStamp = [] {
    std::string stamp = plugin_detail::kStamp.bytes.data();
    const std::string item = "sizeof WorldSpec ";
    stamp.insert(stamp.find(item) + item.size(), 1, '9');
    return stamp;
  }();
  return kStamp.c_str();
}

EnginePlugin the_plugin() {
  EnginePlugin plugin{.header_version = version,
                      .library_version = version,
                      .engines = engines,
                      .families = [] { return std::vector<EngineFamily>(); },
                      .find = find,
                      .compile_mjcf = compile};
  if (fault() == "interface") plugin.interface_version = kPluginInterfaceVersion + 1;
  if (fault() == "stamp") plugin.stamp = wrong_stamp();
  if (fault() == "other compiler") plugin.stamp = "cc 1; ";
  if (fault() == "headers") plugin.header_version = [] { return std::string("2.3.7"); };
  if (fault() == "function") plugin.find = nullptr;
  if (fault() == "nothing offered") plugin.engines = [] { return std::vector<OfferedEngine>(); };
  return plugin;
}

}  // namespace

const EnginePlugin* crossgait_engine_plugin() {
  if (fault() == "null") return nullptr;
  if (fault() == "throw") throw std::runtime_error("no licence");
  if (fault() == "throw a number") throw 3;
  static const EnginePlugin kPlugin = the_plugin();
  return &kPlugin;
}
