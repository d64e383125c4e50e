// What Python hands over where the core takes a text: one way for every function that takes it.
#pragma once

#include <cstdint>
#include <string>

#include <nanobind/nanobind.h>

#include "physics/terrain/terrain.h"
#include "python/bindings/robot.h"

namespace crossgait::python {

/// Returns the text of a terrain: of a name or a file itself; of a `Terrain`, "flat" or the file of its
/// heights (`terrain_file`). For results and environments, which are UTF-8. @throws ConfigError naming
/// `source` for anything else
std::string terrain_text(nanobind::handle value, const std::string& source);

/// Returns the name or file of a robot, or of a `Robot`. @throws ConfigError likewise
std::string robot_text(nanobind::handle value, const std::string& source);

/// Returns a str as UTF-8. @throws ConfigError naming `source` and `element` for one that has no such bytes
std::string text_of(nanobind::handle text, const std::string& source, const std::string& element);

/// Returns a name from a file as Python shows a str: in quotes, in one line, without what a terminal would
/// do.
std::string quoted(const std::string& name);

/// Refuses what makes controllers or policies and takes arguments itself. @throws ConfigError naming `kind`
void check_maker(nanobind::handle make, const char* kind, const char* argument);

/// Returns the name of a value's type, for errors about it.
std::string type_called(nanobind::handle value);

/// Takes anything, so that what is no robot is refused in words of its own; what it says in signatures.
class RobotLike : public nanobind::object {
  NB_OBJECT_DEFAULT(RobotLike, nanobind::object, "Robot | str | os.PathLike[str]",
                    [](const PyObject*) { return true; })
};
/// Returns a robot, or the one of a name or a file. @throws ConfigError likewise, and for one that cannot be
/// read
Robot robot_of(nanobind::handle value, const std::string& source);

/// Takes anything, so that what is no terrain is refused in words of its own; what it says in signatures.
class TerrainLike : public nanobind::object {
  NB_OBJECT_DEFAULT(TerrainLike, nanobind::object, "Terrain | str | os.PathLike[str]",
                    [](const PyObject*) { return true; })
};
/// Returns a terrain, or the one of a name or a file; `seed` is of a random one. @throws ConfigError naming
/// `source` for anything else, and for one that cannot be read
Terrain terrain_of(nanobind::handle value, const std::string& source, std::uint64_t seed = 0);

/// Takes anything: settings of contact as text, "impratio=100", or as a mapping of them; what it says in
/// signatures.
class ContactLike : public nanobind::object {
  NB_OBJECT_DEFAULT(ContactLike, nanobind::object, "str | collections.abc.Mapping[str, typing.Any]",
                    [](const PyObject*) { return true; })
};
/// Returns settings of contact as text. @throws ConfigError naming `source` for anything else
std::string contact_text_of(nanobind::handle value, const std::string& source);

/// Takes anything: an engine's name, or one of `crossgait.engines()`; what it says in signatures.
class EngineLike : public nanobind::object {
  NB_OBJECT_DEFAULT(EngineLike, nanobind::object, "str | Engine", [](const PyObject*) { return true; })
};
/// Returns the name of an engine. @throws ConfigError naming `source` for anything else
std::string engine_name_of(nanobind::handle value, const std::string& source);

/// Returns text that `make_terrain` gives back the same field of, to the last bit: a CSV file in the user's
/// cache (`XDG_CACHE_HOME`, or ~/.cache), named by its contents, which is written unless it is there.
/// @throws ConfigError if it cannot be written
std::string terrain_file(const Terrain& terrain);

}  // namespace crossgait::python
