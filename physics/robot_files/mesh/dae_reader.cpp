#include "physics/robot_files/mesh/dae_reader.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <map>
#include <string_view>
#include <tuple>
#include <vector>

#include <fmt/format.h>
#include <tinyxml.h>

#include "physics/core/error.h"
#include "physics/core/read_budget.h"
#include "physics/core/text.h"
#include "physics/robot_files/mesh/mesh_corners.h"
#include "physics/robot_files/xml_text.h"

namespace crossgait {
namespace {

using Transform = Eigen::Affine3d;

constexpr std::size_t kMostInputs = 100;  // of a primitive

/// A list of numbers, taken one by one: those of a mesh are many.
class DaeNumbers {
 public:
  DaeNumbers(const TiXmlElement& element, const std::string& path) : element_(element), path_(path) {
    for (auto* node = element.FirstChild(); node != nullptr; node = node->NextSibling())
      if (node->ToText() != nullptr) text_ += node->ValueStr() + " ";
  }

  bool next(double& number) {
    const std::string_view word = next_word_of();
    if (word.empty()) return false;
    const auto value = parse_number(word);
    if (!value) fail("finite numbers", word);
    number = *value;
    return true;
  }
  bool next(std::size_t& index) {
    const std::string_view word = next_word_of();
    if (word.empty()) return false;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), index);
    if (error != std::errc() || end != word.data() + word.size()) fail("whole numbers from 0 on", word);
    return true;
  }
  std::size_t size() const { return text_.size(); }  ///< bytes
  /// Takes as many as there have to be.
  std::vector<double> all(std::size_t count) {
    std::vector<double> numbers;
    for (double number = 0; numbers.size() <= count && next(number);) numbers.push_back(number);
    if (numbers.size() != count) fail(fmt::format("{} numbers", count), fmt::format("{}", numbers.size()));
    return numbers;
  }

 private:
  std::string_view next_word_of() {
    constexpr std::string_view kBlanks = " \t\r\n";
    const std::string_view text = text_;
    const std::size_t first = std::min(text.find_first_not_of(kBlanks, at_), text.size());
    at_ = std::min(text.find_first_of(kBlanks, first), text.size());
    return text.substr(first, at_ - first);
  }
  [[noreturn]] void fail(std::string_view expected, std::string_view found) const {
    throw ConfigError(path_, fmt::format("line {}, {}", element_.Row(), element_.Value()), expected,
                      fmt::format("'{}'", found));
  }

  const TiXmlElement& element_;
  const std::string& path_;
  std::string text_;
  std::size_t at_ = 0;
};

class DaeReader {
 public:
  DaeReader(const TiXmlElement& root, const std::string& path, const std::string& part)
      : root_(root), path_(path), part_(part) {
    find_ids(root);
  }

  TriangleMesh read() {
    const Transform X = Transform(Eigen::Scaling(unit()));
    const TiXmlElement* scene = root_.FirstChildElement("scene");
    const TiXmlElement* shown =
        scene == nullptr ? nullptr : scene->FirstChildElement("instance_visual_scene");
    if (shown != nullptr) {
      add_nodes(named(*shown, "url"), X, 0);
    } else {
      for_each(root_, "library_geometries", [&](const TiXmlElement& library) {
        for_each(library, "geometry", [&](const TiXmlElement& geometry) { add_geometry(geometry, X); });
      });
    }
    if (mesh_.triangles.empty() && !part_.empty()) names_.fail_without(path_, part_);
    return std::move(mesh_);
  }

 private:
  template <typename Function>
  static void for_each(const TiXmlElement& parent, const char* tag, Function function) {
    for (auto* e = parent.FirstChildElement(tag); e != nullptr; e = e->NextSiblingElement(tag)) function(*e);
  }

  [[noreturn]] void fail(const TiXmlElement& at, std::string_view expected, std::string_view found) const {
    throw ConfigError(path_, fmt::format("line {}, {}", at.Row(), printable_text(at.ValueStr(), 100)),
                      expected, found);
  }

  void find_ids(const TiXmlElement& element) {
    if (const char* id = element.Attribute("id")) ids_.emplace(id, &element);
    if (element.ValueStr() == "node" && !part_.empty()) {
      part_is_node_ = part_is_node_ || is_part(element);
      for (const char* attribute : {"name", "id"}) names_.add(attribute_of(element, attribute));
    }
    for (auto* e = element.FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) find_ids(*e);
  }

  bool is_part(const TiXmlElement& element) const {
    return attribute_of(element, "name") == part_ || attribute_of(element, "id") == part_;
  }

  /// The element of the file that an attribute "#ID" names.
  const TiXmlElement& named(const TiXmlElement& by, const char* attribute) const {
    const std::string name = attribute_of(by, attribute);
    const auto found = ids_.find(name.substr(std::min<std::size_t>(1, name.size())));
    if (found == ids_.end() || !name.starts_with('#'))
      fail(by, fmt::format("{} of an element of this file", attribute),
           fmt::format("'{}'", printable_text(name, 200)));
    return *found->second;
  }

  double unit() const {
    const TiXmlElement* asset = root_.FirstChildElement("asset");
    const TiXmlElement* unit = asset == nullptr ? nullptr : asset->FirstChildElement("unit");
    if (unit == nullptr || unit->Attribute("meter") == nullptr) return 1;
    const auto meter = parse_number(attribute_of(*unit, "meter"));
    if (!meter || !(*meter > 0))
      fail(*unit, "metres, a number above 0",
           fmt::format("'{}'", printable_text(unit->Attribute("meter"), 200)));
    return *meter;
  }

  /// Counts what is looked at, as often as it is: nodes and geometries name each other.
  void look_at(const TiXmlElement& e) {
    if (++looked_at_ > kDaeBudget.values)
      fail(e, fmt::format("at most {} elements, each as often as it is shown", kDaeBudget.values), "more");
  }
  /// Takes the numbers in an element. Their text counts as often as it is read, as much as a file may have.
  DaeNumbers numbers_in(const TiXmlElement& e) {
    DaeNumbers numbers(e, path_);
    bytes_ += numbers.size();
    if (bytes_ > kMeshBudget.bytes)
      fail(e,
           fmt::format("at most {} of numbers, each as often as it is shown",
                       size_in_words(kMeshBudget.bytes)),
           "more");
    return numbers;
  }

  /// Adds what nodes inside an element show. They nest, and name each other, as deep as elements may.
  void add_nodes(const TiXmlElement& parent, const Transform& X_parent, int depth) {
    if (depth > kDaeBudget.depth)
      fail(parent, fmt::format("at most {} levels of nodes", kDaeBudget.depth), "more");
    for_each(parent, "node", [&](const TiXmlElement& node) { add_node(node, X_parent, depth); });
  }

  void add_node(const TiXmlElement& node, const Transform& X_parent, int depth) {
    const bool was_in_part = in_part_;
    in_part_ = in_part_ || (part_is_node_ && is_part(node));
    Transform X = X_parent;
    for (auto* e = node.FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
      look_at(*e);
      X = X * transform_of(*e);
    }
    for_each(node, "instance_geometry",
             [&](const TiXmlElement& instance) { add_geometry(named(instance, "url"), X); });
    if (const TiXmlElement* skin = node.FirstChildElement("instance_controller"))
      fail(*skin, "geometry that is no skin", "an instance of a controller");
    add_nodes(node, X, depth + 1);
    for_each(node, "instance_node", [&](const TiXmlElement& instance) {
      if (depth > kDaeBudget.depth)
        fail(instance, fmt::format("at most {} levels of nodes", kDaeBudget.depth), "more");
      add_node(named(instance, "url"), X, depth + 1);
    });
    in_part_ = was_in_part;
  }

  /// What an element of a node moves it by; the identity for elements that do not.
  Transform transform_of(const TiXmlElement& e) {
    const std::string& tag = e.ValueStr();
    Transform X = Transform::Identity();
    if (tag == "matrix") {
      const std::vector<double> m = numbers_in(e).all(16);
      for (Eigen::Index row = 0; row < 3; ++row)
        for (Eigen::Index column = 0; column < 4; ++column)
          X.matrix()(row, column) = m[static_cast<std::size_t>(4 * row + column)];
    } else if (tag == "translate" || tag == "scale") {
      const std::vector<double> v = numbers_in(e).all(3);
      const Vector3 xyz(v[0], v[1], v[2]);
      X = tag == "scale" ? Transform(Eigen::Scaling(xyz)) : Transform(Eigen::Translation3d(xyz));
    } else if (tag == "rotate") {
      const std::vector<double> v = numbers_in(e).all(4);
      const Vector3 axis(v[0], v[1], v[2]);
      if (axis.norm() > 0) X = Eigen::AngleAxisd(v[3] / kDegreesPerRadian, axis.normalized());
    } else if (tag == "skew" || tag == "lookat") {
      fail(e, "matrix, translate, rotate or scale", fmt::format("<{}>", tag));
    }
    return X;
  }

  void add_geometry(const TiXmlElement& geometry, const Transform& X) {
    const bool is_read = part_.empty() || in_part_ || (!part_is_node_ && is_part(geometry));
    if (!is_read) return;
    const TiXmlElement* mesh = geometry.FirstChildElement("mesh");
    if (mesh == nullptr) return;  // a spline
    Placed placed;
    for (auto* e = mesh->FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
      look_at(*e);
      const std::string& tag = e->ValueStr();
      if (tag == "triangles" || tag == "polylist" || tag == "polygons" || tag == "tristrips" ||
          tag == "trifans")
        add_primitive(*e, X, placed);
    }
  }

  /// Where vertices of a source are in the mesh.
  using Numbers = std::vector<std::uint32_t>;
  using Placed = std::map<const TiXmlElement*, Numbers>;

  /// How the corners of a primitive are written: the number of a vertex among `stride` numbers each.
  struct Corners {
    const Numbers* vertices = nullptr;
    std::size_t stride = 1, offset = 0;
  };

  void add_primitive(const TiXmlElement& primitive, const Transform& X, Placed& placed) {
    Corners corners;
    const TiXmlElement* vertices = nullptr;
    for_each(primitive, "input", [&](const TiXmlElement& input) {
      look_at(input);
      const auto offset = parse_seed(attribute_of(input, "offset"));
      if (!offset || *offset > kMostInputs)
        fail(input, fmt::format("an offset from 0 to {}", kMostInputs), "another");
      corners.stride = std::max<std::size_t>(corners.stride, *offset + 1);
      if (attribute_of(input, "semantic") != "VERTEX") return;
      corners.offset = *offset;
      vertices = &named(input, "source");
    });
    if (vertices == nullptr) fail(primitive, "an input of vertices", "none");
    const auto [known, is_new] = placed.try_emplace(vertices);
    if (is_new) known->second = add_vertices(*vertices, X);
    corners.vertices = &known->second;
    std::vector<std::size_t> counts;  // of a polylist's polygons
    if (const TiXmlElement* vcount = primitive.FirstChildElement("vcount")) {
      DaeNumbers numbers = numbers_in(*vcount);
      for (std::size_t count = 0; numbers.next(count);) counts.push_back(count);
    }
    for_each(primitive, "p", [&](const TiXmlElement& p) {
      look_at(p);
      add_polygons(primitive, p, corners, counts);
    });
    for_each(primitive, "ph", [&](const TiXmlElement& holed) {
      look_at(holed);
      if (const TiXmlElement* p = holed.FirstChildElement("p")) add_polygons(primitive, *p, corners, counts);
    });
  }

  /// Puts the positions of <vertices> into the mesh. @returns their numbers there
  Numbers add_vertices(const TiXmlElement& vertices, const Transform& X) {
    const TiXmlElement* source = nullptr;
    for_each(vertices, "input", [&](const TiXmlElement& input) {
      if (attribute_of(input, "semantic") == "POSITION") source = &named(input, "source");
    });
    const TiXmlElement* array = source == nullptr ? nullptr : source->FirstChildElement("float_array");
    if (array == nullptr) fail(vertices, "a source of positions", "none");
    const TiXmlElement* common = source->FirstChildElement("technique_common");
    const TiXmlElement* accessor = common == nullptr ? nullptr : common->FirstChildElement("accessor");
    const auto number = [&](const char* name, std::uint64_t otherwise) {
      if (accessor == nullptr || accessor->Attribute(name) == nullptr) return otherwise;
      const auto value = parse_seed(attribute_of(*accessor, name));
      if (!value || *value > kMeshBudget.values)
        fail(*accessor, fmt::format("{} of a list", name), "another");
      return *value;
    };
    const std::uint64_t stride = number("stride", 3), skipped = number("offset", 0);
    if (stride < 3) fail(*accessor, "three coordinates a vertex", fmt::format("{}", stride));
    Numbers known;
    DaeNumbers numbers = numbers_in(*array);
    double value = 0;
    for (std::uint64_t i = 0; i < skipped; ++i)
      if (!numbers.next(value)) break;
    for (bool more = true; more;) {
      Vector3 v = Vector3::Zero();
      std::uint64_t k = 0;
      for (; k < stride && (more = numbers.next(value)); ++k)
        if (k < 3) v[static_cast<Eigen::Index>(k)] = value;
      if (k < 3) break;
      known.push_back(add_vertex(*array, X * v));
    }
    return known;
  }

  std::uint32_t add_vertex(const TiXmlElement& at, const Vector3& v) {
    if (!v.allFinite()) fail(at, "finite coordinates", "others");
    const auto [it, is_new] =
        vertices_.try_emplace({v.x(), v.y(), v.z()}, static_cast<std::uint32_t>(mesh_.vertices.size()));
    if (is_new) mesh_.vertices.push_back(v);
    if (mesh_.vertices.size() > kMeshBudget.values)
      fail(at, fmt::format("at most {} vertices", kMeshBudget.values), "more");
    return it->second;
  }

  void add_polygons(const TiXmlElement& primitive, const TiXmlElement& p, const Corners& corners,
                    const std::vector<std::size_t>& counts) {
    const std::string& tag = primitive.ValueStr();
    const Numbers all = read_corners(p, corners);
    if (tag == "tristrips") {
      for (std::size_t i = 2; i < all.size(); ++i)
        add_triangle(p, all[i - 2], all[i % 2 == 0 ? i - 1 : i], all[i % 2 == 0 ? i : i - 1]);
    } else if (tag == "polylist") {
      std::size_t first = 0;
      for (const std::size_t count : counts) {
        if (count > all.size() - first) fail(p, "as many corners as <vcount> says", "fewer");
        add_fan(p, all, first, count);
        first += count;
      }
    } else {
      const std::size_t size = tag == "triangles" ? 3 : all.size();
      if (tag == "triangles" && all.size() % 3 != 0)
        fail(p, "whole triangles", fmt::format("{} corners", all.size()));
      for (std::size_t first = 0; first < all.size(); first += size) add_fan(p, all, first, size);
    }
  }

  /// Where the corners of a list are in the mesh.
  Numbers read_corners(const TiXmlElement& p, const Corners& corners) {
    const Numbers& vertices = *corners.vertices;
    Numbers all;
    DaeNumbers numbers = numbers_in(p);
    std::size_t index = 0, count = 0;
    for (; numbers.next(index); ++count) {
      if (count % corners.stride != corners.offset) continue;
      if (index >= vertices.size())
        fail(p, fmt::format("numbers of the {} vertices", vertices.size()), fmt::format("{}", index));
      all.push_back(vertices[index]);
    }
    return all;
  }

  void add_fan(const TiXmlElement& at, const Numbers& all, std::size_t first, std::size_t count) {
    for (std::size_t i = 2; i < count; ++i) add_triangle(at, all[first], all[first + i - 1], all[first + i]);
  }

  void add_triangle(const TiXmlElement& at, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    if (mesh_.triangles.size() >= 3 * kMeshBudget.values)
      fail(at, fmt::format("at most {} triangles", kMeshBudget.values), "more");
    mesh_.triangles.insert(mesh_.triangles.end(), {a, b, c});
  }

  const TiXmlElement& root_;
  const std::string &path_, &part_;
  MeshPartNames names_;
  bool part_is_node_ = false, in_part_ = false;
  std::map<std::string, const TiXmlElement*> ids_;
  std::map<std::tuple<double, double, double>, std::uint32_t> vertices_;
  TriangleMesh mesh_;
  std::size_t bytes_ = 0, looked_at_ = 0;  ///< so far, for their budgets
};

}  // namespace

TriangleMesh read_dae(const std::string& path, const std::string& part) {
  TiXmlDocument document;
  parse_xml(read_text_file(path, kMeshBudget), kDaeBudget, path, document);
  const TiXmlElement* root = document.RootElement();
  if (root == nullptr || root->ValueStr() != "COLLADA")
    throw ConfigError(path, "file", "a <COLLADA> element",
                      root == nullptr ? "none" : fmt::format("<{}>", printable_text(root->ValueStr(), 200)));
  TriangleMesh mesh = DaeReader(*root, path, part).read();
  if (mesh.triangles.empty()) throw ConfigError(path, "file", "whole triangles", "none");
  return mesh;
}

}  // namespace crossgait
