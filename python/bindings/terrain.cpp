#include "physics/terrain/terrain.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nanobind/eigen/dense.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>

#include "physics/core/error.h"
#include "python/bindings/arrays.h"
#include "python/bindings/bindings.h"
#include "python/bindings/inputs.h"

namespace crossgait::python {
namespace {

Terrain of_heights(const nb::object& given, std::optional<double> size_x, std::optional<double> size_y,
                   const std::string& name) {
  const auto heights = numbers_of(given);
  if (heights.ndim() != 2)
    throw ConfigError(name, "heights", "rows along y of samples along x, two dimensions",
                      fmt::format("{}", heights.ndim()));
  if (!size_x || !size_y)
    throw ConfigError(name, "size_x, size_y", "both, the ground's extent along x and y, m", "one or none");
  const std::size_t rows = heights.shape(0), columns = heights.shape(1);
  if (rows * columns > static_cast<std::size_t>(kMaxHeightSamples))
    throw ConfigError(name, "heights", "at most 4096 x 4096 samples",
                      std::to_string(rows) + " x " + std::to_string(columns));
  return {name, std::make_shared<const HeightField>(
                    static_cast<int>(columns), static_cast<int>(rows), *size_x, *size_y,
                    std::vector<float>(heights.data(), heights.data() + rows * columns), name)};
}

void make(Terrain* self, const TerrainLike& text, std::uint64_t seed) {
  new (self) Terrain(terrain_of(text, "terrain", seed));
}

// A view: the owner is the Terrain's Python object, whose field nothing changes.
nb::object heights_of(nb::handle self) {
  const auto& terrain = nb::cast<const Terrain&>(self);
  const HeightField* field = terrain.field();
  if (field == nullptr) return nb::none();
  using View = nb::ndarray<nb::numpy, const float, nb::ndim<2>>;
  return nb::cast(
      View(field->heights().data(),
           {static_cast<std::size_t>(field->rows()), static_cast<std::size_t>(field->columns())}, self),
      nb::rv_policy::reference);
}

Eigen::VectorXd height_at(const Terrain& terrain, const nb::object& at_x, const nb::object& at_y) {
  const auto x = numbers_of(at_x), y = numbers_of(at_y);
  if (x.size() != y.size())
    throw ConfigError("height", "x, y", "as many of one as of the other",
                      std::to_string(x.size()) + " and " + std::to_string(y.size()));
  Eigen::VectorXd z(static_cast<Eigen::Index>(x.size()));
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!std::isfinite(x.data()[i]) || !std::isfinite(y.data()[i]))
      throw ConfigError("height", fmt::format("x, y, point {}", i), "finite numbers, m",
                        fmt::format("{}, {}", x.data()[i], y.data()[i]));
    z[static_cast<Eigen::Index>(i)] = terrain.height(x.data()[i], y.data()[i]);
  }
  return z;
}

void save(const Terrain& terrain, const std::string& path) {
  if (terrain.field() == nullptr)
    throw ConfigError(path, "terrain", "one with heights", "the plane, which has none");
  if (path.ends_with(".csv")) return write_csv(*terrain.field(), path);
  if (path.ends_with(".png")) return write_png(*terrain.field(), path);
  throw ConfigError(path, "file", "a name that ends in .csv or .png", "another");
}

// Name, scale, and of a field: rows, columns, extent along x and y, the bytes of its heights.
using State = std::tuple<std::string, std::string, int, int, double, double, nb::bytes>;

State state_of(const Terrain& terrain) {
  const HeightField* field = terrain.field();
  if (field == nullptr) return {terrain.name(), terrain.scale(), 0, 0, 0.0, 0.0, nb::bytes("", 0)};
  const std::span heights(field->heights());
  return {terrain.name(),
          terrain.scale(),
          field->rows(),
          field->columns(),
          field->size_x(),
          field->size_y(),
          nb::bytes(reinterpret_cast<const char*>(heights.data()), heights.size_bytes())};
}

Terrain of_state(const State& state) {
  const auto& [name, scale, rows, columns, size_x, size_y, bytes] = state;
  if (rows == 0) return {name, nullptr, scale};
  std::vector<float> heights(bytes.size() / sizeof(float));
  std::memcpy(heights.data(), bytes.c_str(), heights.size() * sizeof(float));
  return {name, std::make_shared<const HeightField>(columns, rows, size_x, size_y, std::move(heights), name),
          scale};
}

// Whatever they are called.
bool is_same_ground(const Terrain& a, const Terrain& b) {
  const HeightField *x = a.field(), *y = b.field();
  if (x == nullptr || y == nullptr) return x == y;
  return x->columns() == y->columns() && x->rows() == y->rows() && x->size_x() == y->size_x() &&
         x->size_y() == y->size_y() && std::ranges::equal(x->heights(), y->heights());
}

std::size_t hash_of(const Terrain& terrain) {
  const HeightField* field = terrain.field();
  if (field == nullptr) return 0;
  std::size_t hash = std::hash<double>()(field->size_x()) ^ (std::hash<double>()(field->size_y()) << 1);
  for (const float height : field->heights()) hash = hash * 31 + std::hash<float>()(height);
  return hash;
}

}  // namespace

void bind_terrain(nb::module_& m) {
  nb::class_<Terrain>(m, "Terrain", "The ground: an infinite plane or a height field. Immutable.")
      .def(
          "__init__", &make, nb::arg("text") = "flat", nb::kw_only(), nb::arg("seed") = 0,
          "`NAME`, `NAME:key=value,...`, `FILE.png` or `FILE.csv`, as `crossgait terrain --list` shows them. "
          "Raises "
          "ConfigError.")
      .def_static(
          "from_heights", &of_heights, nb::arg("heights"), nb::kw_only(), nb::arg("size_x") = nb::none(),
          nb::arg("size_y") = nb::none(), nb::arg("name") = "heights",
          nb::sig("def from_heights(heights: numpy.typing.ArrayLike, *, size_x: float | None = None, size_y: "
                  "float | None = None, name: str = 'heights') -> Terrain"),
          "Makes a terrain of an array of heights in m, rows along y from the smallest, columns "
          "along x, centred on "
          "the world's "
          "origin; its extent is size_x by size_y m, which have to be said. Raises ConfigError.")
      .def_prop_ro("name", &Terrain::name, "The text that it was made from.")
      .def_prop_ro("scale", &Terrain::scale, "Says of a file what its samples were taken to measure.")
      .def_prop_ro(
          "size",
          [](const Terrain& t) {
            return t.field() == nullptr
                       ? nb::object(nb::none())
                       : nb::object(nb::make_tuple(t.field()->size_x(), t.field()->size_y()));
          },
          nb::sig("def size(self) -> tuple[float, float] | None"), "Extent along x and y, m; None: infinite.")
      .def_prop_ro(
          "heights", &heights_of, nb::sig("def heights(self) -> numpy.typing.NDArray[numpy.float32] | None"),
          "Samples in m, rows along y, columns along x, read-only and without a copy; None of the plane.")
      .def("height", &height_at, nb::arg("x"), nb::arg("y"),
           nb::sig("def height(self, x: numpy.typing.ArrayLike, y: numpy.typing.ArrayLike) -> "
                   "numpy.typing.NDArray[numpy.float64]"),
           "Heights in m over points of the world, m.")
      .def(
          "save", [](const Terrain& t, const std::filesystem::path& path) { save(t, path.string()); },
          nb::arg("path"),
          "Writes FILE.csv, which gives back the same heights with the same size_x and size_y, or FILE.png, "
          "to half a grey level and with its scale. The file appears whole or not at all. Raises ConfigError "
          "of the plane, which has no heights, and for another ending.")
      .def("__getstate__", &state_of)
      .def("__setstate__", [](Terrain& self, const State& state) { new (&self) Terrain(of_state(state)); })
      .def("__eq__", &is_same_ground, nb::is_operator(),
           nb::sig("def __eq__(self, other: object, /) -> bool"),
           "Whether the ground is the same, whatever it is called.")
      .def("__hash__", &hash_of)
      .def("__repr__", [](const Terrain& t) { return "<crossgait.Terrain " + quoted(t.name()) + ">"; });
}

}  // namespace crossgait::python
