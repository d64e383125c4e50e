#include "python/bindings/robot.h"

#include <filesystem>
#include <functional>
#include <map>
#include <string>

#include <fmt/ranges.h>
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/vector.h>

#include "ik/leg_kinematics.h"
#include "physics/core/error.h"
#include "physics/core/folder.h"
#include "physics/robot/multibody.h"
#include "physics/robot/robot_identity.h"
#include "physics/robot_files/data_path.h"
#include "physics/robot_files/mesh/mesh_vertices.h"
#include "python/bindings/bindings.h"
#include "python/bindings/inputs.h"
#include "python/bindings/not_made.h"

namespace crossgait::python {
namespace {

/// Reads a mesh as arrays: vertices, N x 3, and triangles of them, M x 3.
nb::tuple read_mesh(const std::string& file) {
  const TriangleMesh mesh = read_mesh_triangles(file);
  Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> vertices(mesh.vertices.size(), 3);
  for (Eigen::Index i = 0; i < vertices.rows(); ++i)
    vertices.row(i) = mesh.vertices[static_cast<std::size_t>(i)];
  Eigen::Matrix<std::int32_t, Eigen::Dynamic, 3, Eigen::RowMajor> triangles(mesh.triangles.size() / 3, 3);
  for (Eigen::Index i = 0; i < triangles.size(); ++i)
    triangles.data()[i] = static_cast<std::int32_t>(mesh.triangles[static_cast<std::size_t>(i)]);
  return nb::make_tuple(std::move(vertices), std::move(triangles));
}

nb::list visuals(const RobotDescription& robot) {
  nb::list all;
  for (std::size_t i = 0; i < robot.bodies.size(); ++i) {
    for (const VisualShape& visual : robot.bodies[i].visuals) {
      nb::dict shape;
      shape["body"] = i;
      shape["type"] = name(visual.type);
      shape["size"] = visual.size;
      shape["mesh"] = visual.mesh;
      shape["scale"] = visual.scale;
      shape["pose"] = Eigen::Matrix4d(visual.X_BG.matrix());
      shape["rgba"] = visual.rgba;
      all.append(shape);
    }
  }
  return all;
}

nb::list collisions(const RobotDescription& robot) {
  nb::list all;
  for (std::size_t i = 0; i < robot.bodies.size(); ++i) {
    for (const CollisionShape& collision : robot.bodies[i].shapes) {
      Eigen::MatrixXd vertices(static_cast<Eigen::Index>(collision.vertices.size()), 3);
      for (Eigen::Index k = 0; k < vertices.rows(); ++k)
        vertices.row(k) = collision.vertices[static_cast<std::size_t>(k)];
      nb::dict shape;
      shape["body"] = i;
      shape["name"] = collision.name;
      shape["type"] = name(collision.type);
      shape["size"] = collision.size;
      shape["pose"] = Eigen::Matrix4d(collision.X_BG.matrix());
      shape["vertices"] = vertices;
      all.append(shape);
    }
  }
  return all;
}

nb::list servo_legs(const RobotDescription& robot) {
  std::map<int, std::pair<std::string, int>> places;  // by joint
  for (const Leg leg : kLegs) {
    const LegKinematics kinematics = make_leg_kinematics(robot, leg);
    int depth = 0;
    for (const int joint : kinematics.servo_joints()) places[joint] = {std::string(name(leg)), depth++};
  }
  nb::list all;
  for (const int joint : robot.actuated_joints())
    all.append(nb::make_tuple(places.at(joint).first, places.at(joint).second));
  return all;
}

nb::list inferences(const Robot& robot) {
  nb::list all;
  for (const Inference& inference : robot.report.inferred)
    all.append(nb::make_tuple(inference.what, inference.value, inference.reason));
  return all;
}

// What a robot is loaded by anywhere on this machine, and what tells whether it is still the same.
nb::tuple pickled(const Robot& robot) {
  const std::string from =
      std::filesystem::exists(robot.from) ? absolute_path(robot.from).string() : robot.from;
  const std::string hash = identity_hash(*robot.description);
  if (identity_hash(*load(from).description) != hash)
    throw ConfigError(from, "robot", "a robot as its file says, to be pickled",
                      "another: the file has changed, or an environment has set servos");
  return nb::make_tuple(from, hash);
}

Robot unpickled(const std::string& from, const std::string& hash) {
  Robot robot = load(from);
  if (identity_hash(*robot.description) != hash)
    throw ConfigError(from, "robot", "the robot that was pickled", "another: its file has changed");
  return robot;
}

}  // namespace

std::vector<std::string> joint_names(const RobotDescription& robot, bool actuated_only) {
  std::vector<std::string> names;
  for (int i = 0; i < robot.joint_count(); ++i) {
    if (!actuated_only || robot.joint(i).actuated) names.push_back(robot.joint(i).name);
  }
  return names;
}

Robot load(const std::string& name_or_file) {
  LoadedRobot loaded = load_robot_with_report(find_robot(name_or_file));
  return {name_or_file, std::make_shared<const RobotDescription>(std::move(loaded.robot)),
          std::move(loaded.report)};
}

std::vector<std::string> body_names(const RobotDescription& robot) {
  std::vector<std::string> names;
  for (const Body& body : robot.bodies) names.push_back(body.name);
  return names;
}

int body_index(const RobotDescription& robot, const std::string& name, const std::string& source) {
  for (std::size_t i = 0; i < robot.bodies.size(); ++i) {
    if (robot.bodies[i].name == name) return static_cast<int>(i);
  }
  throw ConfigError(source, "body", fmt::format("one of {}", fmt::join(body_names(robot), ", ")), name);
}

void bind_robot(nb::module_& m) {
  nb::class_<Robot>(m, "Robot", "A robot, read from its URDF, MJCF, SDF or robot.yaml. Immutable.")
      .def("__init__", not_made<Robot>("a Robot is what Robot.load makes of a name or a file"),
           nb::sig(kNotMade))
      .def_static(
          "load", [](const std::filesystem::path& path) { return load(path.string()); },
          nb::arg("name_or_file"),
          "A bundled robot by its name (`crossgait.robots()`), or the robot of a .urdf, .xml (MJCF), .sdf or "
          ".yaml "
          "file. What the file does not say is inferred: see `inferred`. Raises ConfigError.")
      .def_prop_ro("name", [](const Robot& r) { return r.description->name; })
      .def_ro("source", &Robot::from, "The name or file that it was loaded by.")
      .def_prop_ro("mass_kg", [](const Robot& r) { return r.description->total_mass(); })
      .def_prop_ro(
          "joints", [](const Robot& r) { return joint_names(*r.description, false); },
          "Names of all joints, in the order of `State.q`.")
      .def_prop_ro(
          "servos", [](const Robot& r) { return joint_names(*r.description, true); },
          "Names of the driven joints, in the order of targets.")
      .def_prop_ro(
          "servo_indices", [](const Robot& r) { return r.description->actuated_joints(); },
          "Where the driven joints stand among all.")
      .def_prop_ro(
          "servo_legs", [](const Robot& r) { return servo_legs(*r.description); },
          nb::sig("def servo_legs(self) -> list[tuple[str, int]]"),
          "Of each servo, in their order: its leg (FL, FR, RL, RR) and which of that leg's it is, from "
          "the hip.")
      .def_prop_ro("bodies", [](const Robot& r) { return body_names(*r.description); })
      .def_prop_ro(
          "parents",
          [](const Robot& r) {
            std::vector<int> parents;
            for (const Body& body : r.description->bodies) parents.push_back(body.parent);
            return parents;
          },
          "Of each body, in their order: the index of the one that it hangs on; -1 of the base.")
      .def_prop_ro(
          "home", [](const Robot& r) { return Eigen::VectorXd(r.description->home); },
          "Joint angles of the home pose, rad.")
      .def_prop_ro(
          "home_height", [](const Robot& r) { return r.description->home_height; },
          "Height of the base over flat ground in the home pose, m.")
      .def_prop_ro(
          "standing_height", [](const Robot& r) { return r.description->standing_height; },
          "How deep below the hips the feet of a standing leg are, m: what gaits scale with.")
      .def_prop_ro("inferred", &inferences, nb::sig("def inferred(self) -> list[tuple[str, str, str]]"),
                   "What its files did not say: (what, value, reason).")
      .def_prop_ro(
          "warnings", [](const Robot& r) { return r.report.warnings; }, "What is doubtful about its files.")
      .def_prop_ro(
          "visuals", [](const Robot& r) { return visuals(*r.description); },
          nb::sig("def visuals(self) -> list[dict[str, typing.Any]]"),
          "What its bodies look like: body (index), type, size (m), mesh (file), scale, pose (4 x 4, in the "
          "body's frame), rgba or None.")
      .def_prop_ro(
          "collisions", [](const Robot& r) { return collisions(*r.description); },
          nb::sig("def collisions(self) -> list[dict[str, typing.Any]]"),
          "What touches the ground: body (index), name, type, size (m), pose (4 x 4), vertices (N x 3, m, of "
          "a "
          "hull).")
      .def(
          "to_yaml",
          [](const Robot& r) {
            return to_yaml({*r.description, r.report}, r.report.file);
          },
          "The whole robot.yaml: with it beside the robot's file nothing is inferred.")
      .def("__getstate__", &pickled, nb::sig("def __getstate__(self) -> tuple[str, str]"))
      .def("__setstate__",
           [](Robot& r, const std::pair<std::string, std::string>& state) {
             new (&r) Robot(unpickled(state.first, state.second));
           })
      .def(
          "__eq__",
          [](const Robot& a, const Robot& b) {
            return identity_hash(*a.description) == identity_hash(*b.description);
          },
          nb::is_operator(), nb::sig("def __eq__(self, other: object, /) -> bool"),
          "Whether they are the same to an engine, wherever they were read from.")
      .def("__hash__", [](const Robot& r) { return std::hash<std::string>()(identity_hash(*r.description)); })
      .def("__repr__", [](const Robot& r) {
        return "<crossgait.Robot " + quoted(r.description->name) + ": " +
               std::to_string(r.description->joint_count()) + " joints, " +
               std::to_string(r.description->total_mass()) + " kg>";
      });
  m.def(
      "read_mesh", &read_mesh, nb::arg("file"),
      nb::sig("def read_mesh(file: str) -> tuple[numpy.typing.NDArray[numpy.float64], "
              "numpy.typing.NDArray[numpy.int32]]"),
      "Vertices (N x 3) of an STL, OBJ or DAE file and triangles of them (M x 3), as pages show it; a DAE in "
      "metres. Raises ConfigError.");
  m.def(
      "robots", [] { return robot_names(); }, "Names of the robots that come with Crossgait.");
  m.def(
      "models_dir", [] { return models_dir(); },
      "The folder of the robots and terrains that come with Crossgait.");
}

}  // namespace crossgait::python
