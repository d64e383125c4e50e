// Legs as arrays: many targets in, many angles out.
#include <array>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nanobind/eigen/dense.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include "ik/workspace.h"
#include "physics/core/error.h"
#include "python/bindings/arrays.h"
#include "python/bindings/bindings.h"
#include "python/bindings/inputs.h"
#include "python/bindings/interruption.h"
#include "python/bindings/job.h"
#include "python/bindings/not_made.h"
#include "python/bindings/robot.h"

namespace crossgait::python {
namespace {

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// N x `columns` numbers, of an array of that shape or of one row.
RowMatrix rows_of(const nb::object& given, int columns, const char* what) {
  const auto array = numbers_of(given);
  const bool one = array.ndim() == 1, many = array.ndim() == 2;
  if ((!one && !many) || array.shape(array.ndim() - 1) != static_cast<std::size_t>(columns))
    throw ConfigError(
        "leg", what, "N x " + std::to_string(columns) + " numbers",
        std::to_string(array.ndim()) + " dimensions, " + std::to_string(array.size()) + " numbers");
  return Eigen::Map<const RowMatrix>(array.data(), one ? 1 : static_cast<Eigen::Index>(array.shape(0)),
                                     columns);
}

constexpr Eigen::Index kPiece = 256;  // rows between looks for a signal

/// One leg of a robot.
struct RobotLeg {
  std::shared_ptr<const RobotDescription> robot;
  Leg which;
  LegKinematics kinematics;
};

std::vector<std::string> servo_names(const RobotLeg& leg) {
  std::vector<std::string> names;
  for (const int i : leg.kinematics.servo_joints()) names.push_back(leg.robot->joint(i).name);
  return names;
}

std::pair<RowMatrix, std::vector<std::string>> inverse(const RobotLeg& leg, const nb::object& targets) {
  const RowMatrix feet = rows_of(targets, 3, "targets");
  RowMatrix angles(feet.rows(), leg.kinematics.servo_count());
  std::vector<std::string> status;
  Interruption interruption;
  for (Eigen::Index i = 0; i < feet.rows(); ++i) {
    if (i % kPiece == 0 && interruption.came()) throw nb::python_error();
    const LegInverse solved = leg.kinematics.inverse(feet.row(i).transpose());
    angles.row(i) = solved.posture.servos;
    status.emplace_back(name(solved.status));
  }
  return {angles, status};
}

RowMatrix forward(const RobotLeg& leg, const nb::object& angles) {
  const RowMatrix servos = rows_of(angles, leg.kinematics.servo_count(), "angles");
  RowMatrix feet(servos.rows(), 3);
  Interruption interruption;
  for (Eigen::Index i = 0; i < servos.rows(); ++i) {
    if (i % kPiece == 0 && interruption.came()) throw nb::python_error();
    const LegForward found = leg.kinematics.forward(servos.row(i).transpose());
    if (!found.closed)
      throw ConfigError("leg", "angles " + std::to_string(i), "angles at which the linkage closes",
                        "chains that do not meet");
    feet.row(i) = found.foot;
  }
  return feet;
}

LegPosture posture(const RobotLeg& leg, const nb::object& angles) {
  const RowMatrix servos = rows_of(angles, leg.kinematics.servo_count(), "angles");
  if (servos.rows() != 1) throw ConfigError("leg", "angles", "one posture", std::to_string(servos.rows()));
  LegPosture result{servos.row(0).transpose(), {}};
  result.passive = leg.kinematics.forward(result.servos).passive;
  return result;
}

nb::dict margins(const LegMargins& found) {
  nb::dict result;
  result["joint_limit"] = found.joint_limit;
  result["serial"] = found.serial;
  result["parallel"] = found.parallel;
  return result;
}

// Samples of a grid, x fastest.
nb::dict workspace(const RobotLeg& leg, const std::array<int, 3>& count,
                   const std::optional<std::pair<std::array<double, 3>, std::array<double, 3>>>& box) {
  const LegKinematics& kinematics = leg.kinematics;
  const TargetBox bounds =
      box ? TargetBox{Vector3(box->first.data()), Vector3(box->second.data())} : reach_bounds(kinematics);
  const WorkspaceMap map = run_job(
      [kinematics, bounds, count](const StageProgress& /*told*/) {
        return sample_workspace(kinematics, kinematics.home_branch(), bounds, count);
      },
      nb::none());
  const std::size_t size = map.samples.size();
  const NewArray<double> targets(size, 3), joint_limit(size), serial(size), parallel(size);
  const NewArray<bool> reachable(size);
  nb::list status;
  for (std::size_t i = 0; i < size; ++i) {
    const auto [nx, ny] = std::pair(static_cast<std::size_t>(count[0]), static_cast<std::size_t>(count[1]));
    const Vector3 target =
        map.target(static_cast<int>(i % nx), static_cast<int>(i / nx % ny), static_cast<int>(i / (nx * ny)));
    std::copy_n(target.data(), 3, targets.data + 3 * i);
    const WorkspaceSample& sample = map.samples[i];
    reachable.data[i] = sample.status == IkStatus::kOk;
    joint_limit.data[i] = sample.margins.joint_limit;
    serial.data[i] = sample.margins.serial;
    parallel.data[i] = sample.margins.parallel;
    status.append(name(sample.status).data());
  }
  nb::dict result;
  result["target"] = targets.array;
  result["reachable"] = reachable.array;
  result["status"] = status;
  result["joint_limit"] = joint_limit.array;
  result["serial"] = serial.array;
  result["parallel"] = parallel.array;
  return result;
}

nb::dict legs_of(const RobotLike& chosen) {
  const Robot robot = robot_of(chosen, "legs");
  nb::dict legs;
  for (const Leg leg : kLegs)
    legs[name(leg).data()] = RobotLeg{robot.description, leg, make_leg_kinematics(*robot.description, leg)};
  return legs;
}

}  // namespace

void bind_kinematics(nb::module_& m) {
  nb::class_<RobotLeg>(m, "Leg",
                       "The kinematics of one leg. Feet are in the leg's frame: x forward, y left, z up, m.")
      .def("__init__", not_made<RobotLeg>("legs are those of crossgait.legs(robot)"), nb::sig(kNotMade))
      .def_prop_ro(
          "name", [](const RobotLeg& l) { return std::string(name(l.which)); }, "FL, FR, RL or RR.")
      .def_prop_ro(
          "kind", [](const RobotLeg& l) { return std::string(name(l.kinematics.kind())); },
          "five_bar, serial or least_squares.")
      .def("__repr__",
           [](const RobotLeg& l) {
             return fmt::format("<crossgait.Leg {}, {}>", name(l.which), name(l.kinematics.kind()));
           })
      .def_prop_ro("servos", &servo_names, "Names of its driven joints, in the order of angles.")
      .def_prop_ro(
          "servo_indices",
          [](const RobotLeg& l) {
            const auto joints = l.kinematics.servo_joints();
            return std::vector<int>(joints.begin(), joints.end());
          },
          "Where they stand in `State.q`.")
      .def_prop_ro(
          "origin", [](const RobotLeg& l) { return Vector3(l.kinematics.origin()); },
          "Origin of its frame in the base's, m.")
      .def("inverse", &inverse, nb::arg("targets"),
           nb::sig("def inverse(self, targets: numpy.typing.ArrayLike) -> "
                   "tuple[numpy.typing.NDArray[numpy.float64], list[str]]"),
           "Angles (N x servos, rad) that put the foot on N x 3 targets, and a status for each: ok, "
           "clamped_too_far, "
           "clamped_too_near, clamped_joint_limit or invalid_target. Angles are finite whatever the status.")
      .def(
          "forward", &forward, nb::arg("angles"),
          nb::sig("def forward(self, angles: numpy.typing.ArrayLike) -> numpy.typing.NDArray[numpy.float64]"),
          "Feet (N x 3) at N x servos angles. Raises ConfigError where a linkage cannot close.")
      .def(
          "jacobian",
          [](const RobotLeg& l, const nb::object& angles) {
            return Eigen::MatrixXd(l.kinematics.jacobian(posture(l, angles)));
          },
          nb::arg("angles"),
          nb::sig(
              "def jacobian(self, angles: numpy.typing.ArrayLike) -> numpy.typing.NDArray[numpy.float64]"),
          "d foot / d servos at one posture, 3 x servos, m/rad.")
      .def(
          "margins",
          [](const RobotLeg& l, const nb::object& angles) {
            return margins(l.kinematics.margins(posture(l, angles)));
          },
          nb::arg("angles"), nb::sig("def margins(self, angles: numpy.typing.ArrayLike) -> dict[str, float]"),
          "How far one posture is from trouble, rad: joint_limit, serial (straight or folded), parallel (a "
          "five-bar's).")
      .def("workspace", &workspace, nb::arg("count") = std::array{21, 11, 21}, nb::arg("box") = nb::none(),
           nb::sig("def workspace(self, count: tuple[int, int, int] = (21, 11, 21), box: tuple[tuple[float, "
                   "float, float], "
                   "tuple[float, float, float]] | None = None) -> dict[str, typing.Any]"),
           "A grid of targets, x fastest, over a box (min, max; by default all that the links reach): arrays "
           "`target` (N x "
           "3), `reachable`, `status` and the margins. 1,000,000 targets at most. Raises ConfigError.");
  m.def("legs", &legs_of, nb::arg("robot"),
        nb::sig("def legs(robot: Robot | str | os.PathLike[str]) -> dict[str, Leg]"),
        "The legs FL, FR, RL, RR. Raises ConfigError if the robot has none.");
}

}  // namespace crossgait::python
