#include "physics/robot_files/sdf/sdf_values.h"

#include <limits>
#include <sstream>
#include <string>

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/core/text.h"
#include "physics/robot_files/mesh/mesh_vertices.h"

namespace crossgait {
namespace {

constexpr double kNoBound = 1e16, kInfinity = std::numeric_limits<double>::infinity();

std::string quoted_text(const SdfElement& element) {
  return fmt::format("'{}'", printable_text(element.text, 200));
}

bool is_true(const SdfElement& element, std::string_view text) {
  if (text == "true" || text == "True" || text == "TRUE" || text == "1") return true;
  if (text != "false" && text != "False" && text != "FALSE" && text != "0")
    fail_at(element, "true or false", fmt::format("'{}'", printable_text(text, 200)));
  return false;
}

}  // namespace

const SdfElement& sdf_needed(const SdfElement& parent, std::string_view child) {
  const SdfElement* element = parent.find(child);
  if (element == nullptr) fail_at(parent, fmt::format("an element <{}>", child), "none");
  return *element;
}

std::vector<double> sdf_numbers(const SdfElement& element, std::size_t count) {
  std::istringstream words(element.text);
  std::vector<double> numbers;
  for (std::string word; words >> word;) {
    const auto number = parse_number(word);
    if (!number || numbers.size() == count) {
      numbers.clear();
      break;
    }
    numbers.push_back(*number);
  }
  if (numbers.size() != count)
    fail_at(element, count == 1 ? "a finite number" : fmt::format("{} finite numbers", count),
            quoted_text(element));
  return numbers;
}

Vector3 sdf_vector(const SdfElement& parent, std::string_view child, const Vector3& otherwise) {
  const SdfElement* element = parent.find(child);
  if (element == nullptr) return otherwise;
  const std::vector<double> numbers = sdf_numbers(*element, 3);
  return {numbers[0], numbers[1], numbers[2]};
}

double sdf_number(const SdfElement& parent, std::string_view child, double otherwise) {
  const SdfElement* element = parent.find(child);
  return element == nullptr ? otherwise : sdf_numbers(*element, 1)[0];
}

double sdf_size(const SdfElement& parent, std::string_view child, double otherwise) {
  const SdfElement* element = parent.find(child);
  if (element == nullptr) return otherwise;
  const double number = sdf_numbers(*element, 1)[0];
  if (!(number >= 0)) fail_at(*element, "a number from 0 on", quoted_text(*element));
  return number;
}

double sdf_bound(const SdfElement& parent, std::string_view child, double otherwise) {
  const SdfElement* element = parent.find(child);
  if (element == nullptr) return otherwise;
  if (element->text == "inf" || element->text == "+inf") return kInfinity;
  if (element->text == "-inf") return -kInfinity;
  const double number = sdf_numbers(*element, 1)[0];
  return number >= kNoBound ? kInfinity : number <= -kNoBound ? -kInfinity : number;
}

bool sdf_flag(const SdfElement& parent, std::string_view child, bool otherwise) {
  const SdfElement* element = parent.find(child);
  return element == nullptr ? otherwise : is_true(*element, element->text);
}

Pose sdf_pose(const SdfElement* pose) {
  if (pose == nullptr) return Pose::Identity();
  const std::string format = pose->attribute("rotation_format"), degrees = pose->attribute("degrees");
  if (!format.empty() && format != "euler_rpy" && format != "quat_xyzw")
    fail_at(*pose, "rotation_format euler_rpy or quat_xyzw",
            fmt::format("'{}'", printable_text(format, 200)));
  const bool is_quaternion = format == "quat_xyzw";
  const double unit = !degrees.empty() && is_true(*pose, degrees) ? 1 / kDegreesPerRadian : 1;
  if (is_quaternion && unit != 1) fail_at(*pose, "a quaternion, which has no degrees", "degrees");
  if (pose->text.empty()) return Pose::Identity();
  const std::vector<double> v = sdf_numbers(*pose, is_quaternion ? 7 : 6);
  const Vector3 p(v[0], v[1], v[2]);
  if (!is_quaternion) return make_pose(from_roll_pitch_yaw(unit * v[3], unit * v[4], unit * v[5]), p);
  const Quaternion q(v[6], v[3], v[4], v[5]);
  if (!(q.norm() > 1e-6)) fail_at(*pose, "a quaternion of non-zero length", quoted_text(*pose));
  return make_pose(q.normalized(), p);
}

Vector3 sdf_mesh_scale(const SdfElement& mesh) {
  Vector3 scale = sdf_vector(mesh, "scale", Vector3::Ones());
  if (!is_mesh_scale(scale)) fail_at(*mesh.find("scale"), kMeshScale, quoted_text(*mesh.find("scale")));
  return scale;
}

void SdfSubmesh::place(std::vector<Vector3>& vertices) const {
  if (!is_centred) return;
  Vector3 low = vertices.front(), high = low;
  for (const Vector3& vertex : vertices) low = low.cwiseMin(vertex), high = high.cwiseMax(vertex);
  for (Vector3& vertex : vertices) vertex -= (low + high) / 2;
}

SdfSubmesh sdf_submesh(const SdfElement& mesh) {
  const SdfElement* element = mesh.find("submesh");
  if (element == nullptr) return {};
  const SdfElement& name = sdf_needed(*element, "name");
  const bool is_centred = sdf_flag(*element, "center", false);
  if (name.text.empty()) fail_at(name, "the name of a part of the mesh", "none");
  if (name.text == "__default__") return {};  // SDF's own word for all of it
  return {name.text, is_centred};
}

}  // namespace crossgait
