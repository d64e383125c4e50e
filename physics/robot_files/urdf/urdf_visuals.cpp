#include "physics/robot_files/urdf/urdf_visuals.h"

#include <optional>
#include <sstream>

#include <fmt/format.h>
#include <tinyxml.h>

#include "physics/core/error.h"
#include "physics/core/text.h"
#include "physics/robot_files/mesh/mesh_path.h"
#include "physics/robot_files/mesh/mesh_vertices.h"
#include "physics/robot_files/urdf/urdf_elements.h"
#include "physics/robot_files/xml_text.h"

namespace crossgait {
namespace {

/// N numbers of an attribute; what stands for a missing one; nothing for anything else.
template <int N>
using Numbers = std::optional<Eigen::Matrix<double, N, 1>>;

template <int N>
Numbers<N> numbers_in(const TiXmlElement& element, const char* name, const Numbers<N>& otherwise) {
  const char* text = element.Attribute(name);
  if (text == nullptr) return otherwise;
  std::istringstream words{std::string(text)};
  Eigen::Matrix<double, N, 1> result;
  std::string word;
  for (int i = 0; i < N; ++i) {
    const auto number = words >> word ? parse_number(word) : std::nullopt;
    if (!number) return std::nullopt;
    result[i] = *number;
  }
  return words >> word ? std::nullopt : Numbers<N>(result);
}

/// All positive, or nothing.
template <int N>
Numbers<N> sizes_in(const TiXmlElement& element, const char* name) {
  const Numbers<N> sizes = numbers_in<N>(element, name, std::nullopt);
  return sizes && sizes->minCoeff() > 0 ? sizes : std::nullopt;
}

std::optional<Pose> origin_of(const TiXmlElement& visual) {
  const TiXmlElement* origin = visual.FirstChildElement("origin");
  if (origin == nullptr) return Pose::Identity();
  const auto p = numbers_in<3>(*origin, "xyz", Vector3(0, 0, 0));
  const auto rpy = numbers_in<3>(*origin, "rpy", Vector3(0, 0, 0));
  if (!p || !rpy) return std::nullopt;
  return make_pose(Quaternion(Eigen::AngleAxisd(rpy->z(), Vector3::UnitZ()) *
                              Eigen::AngleAxisd(rpy->y(), Vector3::UnitY()) *
                              Eigen::AngleAxisd(rpy->x(), Vector3::UnitX())),
                   *p);
}

class VisualReader {
 public:
  VisualReader(const TiXmlElement& robot, const std::string& path, ReaderWarnings& warnings)
      : path_(path), warnings_(warnings) {
    for_each(robot, "material", [this](const TiXmlElement& material) { name_colour(material); });
    for_each(robot, "link", [this](const TiXmlElement& link) {
      for_each(link, "visual", [this](const TiXmlElement& visual) {
        if (const TiXmlElement* material = visual.FirstChildElement("material")) name_colour(*material);
      });
    });
  }

  std::vector<VisualShape> read(const TiXmlElement& link) {
    std::vector<VisualShape> shapes;
    for_each(link, "visual", [&](const TiXmlElement& visual) {
      VisualShape shape;
      const TiXmlElement* geometry = visual.FirstChildElement("geometry");
      const TiXmlElement* element = geometry == nullptr ? nullptr : geometry->FirstChildElement();
      const auto origin = origin_of(visual);
      const std::string where = urdf_place(link, visual);
      if (element == nullptr || !origin || !set_geometry(*element, shape)) {
        warnings_.count("dropped ", " <visual> without a shape or with numbers that are none", where);
        return;
      }
      if (shape.type == VisualType::kMesh) find_file(shape.mesh, where);
      shape.X_BG = *origin;
      shape.rgba = colour_of(visual);
      shapes.push_back(std::move(shape));
    });
    return shapes;
  }

 private:
  template <typename Function>
  static void for_each(const TiXmlElement& parent, const char* tag, Function function) {
    for (auto* e = parent.FirstChildElement(tag); e != nullptr; e = e->NextSiblingElement(tag)) function(*e);
  }

  static Numbers<4> own_colour(const TiXmlElement& material) {
    const TiXmlElement* colour = material.FirstChildElement("color");
    return colour == nullptr ? std::nullopt : numbers_in<4>(*colour, "rgba", std::nullopt);
  }

  void name_colour(const TiXmlElement& material) {
    if (const auto rgba = own_colour(material)) colours_.emplace(attribute_of(material, "name"), *rgba);
  }

  Numbers<4> colour_of(const TiXmlElement& visual) const {
    const TiXmlElement* material = visual.FirstChildElement("material");
    if (material == nullptr) return std::nullopt;
    if (auto rgba = own_colour(*material)) return rgba;
    const auto known = colours_.find(attribute_of(*material, "name"));
    return known == colours_.end() ? std::nullopt : Numbers<4>(known->second);
  }

  static bool set_geometry(const TiXmlElement& element, VisualShape& shape) {
    const std::string& tag = element.ValueStr();
    if (tag == "mesh") {
      shape.type = VisualType::kMesh;
      shape.mesh = attribute_of(element, "filename");
      const auto scale = numbers_in<3>(element, "scale", Vector3(1, 1, 1));
      if (scale) shape.scale = *scale;
      return scale && is_mesh_scale(*scale) && !shape.mesh.empty();
    }
    if (tag == "box") {
      shape.type = VisualType::kBox;
      const auto edges = sizes_in<3>(element, "size");
      if (edges) shape.size = *edges / 2;
      return edges.has_value();
    }
    if (tag != "sphere" && tag != "cylinder" && tag != "capsule") return false;
    shape.type = tag == "sphere"     ? VisualType::kSphere
                 : tag == "cylinder" ? VisualType::kCylinder
                                     : VisualType::kCapsule;
    const auto radius = sizes_in<1>(element, "radius");
    if (radius) shape.size[0] = radius->x();
    if (tag == "sphere") return radius.has_value();
    const auto length = sizes_in<1>(element, "length");
    if (length) shape.size[1] = length->x() / 2;
    return radius && length;
  }

  /// Puts the file in the place of its name, or nothing if there is none.
  void find_file(std::string& mesh, const std::string& where) {
    const auto file = find_named_file(mesh, path_);
    if (!file)
      warnings_.count("dropped ", " visual mesh(es) whose file is not there",
                      fmt::format("{} ('{}')", where, printable_text(mesh, 200)));
    mesh = file.value_or("");
  }

  const std::string& path_;
  ReaderWarnings& warnings_;
  std::map<std::string, Eigen::Vector4d> colours_;  ///< by the name of the material
};

}  // namespace

std::map<std::string, std::vector<VisualShape>> read_urdf_visuals(const TiXmlElement& robot,
                                                                  const std::string& path,
                                                                  ReaderWarnings& warnings) {
  VisualReader reader(robot, path, warnings);
  std::map<std::string, std::vector<VisualShape>> visuals;
  for (auto* link = robot.FirstChildElement("link"); link != nullptr;
       link = link->NextSiblingElement("link")) {
    std::vector<VisualShape> shapes = reader.read(*link);
    if (!shapes.empty()) visuals[attribute_of(*link, "name")] = std::move(shapes);
  }
  return visuals;
}

}  // namespace crossgait
