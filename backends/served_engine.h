// Engines in processes of their own: a Python file serves one, and worlds are made in it by name.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "physics/core/served_process.h"
#include "physics/engine/engine.h"

namespace crossgait {

/// What the name of an engine that a file serves begins with.
inline constexpr std::string_view kServedPrefix = "python:";

/// Finds the engine that a file serves: "python:my_engine.py"; running it takes consent (consent.h).
/// "python:drake" is the one of that name in Crossgait's Python package. Nothing for names that do not begin
/// so. A file as it is now is started once, and asked what it is; every world has a process, which a later
/// world takes over.
/// @throws ConfigError naming the file: no such file, no consent, or what the program did instead of serving
std::optional<Engine> find_served_engine(std::string_view name);

/// Holds a program that serves an engine, as a file was when it was first asked for, and processes that no
/// world needs at the moment.
class ServedEngine : public std::enable_shared_from_this<ServedEngine> {
 public:
  /// @param name  of the engine  @param file  or the module of the package  @param text  of the file, which
  /// tells it from others of its name
  /// @throws ConfigError
  ServedEngine(std::string name, std::string file, std::string_view text);

  const EngineInfo& info() const noexcept { return info_; }
  const std::string& file() const noexcept { return file_; }
  /// Tells whether it is to be asked (rather than the description) for an answer: "mass_matrix", "contacts".
  bool answers(std::string_view what) const;
  /// Tells whether it takes equations of every step, of points up to `margin` above the ground (m).
  bool takes_equations() const noexcept { return equations_; }
  double margin() const noexcept { return margin_; }

  /// Takes a process that is idle, or starts one. May be called from several threads at once.
  std::unique_ptr<ServedProcess> take();
  void give_back(std::unique_ptr<ServedProcess> process);
  std::unique_ptr<PhysicsBackend> make_world(const WorldSpec& spec);

 private:
  /// Starts a process, whose text then says what the engine is.
  std::unique_ptr<ServedProcess> start() const;
  void read_info(std::string_view text, std::string_view stamp);

  std::string file_;
  EngineInfo info_;
  std::vector<std::string> answers_;
  bool equations_ = false;
  double margin_ = 0;
  std::mutex mutex_;
  std::vector<std::unique_ptr<ServedProcess>> idle_;
};

/// Writes what a served engine is told of a world, but for the heights of its ground.
std::string served_world_text(const WorldSpec& spec);

}  // namespace crossgait
