#include "python/bindings/inputs.h"

#include <cctype>
#include <cstdlib>
#include <optional>
#include <string_view>
#include <system_error>

#include <fmt/format.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "backends/registry.h"
#include "physics/core/error.h"
#include "physics/core/hash.h"
#include "physics/core/utf8.h"
#include "python/bindings/shown.h"

namespace crossgait::python {
namespace {

namespace fs = std::filesystem;
namespace nb = nanobind;

// A str or an os.PathLike.
std::optional<std::string> path_text(nb::handle value) {
  if (!nb::isinstance<nb::str>(value) && !nb::hasattr(value, "__fspath__")) return std::nullopt;
  // As the system has it: names of files need be no text.
  try {
    const nb::object bytes = nb::module_::import_("os").attr("fsencode")(value);
    return std::string(nb::borrow<nb::bytes>(bytes).c_str(), nb::len(bytes));
  } catch (nb::python_error& error) {
    if (!error.matches(PyExc_UnicodeError)) throw;
    throw ConfigError("input", "name", "a name that a file can have", shown(value));
  }
}

// What results say that they are of: they are JSON.
std::string in_utf8(const std::string& name, const std::string& source, const std::string& element) {
  if (utf8_length(name) < name.size()) throw ConfigError(source, element, "a name in UTF-8", name);
  return name;
}

fs::path cache_folder() {
  const auto variable = [](const char* name) -> std::string_view {
    const char* value = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): the interpreter's lock is held
    return value == nullptr ? std::string_view() : std::string_view(value);
  };
  if (const std::string_view cache = variable("XDG_CACHE_HOME"); !cache.empty()) return cache;
  if (const std::string_view home = variable("HOME"); !home.empty()) return fs::path(home) / ".cache";
  return fs::temp_directory_path();
}

// What may stand in a file's name whatever the system, of a terrain's own.
std::string plain(const std::string& name) {
  constexpr std::size_t kLongest = 40;
  std::string text;
  for (const char c : name.substr(0, kLongest)) text += std::isalnum(static_cast<unsigned char>(c)) ? c : '-';
  return text.empty() ? "terrain" : text;
}

const Robot& known_robot(nb::handle value, const std::string& source) {
  if (!nb::isinstance<Robot>(value))
    throw ConfigError(source, "robot", "a name, a file or a Robot", type_called(value));
  return nb::cast<const Robot&>(value);
}

const Terrain& known_terrain(nb::handle value, const std::string& source) {
  if (nb::isinstance<Terrain>(value)) return nb::cast<const Terrain&>(value);
  throw ConfigError(source, "terrain",
                    "a name, a file or a Terrain (an array becomes one by Terrain.from_heights)",
                    type_called(value));
}

}  // namespace

std::string quoted(const std::string& name) {
  const nb::object text =
      nb::steal(PyUnicode_DecodeUTF8(name.data(), static_cast<Py_ssize_t>(name.size()), "backslashreplace"));
  return nb::cast<std::string>(nb::repr(text));
}

std::string contact_text_of(nb::handle value, const std::string& source) {
  if (nb::isinstance<nb::str>(value)) return text_of(value, source, "contact");
  if (!nb::hasattr(value, "keys"))
    throw ConfigError(source, "contact", "settings as text, or a mapping of them", type_called(value));
  const nb::object text = nb::module_::import_("crossgait.studies.choices").attr("contact_text")(value);
  return text_of(text, source, "contact");
}

std::string engine_name_of(nb::handle value, const std::string& source) {
  if (nb::isinstance<nb::str>(value)) return text_of(value, source, "engine");
  if (nb::isinstance<EngineListing>(value)) return text_of(value.attr("name"), source, "engine");
  throw ConfigError(source, "engine", "a name, or one of crossgait.engines()", type_called(value));
}

std::string text_of(nb::handle text, const std::string& source, const std::string& element) {
  Py_ssize_t size = 0;
  const char* bytes = PyUnicode_AsUTF8AndSize(text.ptr(), &size);
  if (bytes != nullptr) return {bytes, static_cast<std::size_t>(size)};
  PyErr_Clear();
  throw ConfigError(source, element, "text that UTF-8 has bytes for", shown(text));
}

void check_maker(nb::handle make, const char* kind, const char* argument) {
  nb::module_::import_("crossgait.inputs").attr("check_maker")(make, kind, argument);
}

std::string type_called(nb::handle value) { return nb::cast<std::string>(value.type().attr("__name__")); }

std::string terrain_file(const Terrain& terrain) {
  const HeightField& field = *terrain.field();
  const std::string size = fmt::format("size_x={},size_y={}", field.size_x(), field.size_y());
  const auto* bytes = reinterpret_cast<const char*>(field.heights().data());
  const std::string hash = Fnv1a()
                               .add(fmt::format("{} {} {} ", field.rows(), field.columns(), size))
                               .add(std::string_view(bytes, field.heights().size() * sizeof(float)))
                               .hex();
  const fs::path folder = cache_folder() / "crossgait" / "terrains";
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw ConfigError(folder.string(), "folder", "one that can be written", error.message());
  const fs::path file = folder / fmt::format("{}-{}.csv", plain(terrain.name()), hash);
  if (!fs::exists(file, error)) write_csv(field, file.string());
  return fmt::format("{}:{}", file.string(), size);
}

std::string terrain_text(nb::handle value, const std::string& source) {
  if (const auto text = path_text(value)) return in_utf8(*text, source, "terrain");
  const Terrain& terrain = known_terrain(value, source);
  return terrain.field() == nullptr ? "flat" : terrain_file(terrain);
}

Terrain terrain_of(nb::handle value, const std::string& source, std::uint64_t seed) {
  const auto text = path_text(value);
  return text ? make_terrain(*text, seed) : known_terrain(value, source);
}

Robot robot_of(nb::handle value, const std::string& source) {
  const auto text = path_text(value);
  return text ? load(*text) : known_robot(value, source);
}

std::string robot_text(nb::handle value, const std::string& source) {
  const auto text = path_text(value);
  return in_utf8(text ? *text : known_robot(value, source).from, source, "robot");
}

}  // namespace crossgait::python
