// One world in one engine, to be driven by hand.
#include <algorithm>
#include <tuple>

#include <fmt/format.h>
#include <nanobind/eigen/dense.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>
#include <nlohmann/json.hpp>

#include "backends/registry.h"
#include "env/env_arrays.h"
#include "parity/report.h"
#include "physics/core/error.h"
#include "physics/engine/lost_engine.h"
#include "physics/robot/multibody.h"
#include "python/bindings/arrays.h"
#include "python/bindings/bindings.h"
#include "python/bindings/busy.h"
#include "python/bindings/inputs.h"
#include "python/bindings/interruption.h"
#include "python/bindings/number.h"
#include "python/bindings/robot.h"
#include "python/bindings/world_snapshot.h"

namespace crossgait::python {
namespace {

Eigen::Vector4d wxyz(const Quaternion& q) { return {q.w(), q.x(), q.y(), q.z()}; }
Quaternion of_wxyz(const Eigen::Vector4d& q) { return {q[0], q[1], q[2], q[3]}; }

JointVector joint_vector(const nb::object& given, const char* what) {
  const auto array = numbers_of(given);
  const auto values = vector_of(array, what);
  if (values.size() > kMaxJoints)
    throw ConfigError("world", what, "at most " + std::to_string(kMaxJoints) + " numbers",
                      std::to_string(values.size()));
  return values;
}

/// Numbers that NumPy makes an array of; what they are in signatures.
class ArrayLike : public nb::object {
  NB_OBJECT_DEFAULT(ArrayLike, nb::object, "numpy.typing.ArrayLike", [](const PyObject*) { return true; })
};

template <int size>
Eigen::Matrix<double, size, 1> vector_of_size(const nb::object& given, const char* what) {
  const auto array = numbers_of(given);
  if (array.size() != size)
    throw ConfigError("world", what, std::to_string(size) + " numbers", std::to_string(array.size()));
  return Eigen::Map<const Eigen::Matrix<double, size, 1>>(array.data());
}

Vector3 vector3(const nb::object& given, const char* what) { return vector_of_size<3>(given, what); }

std::unique_ptr<PhysicsBackend> make_world(const RobotLike& chosen, const TerrainLike& ground,
                                           const EngineLike& engine_like,
                                           std::optional<WrittenNumber> friction,
                                           const ContactLike& contact_like, WrittenNumber physics_dt,
                                           const ArrayLike& gravity, bool fixed_base) {
  WorldSpec spec;
  const std::string engine = engine_name_of(engine_like, "world"),
                    contact = contact_text_of(contact_like, "world");
  const Robot robot = robot_of(chosen, "world");
  spec.robot = robot.description;
  spec.terrain = terrain_of(ground, "world");
  spec.physics_dt = physics_dt;
  spec.gravity = vector3(gravity, "gravity");
  spec.fixed_base = fixed_base;
  ContactSettings asked;
  if (!contact.empty()) asked = parse_contact_settings(contact, "world");
  if (friction) asked.set("friction", std::vector{friction->value}, "world", "friction");
  spec.contact = resolve_contact(robot.description->contact, asked, "world");
  const nb::gil_scoped_release release;
  const Interruption interruption;
  auto world = make_world(engine.empty() ? available_engines().front() : engine, spec);
  world->reset();
  return world;
}

int body_of(const PhysicsBackend& world, const std::variant<int, std::string>& body) {
  if (const auto* name = std::get_if<std::string>(&body)) return body_index(world.robot(), *name, "world");
  const int index = std::get<int>(body);
  if (index < 0 || index > world.robot().joint_count())
    throw nb::index_error(
        ("body " + std::to_string(index) + ": expected 0 to " + std::to_string(world.robot().joint_count()))
            .c_str());
  return index;
}

Vector3 point_of(const PhysicsBackend& world, int body, const nb::object& point) {
  const Vector3 p_BP = point.is_none() ? world.robot().bodies[static_cast<std::size_t>(body)].inertia.p_BC
                                       : vector3(point, "point");
  if (!p_BP.allFinite()) throw ConfigError("world", "point", "finite numbers, m", "others");
  return p_BP;
}

void apply_wrench(PhysicsBackend& world, const std::variant<int, std::string>& body, const nb::object& force,
                  const nb::object& torque, const nb::object& point) {
  const int index = body_of(world, body);
  const Vector3 moment = torque.is_none() ? Vector3(Vector3::Zero()) : vector3(torque, "torque");
  world.apply_wrench({index, {vector3(force, "force"), moment}, point_of(world, index, point)});
}

std::pair<Vector3, Vector3> body_velocity(const PhysicsBackend& world,
                                          const std::variant<int, std::string>& body) {
  std::vector<Pose> poses;
  std::vector<BodyVelocity> velocities;
  forward_kinematics(world.robot(), world.state(), poses);
  forward_velocities(world.robot(), world.state(), poses, velocities);
  const BodyVelocity& of = velocities[static_cast<std::size_t>(body_of(world, body))];
  return {of.v, of.w};
}

Eigen::MatrixXd jacobian(const PhysicsBackend& world, const std::variant<int, std::string>& body,
                         const nb::object& point) {
  std::vector<Pose> poses;
  forward_kinematics(world.robot(), world.state(), poses);
  const int index = body_of(world, body);
  return point_jacobian(world.robot(), poses, index, point_of(world, index, point));
}

const char* step(PhysicsBackend& world, const ArrayLike& targets, int substeps) {
  if (substeps < 1) throw ConfigError("world", "substeps", "at least 1", std::to_string(substeps));
  const JointTargets joints{joint_vector(targets, "targets")};
  constexpr int kPiece = 64;  // between looks for a signal
  StepStatus status = StepStatus::kOk;
  work_at(&world, [&](Interruption& interruption) {
    for (int left = substeps; left > 0 && status == StepStatus::kOk && !interruption.came(); left -= kPiece)
      status = world.step(joints, std::min(left, kPiece));
    if (status != StepStatus::kInvalidTargets) world.clear_wrenches();
  });
  if (status == StepStatus::kDiverged) throw_if_lost(world);
  if (status == StepStatus::kInvalidTargets)
    throw ConfigError(
        "world", "targets", std::to_string(world.robot().actuated_joints().size()) + " finite numbers, rad",
        std::to_string(joints.q.size()) + " numbers" + (joints.q.allFinite() ? "" : ", not all finite"));
  return status == StepStatus::kOk ? "ok" : "diverged";
}

std::string in_words(const PhysicsBackend& world) {
  const WorldSpec& spec = world.spec();
  return fmt::format("{} of {:g} kg on {}, {}, steps of {:g} s, gravity {:g} m/s^2{}", world.robot().name,
                     world.robot().total_mass(), spec.terrain.name(), to_json(spec.contact).dump(),
                     spec.physics_dt, spec.gravity.norm(), spec.fixed_base ? ", base fixed" : "");
}

WorldSnapshot save(const PhysicsBackend& world) { return {world.save(), in_words(world)}; }

void restore(PhysicsBackend& world, const WorldSnapshot& snapshot) {
  if (const std::string here = in_words(world);
      snapshot.world != here && snapshot.engine_name == world.info().name)
    throw ConfigError("restore", "world", here, snapshot.world);
  world.restore(snapshot);
}

// A copy, whose numbers cannot be set: nobody is to believe that they act.
nb::object read_only(nb::object array) {
  array.attr("setflags")(nb::arg("write") = false);
  return array;
}

// What `write` puts down, as an array of its own.
nb::object numbers_of_state(std::size_t size, const RobotState& state,
                            void (*write)(const RobotState&, double*)) {
  const NewArray<double> made(size);
  write(state, made.data);
  return read_only(made.array);
}

// Sizes the joints by what is given.
void set_numbers(RobotState& state, const nb::object& given, const char* what, Eigen::Index first,
                 JointVector RobotState::*joints, void (*read)(const double*, RobotState&)) {
  const auto array = numbers_of(given);
  const Eigen::Index count = vector_of(array, what).size() - first;
  if (count < 0 || count > kMaxJoints)
    throw ConfigError("state", what, std::to_string(first) + " numbers of the base and one for each joint",
                      std::to_string(count + first) + " numbers");
  (state.*joints).resize(count);
  read(array.data(), state);
}

std::vector<Eigen::Matrix4d> poses(const RobotDescription& robot, const RobotState& state) {
  std::vector<Pose> all;
  forward_kinematics(robot, state, all);
  std::vector<Eigen::Matrix4d> result;
  for (const Pose& pose : all) result.emplace_back(pose.matrix());
  return result;
}

std::vector<Eigen::Matrix4d> body_poses(const RobotLike& chosen, const RobotState& state) {
  const Robot robot = robot_of(chosen, "body_poses");
  if (state.q.size() != robot.description->joint_count())
    throw ConfigError(
        "state", "q",
        std::to_string(robot.description->joint_count()) + " joint angles of " + robot.description->name,
        std::to_string(state.q.size()));
  return poses(*robot.description, state);
}

// A vector of the state's own, whose elements can be set; it is set as a whole by whatever is three numbers.
void bind_vector(nb::class_<RobotState>& c, const char* name, Vector3 RobotState::*member, const char* getter,
                 const char* setter, const char* help) {
  c.def_prop_rw(
      name, [member](RobotState& s) -> Vector3& { return s.*member; },
      [member, name](RobotState& s, const nb::object& given) { s.*member = vector3(given, name); },
      nb::for_getter(nb::rv_policy::reference_internal), nb::for_getter(nb::sig(getter)),
      nb::for_setter(nb::sig(setter)), help);
}

bool are_equal(const RobotState& a, const RobotState& b) {
  return a.time == b.time && a.p_WB == b.p_WB && a.q_WB.coeffs() == b.q_WB.coeffs() && a.v_WB == b.v_WB &&
         a.w_WB == b.w_WB && a.q.size() == b.q.size() && a.q == b.q && a.qd.size() == b.qd.size() &&
         a.qd == b.qd;
}

void bind_state(nb::module_& m) {
  nb::class_<RobotState> state(
      m, "State",
      "Configuration and velocity of a robot: a value, which no step changes. World frame W: z up; "
      "base frame B at the base link's origin.");
  bind_vector(state, "p_WB", &RobotState::p_WB, "def p_WB(self) -> numpy.typing.NDArray[numpy.float64]",
              "def p_WB(self, p_WB: numpy.typing.ArrayLike, /) -> None", "Position of the base, m.");
  bind_vector(state, "v_WB", &RobotState::v_WB, "def v_WB(self) -> numpy.typing.NDArray[numpy.float64]",
              "def v_WB(self, v_WB: numpy.typing.ArrayLike, /) -> None",
              "Velocity of the base's origin, m/s.");
  bind_vector(state, "w_WB", &RobotState::w_WB, "def w_WB(self) -> numpy.typing.NDArray[numpy.float64]",
              "def w_WB(self, w_WB: numpy.typing.ArrayLike, /) -> None",
              "Angular velocity of the base in W, rad/s.");
  state.def(nb::init<>())
      .def("__eq__", &are_equal, nb::is_operator(), nb::sig("def __eq__(self, other: object, /) -> bool"),
           "Whether all numbers are the same, the time as well.")
      .def("__hash__",
           [](const RobotState&) -> std::size_t {
             throw nb::type_error("a State has no hash: it can be changed");
           })
      .def("__copy__", [](const RobotState& s) { return RobotState(s); })
      .def("__deepcopy__", [](const RobotState& s, nb::handle) { return RobotState(s); })
      .def("__getstate__",
           [](const RobotState& s) {
             return nb::make_tuple(s.time, s.p_WB, wxyz(s.q_WB), s.v_WB, s.w_WB, Eigen::VectorXd(s.q),
                                   Eigen::VectorXd(s.qd));
           })
      .def("__setstate__",
           [](RobotState& s, const std::tuple<double, Vector3, Eigen::Vector4d, Vector3, Vector3, nb::object,
                                              nb::object>& saved) {
             const auto& [time, p_WB, q_WB, v_WB, w_WB, q, qd] = saved;
             new (&s) RobotState{.time = time,
                                 .p_WB = p_WB,
                                 .q_WB = of_wxyz(q_WB),
                                 .v_WB = v_WB,
                                 .w_WB = w_WB,
                                 .q = joint_vector(q, "q"),
                                 .qd = joint_vector(qd, "qd")};
           })
      .def_rw("time", &RobotState::time,
              "Simulated seconds since the world was reset: of an environment the settling before its "
              "episode counts, which `info['time']` leaves out.")
      .def_prop_rw(
          "q_WB", [](const RobotState& s) { return read_only(nb::cast(wxyz(s.q_WB))); },
          [](RobotState& s, const nb::object& q) { s.q_WB = of_wxyz(vector_of_size<4>(q, "q_WB")); },
          nb::for_getter(nb::sig("def q_WB(self) -> numpy.typing.NDArray[numpy.float64]")),
          nb::for_setter(nb::sig("def q_WB(self, q_WB: numpy.typing.ArrayLike, /) -> None")),
          "Orientation of the base, unit quaternion w, x, y, z: read-only, to be set as a whole.")
      .def_prop_rw(
          "q", [](const RobotState& s) { return read_only(nb::cast(Eigen::VectorXd(s.q))); },
          [](RobotState& s, const nb::object& q) { s.q = joint_vector(q, "q"); },
          nb::for_getter(nb::sig("def q(self) -> numpy.typing.NDArray[numpy.float64]")),
          nb::for_setter(nb::sig("def q(self, q: numpy.typing.ArrayLike, /) -> None")),
          "Joint angles, rad: read-only, to be set as a whole.")
      .def_prop_rw(
          "qd", [](const RobotState& s) { return read_only(nb::cast(Eigen::VectorXd(s.qd))); },
          [](RobotState& s, const nb::object& qd) { s.qd = joint_vector(qd, "qd"); },
          nb::for_getter(nb::sig("def qd(self) -> numpy.typing.NDArray[numpy.float64]")),
          nb::for_setter(nb::sig("def qd(self, qd: numpy.typing.ArrayLike, /) -> None")),
          "Joint velocities, rad/s: read-only, to be set as a whole.")
      .def_prop_rw(
          "qpos",
          [](const RobotState& s) {
            return numbers_of_state(7 + static_cast<std::size_t>(s.q.size()), s, &write_qpos);
          },
          [](RobotState& s, const nb::object& qpos) {
            set_numbers(s, qpos, "qpos", 7, &RobotState::q, &read_qpos);
          },
          nb::for_getter(nb::sig("def qpos(self) -> numpy.typing.NDArray[numpy.float64]")),
          nb::for_setter(nb::sig("def qpos(self, qpos: numpy.typing.ArrayLike, /) -> None")),
          "p_WB, q_WB (w, x, y, z) and q in one array, read-only, to be set as a whole: m, -, rad. MuJoCo's "
          "order, but for the "
          "joints', "
          "which is `Robot.joints`.")
      .def_prop_rw(
          "qvel",
          [](const RobotState& s) {
            return numbers_of_state(6 + static_cast<std::size_t>(s.qd.size()), s, &write_qvel);
          },
          [](RobotState& s, const nb::object& qvel) {
            set_numbers(s, qvel, "qvel", 6, &RobotState::qd, &read_qvel);
          },
          nb::for_getter(nb::sig("def qvel(self) -> numpy.typing.NDArray[numpy.float64]")),
          nb::for_setter(nb::sig("def qvel(self, qvel: numpy.typing.ArrayLike, /) -> None")),
          "v_WB, w_WB and qd in one array, read-only, to be set as a whole: m/s, rad/s. The angular velocity "
          "is in W; MuJoCo's "
          "free joint "
          "has it in the base's frame.")
      .def_prop_ro(
          "roll_pitch_yaw", [](const RobotState& s) { return roll_pitch_yaw(s.q_WB); }, "rad.")
      .def("__repr__", [](const RobotState& s) {
        return "<crossgait.State at " + std::to_string(s.time) + " s, base at (" +
               std::to_string(s.p_WB.x()) + ", " + std::to_string(s.p_WB.y()) + ", " +
               std::to_string(s.p_WB.z()) + ") m>";
      });
}

}  // namespace

void bind_world(nb::module_& m) {
  bind_state(m);
  bind_contacts(m);
  m.def("body_poses", &body_poses, nb::arg("robot"), nb::arg("state"),
        "Poses of all bodies in W as 4 x 4 matrices, by the robot's kinematics.");
  nb::class_<PhysicsBackend>(m, "World",
                             "A robot on a terrain in one engine. For one thread at a time: while one steps "
                             "it, another's call raises "
                             "RuntimeError.")
      .def(nb::new_(&make_world), nb::arg("robot"), nb::arg("terrain") = "flat", nb::arg("engine") = "",
           nb::kw_only(), nb::arg("friction") = nb::none(), nb::arg("contact") = "",
           nb::arg("physics_dt") = 1e-3, nb::arg("gravity") = nb::make_tuple(0.0, 0.0, -9.81),
           nb::arg("fixed_base") = false,
           "The robot in its home pose; robot and terrain as objects, by name or by file. `engine` \"\" is "
           "the first that is available; `friction` the Coulomb "
           "coefficient "
           "between robot and ground (None: the robot file's, or 0.6); `contact` says other settings as "
           "`--contact` does, e.g. impratio=100; times in s, gravity in m/s^2. Raises ConfigError.")
      .def_prop_ro("engine", guarded([](const PhysicsBackend& w) { return w.info().name; }))
      .def_prop_ro("physics_dt", guarded([](const PhysicsBackend& w) { return w.spec().physics_dt; }), "s.")
      .def("reset", guarded([](PhysicsBackend& w, const std::optional<RobotState>& state) {
             state ? w.reset(*state) : w.reset();
           }),
           nb::arg("state") = nb::none(),
           "Into this state; None is the home pose, over the world's origin. Raises ConfigError.")
      .def("step", guarded(&step), nb::arg("targets"), nb::arg("substeps") = 1,
           "Advances by physics steps, servos holding `targets` (rad, in the order of `Robot.servos`). "
           "Returns \"ok\", or "
           "\"diverged\", after which the state keeps its last good value until reset or restore. Raises "
           "ConfigError for "
           "targets of the wrong number or that are not finite, and changes nothing then. Ctrl-C ends it "
           "between "
           "two physics steps.")
      .def_prop_ro("state", guarded([](const PhysicsBackend& w) { return RobotState(w.state()); }))
      .def_prop_ro("torques", guarded([](const PhysicsBackend& w) { return Eigen::VectorXd(w.torques()); }),
                   "Torques of every joint in the last physics step, N m: of servo, damper and spring.")
      .def_prop_ro("servo_torques",
                   guarded([](const PhysicsBackend& w) { return Eigen::VectorXd(w.servo_torques()); }),
                   "What servos did of `torques`, N m.")
      .def_prop_ro("contacts", guarded([](const PhysicsBackend& w) {
                     return std::vector<Contact>(w.contacts().begin(), w.contacts().end());
                   }),
                   "Contact points of the last physics step.")
      .def_prop_ro("foot_contacts", guarded([](const PhysicsBackend& w) {
                     const LegArray<FootContact> feet = w.foot_contacts();
                     return std::vector<FootContact>(feet.begin(), feet.end());
                   }),
                   "Contacts of the feet FL, FR, RL, RR.")
      .def("body_pose", guarded([](const PhysicsBackend& w, const std::variant<int, std::string>& body) {
             return Eigen::Matrix4d(w.body_pose(body_of(w, body)).matrix());
           }),
           nb::arg("body"), "Pose of a body, by name or index, in W as the engine has it, 4 x 4.")
      .def("body_velocity", guarded(&body_velocity), nb::arg("body"),
           "Velocity of a body's origin (m/s) and its angular velocity (rad/s), both in W.")
      .def("jacobian", guarded(&jacobian), nb::arg("body"), nb::arg("point").none() = nb::none(),
           nb::sig("def jacobian(self, body: int | str, point: numpy.typing.ArrayLike | None = None) -> "
                   "numpy.typing.NDArray[numpy.float64]"),
           "Of a point of a body (its frame, m; None: its centre of mass), 6 x the columns of `State.qvel`: "
           "velocity "
           "of the point and angular velocity of the body, both in W, are jacobian @ qvel.")
      .def("apply_wrench", guarded(&apply_wrench), nb::arg("body"), nb::arg("force"),
           nb::arg("torque").none() = nb::none(), nb::arg("point").none() = nb::none(),
           nb::sig(
               "def apply_wrench(self, body: int | str, force: numpy.typing.ArrayLike, torque: "
               "numpy.typing.ArrayLike | None = None, point: numpy.typing.ArrayLike | None = None) -> None"),
           "Lets a force (N) and torque (N m), in W, act on a body during the next call of `step`, the force "
           "at a "
           "point of the body's frame (m; None: its centre of mass). Wrenches add up. Raises ConfigError.")
      .def("mass_matrix", guarded(&PhysicsBackend::mass_matrix),
           "Joint-space inertia with armature; rows and columns v_WB, w_WB, qd (the joints alone with a "
           "fixed base).")
      .def("terrain_height", guarded(&PhysicsBackend::terrain_height), nb::arg("x"), nb::arg("y"),
           "Height of the engine's own ground under a point, m; NaN where there is none.")
      .def("push", guarded([](PhysicsBackend& w, const ArrayLike& impulse) {
             w.apply_push(vector3(impulse, "push"));
           }),
           nb::arg("impulse"),
           "An impulse (N s, in W) at the base's centre of mass, spread over the next physics step.")
      .def("save", guarded(&save))
      .def("restore", guarded(&restore), nb::arg("snapshot"),
           "Raises ConfigError if it is of another engine, or of a world of another robot, ground, contact "
           "or time step.")
      .def("__repr__", guarded([](const PhysicsBackend& w) {
             return "<crossgait.World of " + quoted(w.robot().name) + " in " + w.info().name + " at " +
                    std::to_string(w.state().time) + " s>";
           }));
}

}  // namespace crossgait::python
