#include "python/bindings/batch.h"

#include <array>
#include <numeric>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "env/env_arrays.h"
#include "physics/robot/multibody.h"
#include "python/bindings/arrays.h"
#include "python/bindings/batch_parameters.h"
#include "python/bindings/bindings.h"
#include "python/bindings/busy.h"
#include "python/bindings/not_made.h"
#include "python/bindings/robot.h"
#include "python/bindings/shown.h"

namespace crossgait::python {

std::vector<std::size_t> chosen(const Batch& batch, const Indices& indices) {
  std::vector<std::size_t> all(batch.size());
  std::iota(all.begin(), all.end(), 0);
  if (indices.is_none()) return all;
  try {
    const nb::object numpy = nb::module_::import_("numpy"), numbers = numpy.attr("arange")(all.size());
    // A tuple would be an index for each dimension.
    const nb::object index = nb::isinstance<nb::tuple>(indices) ? nb::list(indices) : indices;
    return nb::cast<std::vector<std::size_t>>(numpy.attr("atleast_1d")(numbers[index]).attr("tolist")());
  } catch (const nb::python_error&) {
  } catch (const nb::cast_error&) {
  }
  throw ConfigError(Batch::kSource, "indices",
                    fmt::format("numbers from 0 to {}, a slice, or a mask of {}", all.size() - 1, all.size()),
                    shown(indices));
}

const void* identity_of(const Batch& batch) noexcept { return batch.owner; }

namespace {

constexpr const char* kSource = Batch::kSource;

// A new array of (environments, *shape), to be written by the core alone.
Batch::Held make_array(std::size_t count, const std::vector<std::size_t>& shape, bool flags) {
  nb::list all;
  all.append(count);
  for (const std::size_t size : shape) all.append(size);
  const NumpyEmpty& numpy = NumpyEmpty::get();
  const nb::object array = numpy.empty(nb::tuple(all), flags ? numpy.bool_type : numpy.float_type);
  Py_buffer buffer;
  if (PyObject_GetBuffer(array.ptr(), &buffer, PyBUF_WRITABLE) != 0) nb::raise_python_error();
  Batch::Held held;
  held.data = buffer.buf;  // stays where it is as long as the array lives, which its view keeps
  PyBuffer_Release(&buffer);
  held.array = array.attr("view")();
  held.array.attr("setflags")(nb::arg("write") = false);
  return held;
}

std::size_t size_of(const std::vector<std::size_t>& shape) {
  std::size_t size = 1;
  for (const std::size_t n : shape) size *= n;
  return size;
}

void fill(const Batch& batch, const EnvArray& row, void* data) {
  const std::size_t width = size_of(row.shape(batch.at(0)));
  for (std::size_t i = 0; i < batch.size(); ++i) {
    const QuadrupedEnv& env = batch.at(i);
    if (!env.begun()) throw ConfigError(kSource, row.name, "a reset before it", "none");
    if (row.write_flags != nullptr) {
      row.write_flags(env, static_cast<bool*>(data) + i * width);
    } else {
      row.write(env, static_cast<double*>(data) + i * width);
    }
  }
}

const Batch::Held& array_of(Batch& batch, std::size_t k) {
  check_idle(batch.owner);
  static_cast<void>(batch.at(0));  // whether it is there
  const EnvArray& row = env_arrays()[k];
  if (batch.held.empty()) batch.held.resize(env_arrays().size());
  Batch::Held& held = batch.held[k];
  if (held.data == nullptr)
    held = make_array(batch.size(), row.shape(batch.at(0)), row.write_flags != nullptr);
  if (held.revision != *batch.revision) {
    fill(batch, row, held.data);
    held.revision = *batch.revision;
  }
  return held;
}

nb::object part_of(Batch& batch, std::size_t k) {
  const EnvArrayPart& part = env_array_parts()[k];
  const nb::object& whole = array_of(batch, part.of_velocity ? 1 : 0).array;
  if (batch.parts.empty()) batch.parts.resize(env_array_parts().size());
  nb::object& view = batch.parts[k];
  if (!view.is_valid()) {
    const nb::object end = part.size == 0 ? nb::none() : nb::cast(part.begin + part.size);
    view = whole[nb::make_tuple(nb::slice(nb::none(), nb::none(), nb::none()),
                                nb::slice(nb::cast(part.begin), end, nb::none()))];
  }
  return view;
}

// The rows of a matrix, or one row that is everybody's.
class Rows {
 public:
  Rows(const nb::object& given, std::size_t rows, std::size_t columns, const char* what)
      : array_(numbers_of(given)) {
    const bool one = array_.ndim() == 1 && array_.shape(0) == columns;
    if (!one && !(array_.ndim() == 2 && array_.shape(0) == rows && array_.shape(1) == columns)) {
      std::vector<std::size_t> found;
      for (std::size_t i = 0; i < array_.ndim(); ++i) found.push_back(array_.shape(i));
      throw ConfigError(kSource, what,
                        fmt::format("shape ({}, {}), or ({},) for all alike", rows, columns, columns),
                        "shape " + shape_text(found));
    }
    stride_ = one ? 0 : columns;
  }
  const double* row(std::size_t i) const { return array_.data() + i * stride_; }
  Vector3 vector(std::size_t i) const { return Eigen::Map<const Vector3>(row(i)); }

 private:
  nb::ndarray<const double, nb::c_contig, nb::device::cpu> array_;
  std::size_t stride_;
};

void set_state(Batch& batch, const nb::object& qpos, const nb::object& qvel, const Indices& indices) {
  const std::vector<std::size_t> which = chosen(batch, indices);
  const RobotDescription& robot = *batch.at(0).model().robot;
  std::optional<Rows> positions, velocities;
  if (!qpos.is_none()) positions.emplace(qpos, which.size(), qpos_size(robot), "qpos");
  if (!qvel.is_none()) velocities.emplace(qvel, which.size(), qvel_size(robot), "qvel");
  for (std::size_t k = 0; k < which.size(); ++k) {
    RobotState state = batch.at(which[k]).world().state();
    if (positions) read_qpos(positions->row(k), state);
    if (velocities) read_qvel(velocities->row(k), state);
    batch.change(which[k]).set_state(state);
  }
}

void set_commands(Batch& batch, const nb::object& commands, const Indices& indices) {
  const std::vector<std::size_t> which = chosen(batch, indices);
  const Rows rows(commands, which.size(), 3, "commands");
  for (std::size_t k = 0; k < which.size(); ++k) {
    const double* c = rows.row(k);
    batch.change(which[k]).set_command({c[0], c[1], c[2]});
  }
}

// A point of a body's frame, m, or its centre of mass where none is said.
nb::object point_or_centre(const RobotDescription& robot, int body, const nb::object& point) {
  const Vector3& centre = robot.bodies[static_cast<std::size_t>(body)].inertia.p_BC;
  return point.is_none() ? nb::make_tuple(centre.x(), centre.y(), centre.z()) : point;
}

void apply_wrench(Batch& batch, const std::string& body, const nb::object& force, const nb::object& torque,
                  const nb::object& point, const Indices& indices) {
  const std::vector<std::size_t> which = chosen(batch, indices);
  const RobotDescription& robot = *batch.at(0).model().robot;
  const int index = body_index(robot, body, kSource);
  const nb::object zero = nb::make_tuple(0.0, 0.0, 0.0);
  const Rows forces(force, which.size(), 3, "force"),
      torques(torque.is_none() ? zero : torque, which.size(), 3, "torque"),
      points(point_or_centre(robot, index, point), which.size(), 3, "point");
  for (std::size_t k = 0; k < which.size(); ++k)
    batch.change(which[k]).apply_wrench({index, {forces.vector(k), torques.vector(k)}, points.vector(k)});
}

nb::object jacobian(const Batch& batch, const std::string& body, const nb::object& point) {
  const RobotDescription& robot = *batch.at(0).model().robot;
  const int index = body_index(robot, body, kSource);
  const Rows points(point_or_centre(robot, index, point), batch.size(), 3, "point");
  const std::size_t columns = qvel_size(robot);
  const NewArray<double> made(batch.size(), 6 * columns);
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < batch.size(); ++i) {
    const PhysicsBackend& world = batch.at(i).world();
    const Vector3 p_BP = points.vector(i);
    if (!p_BP.allFinite()) throw ConfigError(kSource, "point", "finite numbers, m", "others");
    forward_kinematics(world.robot(), world.state(), poses);
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
        made.data + i * 6 * columns, 6, static_cast<Eigen::Index>(columns)) =
        point_jacobian(world.robot(), poses, index, p_BP);
  }
  return made.array.attr("reshape")(batch.size(), 6, columns);
}

// Arrays of truth values, and whatever NumPy makes one of.
using Flags = nb::ndarray<const bool, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

Flags flags_of(const nb::object& given, std::size_t size) {
  try {
    const Flags flags =
        nb::cast<Flags>(nb::module_::import_("numpy").attr("ascontiguousarray")(given), false);
    if (flags.size() == size) return flags;
  } catch (const nb::python_error&) {
  } catch (const nb::cast_error&) {
  }
  throw ConfigError(kSource, "end_episodes", fmt::format("{} truth values", size), shown(given));
}

void end_episodes(Batch& batch, const nb::object& terminated, const nb::object& truncated) {
  const Flags held[2] = {flags_of(terminated, batch.size()), flags_of(truncated, batch.size())};
  const bool* const flags[2] = {held[0].data(), held[1].data()};
  for (std::size_t i = 0; i < batch.size(); ++i) {
    if (!flags[0][i] && !flags[1][i]) continue;
    if (batch.vector != nullptr) {
      batch.vector->end_episode(i, flags[0][i]);
    } else {
      batch.change(i).end_episode(flags[0][i]);
    }
  }
}

using Rewards = nb::ndarray<double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

void end_in_step(Batch& batch, const nb::object& terminated, const nb::object& truncated,
                 const Rewards& rewards) {
  const Flags failed = flags_of(terminated, batch.size()), out_of_time = flags_of(truncated, batch.size());
  if (rewards.size() != batch.size())
    throw ConfigError(kSource, "rewards", fmt::format("{} numbers", batch.size()),
                      fmt::format("{}", rewards.size()));
  for (std::size_t i = 0; i < batch.size(); ++i) {
    if (failed.data()[i] || out_of_time.data()[i])
      rewards.data()[i] = batch.change(i).end_in_step(failed.data()[i]);
  }
}

nb::object limits_of(const Batch& batch) {
  const RobotDescription& robot = *batch.at(0).model().world.robot;
  const auto count = static_cast<std::size_t>(robot.joint_count());
  const NewArray<double> limits(count, 2);
  for (std::size_t i = 0; i < count; ++i) {
    limits.data[2 * i] = robot.joint(static_cast<int>(i)).lower;
    limits.data[2 * i + 1] = robot.joint(static_cast<int>(i)).upper;
  }
  return limits.array;
}

// Docstrings and signatures live as long as what they are of.
const char* kept(std::string text) {
  static auto* all = new std::vector<std::unique_ptr<std::string>>;
  return all->emplace_back(std::make_unique<std::string>(std::move(text)))->c_str();
}

const char* signature(std::string_view name, bool flags) {
  return kept(
      fmt::format("def {}(self) -> numpy.typing.NDArray[numpy.{}]", name, flags ? "bool_" : "float64"));
}

void bind_arrays(nb::class_<Batch>& c) {
  for (std::size_t k = 0; k < env_arrays().size(); ++k) {
    const EnvArray& row = env_arrays()[k];
    c.def_prop_ro(
        kept(std::string(row.name)), [k](Batch& b) { return array_of(b, k).array; },
        nb::sig(signature(row.name, row.write_flags != nullptr)),
        kept(fmt::format("{}: {}.", row.unit, row.help)));
  }
  for (std::size_t k = 0; k < env_array_parts().size(); ++k) {
    const EnvArrayPart& part = env_array_parts()[k];
    c.def_prop_ro(
        kept(std::string(part.name)), [k](Batch& b) { return part_of(b, k); },
        nb::sig(signature(part.name, false)),
        kept(fmt::format("{}: {}. A part of `{}`.", part.unit, part.help,
                         part.of_velocity ? "qvel" : "qpos")));
  }
}

void bind_names(nb::class_<Batch>& c) {
  c.def_prop_ro("num_envs", [](const Batch& b) { return b.size(); })
      .def_prop_ro(
          "step_dt", [](const Batch& b) { return b.at(0).config().policy_dt; }, "Of a policy step, s.")
      .def_prop_ro(
          "episode_seconds", [](const Batch& b) { return b.at(0).config().episode_seconds; },
          "After which an episode is truncated, s.")
      .def_prop_ro(
          "joint_names", [](const Batch& b) { return joint_names(*b.at(0).model().robot, false); },
          "Of all joints, in the order of arrays.")
      .def_prop_ro(
          "servo_indices", [](const Batch& b) { return b.at(0).model().robot->actuated_joints(); },
          "Where the driven joints stand among them.")
      .def_prop_ro("body_names", [](const Batch& b) { return body_names(*b.at(0).model().robot); })
      .def_prop_ro(
          "home", [](const Batch& b) { return Eigen::VectorXd(b.at(0).model().robot->home); },
          "Joint angles of the home pose, rad.")
      .def_prop_ro("joint_limits", &limits_of,
                   nb::sig("def joint_limits(self) -> numpy.typing.NDArray[numpy.float64]"),
                   "Lower and upper of every joint, (joints, 2), rad.")
      .def(
          "body_index",
          [](const Batch& b, const std::string& name) {
            return body_index(*b.at(0).model().robot, name, kSource);
          },
          nb::arg("name"), "Where a body stands in `body_names`. Raises ConfigError.")
      .def_prop_rw(
          "random", [](const Batch& b) { return b.random; },
          [](Batch& b, nb::object random) { b.random = random; },
          nb::for_getter(nb::sig("def random(self) -> numpy.random.Generator")),
          nb::for_setter(nb::sig("def random(self, random: numpy.random.Generator, /) -> None")),
          "Random numbers of terms: the episodes' seeds decide them.");
}

}  // namespace

void bind_batch(nb::module_& m) {
  nb::class_<Batch> batch(
      m, "Batch",
      "All environments as arrays, a row each, and what changes them between steps. Arrays are read-only and "
      "always the same ones. What is asked for shows the present step; one that is kept shows the step in "
      "which "
      "it was last asked for: ask again, or keep a `.copy()`. "
      "The "
      "core gathers an array when it is first asked for in a step; asking again, and parts of it, cost no "
      "copy.");
  batch.def("__init__",
            not_made<Batch>("a Batch is that of an environment: core.batch(), env.unwrapped.batch"),
            nb::sig(kNotMade));
  bind_arrays(batch);
  bind_names(batch);
  batch
      .def("set_state", guarded(&set_state), nb::arg("qpos").none() = nb::none(),
           nb::arg("qvel").none() = nb::none(), nb::arg("indices").none() = nb::none(),
           nb::sig("def set_state(self, qpos: numpy.typing.ArrayLike | None = None, qvel: "
                   "numpy.typing.ArrayLike | "
                   "None = None, indices: numpy.typing.ArrayLike | slice | None = None) -> None"),
           "Puts robots into states, those of `indices` or all: rows as `qpos` and `qvel` have them, or one "
           "row for "
           "all. Contacts and targets on their way are forgotten, and no way counts as made. The next step's "
           "observation shows it. Raises ConfigError, also for an episode that has ended; environments "
           "before the "
           "one at fault are set.")
      .def("set_commands", guarded(&set_commands), nb::arg("commands"),
           nb::arg("indices").none() = nb::none(),
           nb::sig("def set_commands(self, commands: numpy.typing.ArrayLike, indices: "
                   "numpy.typing.ArrayLike | slice | None = None) -> None"),
           "Asks for other velocities (m/s, m/s, rad/s) to the end of the episodes.")
      .def("apply_wrench", guarded(&apply_wrench), nb::arg("body"), nb::arg("force"),
           nb::arg("torque").none() = nb::none(), nb::arg("point").none() = nb::none(),
           nb::arg("indices").none() = nb::none(),
           nb::sig("def apply_wrench(self, body: str, force: numpy.typing.ArrayLike, torque: "
                   "numpy.typing.ArrayLike | "
                   "None = None, point: numpy.typing.ArrayLike | None = None, indices: "
                   "numpy.typing.ArrayLike | slice | None = None) -> None"),
           "Lets a force (N) and torque (N m), in W, act on a body during the next step, the force at a "
           "point of the "
           "body's frame (m; None: its centre of mass). One for all, or a row each. Wrenches add up. Raises "
           "ConfigError.")
      .def("set_parameters", guarded(&set_parameters), nb::arg("parameters"),
           nb::arg("indices").none() = nb::none(),
           nb::sig("def set_parameters(self, parameters: dict[str, typing.Any], indices: "
                   "numpy.typing.ArrayLike | slice | None = None) -> None"),
           "Changes worlds, for these episodes and those that follow: {'friction': 0.4, 'mass': 'x1.1', "
           "'kp': 30}, "
           "quantities as `crossgait verdict --against` takes them. A factor is of what the configuration "
           "says or has "
           "drawn, None takes a change back, an array has a number for each environment. Worlds are built "
           "anew "
           "and go on as they were. Raises ConfigError, also for physics_dt and delay.")
      .def_prop_ro(
          "parameters", guarded(&parameters_of),
          nb::sig("def parameters(self) -> list[dict[str, typing.Any]]"),
          "What `set_parameters` has set and not taken back, of each environment: {} of one that is as "
          "its configuration says.")
      .def("jacobian", guarded(&jacobian), nb::arg("body"), nb::arg("point").none() = nb::none(),
           nb::sig("def jacobian(self, body: str, point: numpy.typing.ArrayLike | None = None) -> "
                   "numpy.typing.NDArray[numpy.float64]"),
           "Of a point of a body (its frame, m; None: its centre of mass), one for all or a row each, in a "
           "new array (environments, 6, "
           "columns of "
           "`qvel`): velocity of the point and angular velocity of the body, both in W, are jacobian @ qvel.")
      .def("end_episodes", guarded(&end_episodes), nb::arg("terminated"), nb::arg("truncated"),
           nb::sig("def end_episodes(self, terminated: numpy.typing.ArrayLike, truncated: "
                   "numpy.typing.ArrayLike) -> None"),
           "Ends episodes, as an outcome or their time would: the next step says so. Raises ConfigError for "
           "one that "
           "has ended.")
      .def(
          "_end_in_step", guarded(&end_in_step), nb::arg("terminated"), nb::arg("truncated"),
          nb::arg("rewards").noconvert(),
          nb::sig("def _end_in_step(self, terminated: numpy.typing.NDArray[numpy.bool_], truncated: "
                  "numpy.typing.NDArray[numpy.bool_], rewards: numpy.typing.NDArray[numpy.float64]) -> None"),
          "What a term says of the step that was made: its episodes end, and rewards are theirs.")
      .def("__repr__",
           [](const Batch& b) { return fmt::format("<crossgait.Batch of {} environments>", b.size()); });
  m.def(
      "environment_arrays",
      [] {
        nb::list all;
        for (const EnvArray& row : env_arrays())
          all.append(nb::make_tuple(std::string(row.name), std::string(row.unit), std::string(row.help)));
        for (const EnvArrayPart& part : env_array_parts())
          all.append(nb::make_tuple(std::string(part.name), std::string(part.unit), std::string(part.help)));
        return all;
      },
      nb::sig("def environment_arrays() -> list[tuple[str, str, str]]"),
      "(name, unit, what it is) of every array of a `Batch`.");
}

}  // namespace crossgait::python
