#include <concepts>
#include <type_traits>

#include <nlohmann/json.hpp>

#include "backends/served_engine.h"
#include "physics/robot/actuator.h"
#include "physics/robot/contact_json.h"
#include "physics/robot/robot_members.h"

namespace crossgait {
namespace {

using Json = nlohmann::ordered_json;

template <typename T>
Json json_of(const T& value) {
  if constexpr (std::same_as<T, ShapeType> || std::same_as<T, VisualType>) {
    return name(value);
  } else if constexpr (std::is_enum_v<T>) {
    return static_cast<int>(value);
  } else if constexpr (std::is_arithmetic_v<T> || std::same_as<T, std::string>) {
    return value;
  } else if constexpr (std::same_as<T, Pose>) {
    return json_of(Eigen::Matrix4d(value.matrix()));
  } else if constexpr (requires { value.has_value(); }) {
    return value ? json_of(*value) : Json();
  } else if constexpr (requires { value.rows(); }) {
    Json rows = Json::array();
    for (Eigen::Index i = 0; i < value.rows(); ++i) {
      if constexpr (T::ColsAtCompileTime == 1) {
        rows.push_back(value(i));
      } else {
        Json row = Json::array();
        for (Eigen::Index k = 0; k < value.cols(); ++k) row.push_back(value(i, k));
        rows.push_back(std::move(row));
      }
    }
    return rows;
  } else if constexpr (requires { value.begin(); }) {
    Json list = Json::array();
    for (const auto& element : value) list.push_back(json_of(element));
    return list;
  } else {
    Json object = Json::object();
    for_each_member(value, [&](std::string_view key, const auto& member) {
      // Of these no motion depends on: what bodies look like, and what files asked of contact, which the
      // world has decided.
      if (key != "visuals" && key != "said") object[std::string(key)] = json_of(member);
    });
    return object;
  }
}

}  // namespace

std::string served_world_text(const WorldSpec& spec) {
  RobotDescription robot = *spec.robot;
  // A damper that acts on the speed at a step's end is armature to who makes the step.
  for (Body& body : robot.bodies) {
    body.joint.armature = step_armature(body.joint, spec.physics_dt);
    body.joint.implicit_joint_damping = 0;
  }
  Json contact = Json::object();
  for (const ContactSetting& setting : contact_settings())
    contact[std::string(setting.name)] = to_json(setting, setting.get(spec.contact));
  Json ground = {
      {"name", spec.terrain.name()}, {"columns", 0}, {"rows", 0}, {"size_x", 0.0}, {"size_y", 0.0}};
  if (const HeightField* field = spec.terrain.field()) {
    ground["columns"] = field->columns();
    ground["rows"] = field->rows();
    ground["size_x"] = field->size_x();
    ground["size_y"] = field->size_y();
  }
  return Json{{"robot", json_of(robot)},
              {"terrain", std::move(ground)},
              {"physics_dt", spec.physics_dt},
              {"gravity", json_of(spec.gravity)},
              {"fixed_base", spec.fixed_base},
              {"contact", std::move(contact)},
              {"solver", {{"tolerance", spec.solver.tolerance}, {"iterations", spec.solver.iterations}}}}
      .dump();
}

}  // namespace crossgait
