// What an engine's plug-in (libcrossgait_engine_<name>.so) exports, and what a program checks before it uses
// one. See docs/engine-plugins.md.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "physics/engine/engine.h"
#include "physics/robot_files/mjcf/mjcf_model.h"

namespace crossgait {

/// Grows with every change that the stamp below does not see and that makes a plug-in and a program built
/// before and after it misunderstand each other: the virtual functions of PhysicsBackend (their number, order
/// and signatures), the order or meaning of the members of a type that crosses the interface, what a function
/// of EnginePlugin promises, units and frames. Changes of sizes and of the build are the stamp's.
constexpr int kPluginInterfaceVersion = 6;

namespace plugin_detail {

/// Holds text put together by the compiler, so that it says how this file was compiled, whatever is linked.
struct Text {
  std::array<char, 2048> bytes{};  // ends in zeros
  std::size_t size = 0;

  constexpr void add(std::string_view text) {
    for (const char c : text) bytes[size++] = c;
  }
  constexpr void add(std::size_t number) {
    if (number >= 10) add(number / 10);
    bytes[size++] = static_cast<char>('0' + number % 10);
  }
  constexpr void add_item(std::string_view name, std::size_t value) {
    add(name);
    add(" ");
    add(value);
    add("; ");
  }
  template <typename T>
  constexpr void add_type(std::string_view name) {
    add("sizeof ");
    add_item(name, sizeof(T));
    add("alignof ");
    add_item(name, alignof(T));
  }
};

/// Names everything that the binary interface hangs on and that a compiler knows.
consteval Text make_stamp() {
  Text text;
#if defined(__clang__)
  text.add_item("clang", __clang_major__);
#else
  text.add_item("g++", __GNUC__);
#endif
  text.add_item("C++ ABI", __GXX_ABI_VERSION);
#if defined(_LIBCPP_VERSION)
  text.add_item("libc++", _LIBCPP_VERSION);
#else
  text.add_item("libstdc++", _GLIBCXX_RELEASE);
  text.add_item("_GLIBCXX_USE_CXX11_ABI", _GLIBCXX_USE_CXX11_ABI);
#endif
  text.add_item("Eigen", EIGEN_WORLD_VERSION * 10000 + EIGEN_MAJOR_VERSION * 100 + EIGEN_MINOR_VERSION);
  text.add_item("EIGEN_MAX_ALIGN_BYTES", EIGEN_MAX_ALIGN_BYTES);
  text.add_item("EIGEN_MAX_STATIC_ALIGN_BYTES", EIGEN_MAX_STATIC_ALIGN_BYTES);
  // How memory that one side takes is given back by the other. Under the address sanitizer it is another way.
  text.add_item("EIGEN_MALLOC_ALREADY_ALIGNED", EIGEN_MALLOC_ALREADY_ALIGNED);
  text.add_type<std::string>("std::string");
  text.add_type<std::vector<int>>("std::vector");
  text.add_type<std::shared_ptr<int>>("std::shared_ptr");
  text.add_type<JointVector>("JointVector");
  text.add_type<Pose>("Pose");
  text.add_type<EngineInfo>("EngineInfo");
  text.add_type<Engine>("Engine");
  text.add_type<ModelFactor>("ModelFactor");
  text.add_type<EngineFamily>("EngineFamily");
  text.add_type<CollisionShape>("CollisionShape");
  text.add_type<VisualShape>("VisualShape");
  text.add_type<Joint>("Joint");
  text.add_type<Body>("Body");
  text.add_type<LoopClosure>("LoopClosure");
  text.add_type<JointCoupling>("JointCoupling");
  text.add_type<LegModel>("LegModel");
  text.add_type<RobotDescription>("RobotDescription");
  text.add_type<HeightField>("HeightField");
  text.add_type<Terrain>("Terrain");
  text.add_type<WorldSpec>("WorldSpec");
  text.add_type<RobotState>("RobotState");
  text.add_type<Contact>("Contact");
  text.add_type<ContactList>("ContactList");
  text.add_type<Snapshot>("Snapshot");
  text.add_type<PhysicsBackend>("PhysicsBackend");
  text.add_type<MjcfText>("MjcfText");
  text.add_type<MjcfBody>("MjcfBody");
  text.add_type<MjcfJoint>("MjcfJoint");
  text.add_type<MjcfGeom>("MjcfGeom");
  text.add_type<MjcfConnect>("MjcfConnect");
  text.add_type<MjcfModel>("MjcfModel");
  return text;
}

/// Stamp, of internal linkage on purpose: a plug-in's must never be taken for the program's.
constexpr Text kStamp = make_stamp();

}  // namespace plugin_detail

/// Describes one name that a plug-in offers.
struct OfferedEngine {
  EngineInfo info;
  std::string summary;  ///< one line for lists
};

/// Holds what a plug-in says of itself. It lives as long as the process, and so does the plug-in: engines,
/// worlds and exceptions made of its code may be anywhere.
struct EnginePlugin {
  // These two stay first, as they are: any program can read them and say why it takes nothing else.
  int interface_version = kPluginInterfaceVersion;
  const char* stamp = plugin_detail::kStamp.bytes.data();

  /// Place in lists: small numbers first, in the order found where they are equal. The first engine is what
  /// commands use by default.
  int rank = 100;
  /// Says the version of the engine's headers that the plug-in was compiled with, below of the library that
  /// it found. A plug-in in which they differ is refused: the structures that they share may differ.
  std::string (*header_version)() = nullptr;
  std::string (*library_version)() = nullptr;
  /// Names to list. At least one.
  std::vector<OfferedEngine> (*engines)() = nullptr;
  std::vector<EngineFamily> (*families)() = nullptr;
  /// The engine of a name: a listed one, or one of a family. Nothing if the name is not this plug-in's. May
  /// be called from several threads at once. Throws ConfigError if the name is this plug-in's but its factors
  /// are invalid.
  std::optional<Engine> (*find)(std::string_view name) = nullptr;
  /// Reads robots' files of MuJoCo's format. Optional: of the plug-ins that have it that of the newest
  /// library is asked. May be called from several threads at once. Throws std::runtime_error with the
  /// engine's words.
  MjcfCompiler compile_mjcf = nullptr;
};

/// The name of the function below, to look it up by.
constexpr const char* kPluginFunction = "crossgait_engine_plugin";

}  // namespace crossgait

/// Returns the plug-in; defined by every plug-in, and the only symbol that it exports. Never null.
extern "C" __attribute__((visibility("default"))) const crossgait::EnginePlugin* crossgait_engine_plugin();
