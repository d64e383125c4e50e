#include "python/bindings/behaviour.h"

#include <utility>

#include <fmt/format.h>
#include <nanobind/eigen/dense.h>
#include <nanobind/stl/string.h>

#include "motion/standing.h"
#include "physics/core/error.h"
#include "python/bindings/arrays.h"
#include "python/bindings/inputs.h"
#include "python/bindings/shown.h"

namespace crossgait::python {
namespace {

// What a function in Python returned, as numbers. To be called with the interpreter's lock held.
Eigen::MatrixXd numbers(const nb::object& returned, const std::string& name, Eigen::Index rows,
                        Eigen::Index columns) {
  const auto expected = columns == 1 ? fmt::format("{} numbers", rows)
                                     : fmt::format("an array of {} x {} numbers", rows, columns);
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> values;
  try {
    const auto array = numbers_of(returned);
    const std::size_t second = array.ndim() == 2 ? array.shape(1) : 1;
    if (array.ndim() != (columns == 1 ? 1 : 2) || array.shape(0) != static_cast<std::size_t>(rows) ||
        second != static_cast<std::size_t>(columns))
      throw ConfigError(name, "targets", expected, shown(returned));
    values = Eigen::Map<const decltype(values)>(array.data(), rows, columns);
  } catch (const ConfigError&) {
    throw ConfigError(name, "targets", expected, shown(returned));
  }
  if (!values.allFinite()) throw ConfigError(name, "targets", "finite numbers", shown(returned));
  return values;
}

// One run's function, and the state that it is to be called with.
class PythonFunction {
 public:
  PythonFunction(const PythonController& behaviour, const RobotDescription& robot)
      : name_(behaviour.name), function_(make(behaviour)) {
    state_.q = robot.home;
    state_.qd = JointVector::Zero(robot.joint_count());
  }

  void observe(const RobotState& state) { state_ = state; }
  Eigen::MatrixXd operator()(Eigen::Index rows, Eigen::Index columns) const {
    const nb::gil_scoped_acquire acquire;
    return numbers(function_.get()(state_), name_, rows, columns);
  }

 private:
  static SharedObject make(const PythonController& behaviour) {
    const nb::gil_scoped_acquire acquire;
    SharedObject function(behaviour.make.get()());
    if (PyCallable_Check(function.get().ptr()) == 0)
      throw ConfigError(behaviour.name, "make", "a function that returns a function",
                        type_called(function.get()));
    return function;
  }

  std::string name_;
  SharedObject function_;
  RobotState state_;
};

// Servo angles from Python.
class JointFunction final : public Controller {
 public:
  JointFunction(const PythonController& behaviour, std::shared_ptr<const RobotDescription> robot)
      : robot_(std::move(robot)),
        function_(behaviour, *robot_),
        servos_(robot_->actuated_joints()),
        command_(behaviour.walk.gait.command) {}

  RobotState initial_state(const Terrain& terrain, const Placement& placement) const override {
    return standing_on(terrain, placement, *robot_, robot_->home);
  }
  void hold_pose(double /*dt*/, ControlTargets& out) override { out.joints.q = robot_->home(servos_); }
  void advance(double /*dt*/, ControlTargets& out) override {
    out.joints.q = function_(static_cast<Eigen::Index>(servos_.size()), 1);
    out.velocity = command_;
  }
  void observe(const RobotState& state, double /*dt*/) override { function_.observe(state); }

 private:
  std::shared_ptr<const RobotDescription> robot_;
  PythonFunction function_;
  std::vector<int> servos_;
  std::optional<VelocityCommand> command_;
};

// Feet from Python, on Crossgait's legs.
class FeetFunction final : public Controller {
 public:
  FeetFunction(const PythonController& behaviour, const WorldSpec& world)
      : function_(std::make_shared<PythonFunction>(behaviour, *world.robot)),
        legs_(make_feet_controller(
            [function = function_](double) {
              const Eigen::MatrixXd rows = (*function)(kLegCount, 3);
              LegArray<Vector3> positions;
              for (const Leg leg : kLegs) positions[leg] = rows.row(static_cast<Eigen::Index>(index(leg)));
              return positions;
            },
            world, behaviour.walk.compensation ? ServoCompensation{} : ServoCompensation::none())),
        command_(behaviour.walk.gait.command) {}

  RobotState initial_state(const Terrain& terrain, const Placement& placement) const override {
    return legs_->initial_state(terrain, placement);
  }
  void hold_pose(double dt, ControlTargets& out) override { legs_->hold_pose(dt, out); }
  void advance(double dt, ControlTargets& out) override {
    legs_->advance(dt, out);
    out.velocity = command_;
  }
  void observe(const RobotState& state, double /*dt*/) override { function_->observe(state); }

 private:
  std::shared_ptr<PythonFunction> function_;
  ControllerPtr legs_;
  std::optional<VelocityCommand> command_;
};

Targets targets_of(const std::string& text) {
  if (text == "joints") return Targets::kJoints;
  if (text == "feet") return Targets::kFeet;
  throw ConfigError("behaviour", "targets", "joints or feet", text);
}

}  // namespace

SharedObject::SharedObject(nb::object object)
    : object_(new nb::object(std::move(object)), [](const nb::object* held) {
        const nb::gil_scoped_acquire acquire;
        delete held;
      }) {}

WalkSetup PythonController::setup() const {
  return {name,
          [*this](const WorldSpec& world) -> ControllerPtr {
            if (targets == Targets::kJoints) return std::make_shared<JointFunction>(*this, world.robot);
            return std::make_shared<FeetFunction>(*this, world);
          },
          walk.timing, walk.terminations};
}

const WalkConfig& config_of(const Subject& subject) {
  const auto* behaviour = std::get_if<PythonController>(&subject);
  return behaviour != nullptr ? behaviour->walk : std::get<PythonWalk>(subject);
}

WalkSetup setup_of(const Subject& subject) {
  return std::visit([](const auto& s) { return s.setup(); }, subject);
}

void bind_behaviour(nb::module_& m) {
  nb::class_<PythonController>(
      m, "Controller", nb::type_slots(kHolderSlots<PythonController>),
      "A controller of your own: what `walk`, `compare` and `verdict` take beside gaits.")
      .def(
          "__init__",
          [](PythonController* self, const nb::callable& make, const PythonWalk& walk,
             const std::string& targets, const std::string& name) {
            check_maker(make, "Controller", "a State");
            new (self) PythonController{walk, name, targets_of(targets), SharedObject(make)};
          },
          nb::arg("make"), nb::arg("walk") = PythonWalk(), nb::kw_only(), nb::arg("targets") = "joints",
          nb::arg("name") = "behaviour",
          nb::sig("def __init__(self, make: collections.abc.Callable[[], collections.abc.Callable[[State], "
                  "numpy.typing.ArrayLike]], walk: Walk = ..., *, targets: str = 'joints', name: str = "
                  "'behaviour') "
                  "-> None"),
          "`make` returns a fresh controller for every run: a function of the `State` at the beginning of a "
          "control "
          "step that returns targets for it; what it remembers is its own. With targets=\"joints\" those are "
          "servo "
          "angles in rad in the order of `Robot.servos`, and the robot begins in its home pose; with "
          "\"feet\" they are "
          "4 x 3 foot centres (FL, FR, RL, RR) in the leg frames (x forward, y left, z up), m, and the robot "
          "begins with "
          "its feet where the first call, of the home pose, says. `walk` says robot, ground, friction, time "
          "steps and "
          "how long; its command, if it has one, is what progress and heading are judged by. The same "
          "controller must "
          "return the same targets for the same states: verdicts repeat runs.")
      .def_ro("name", &PythonController::name)
      .def_ro("walk", &PythonController::walk)
      .def("__repr__", [](nb::handle self) {
        const auto& c = nb::cast<const PythonController&>(self);
        return fmt::format("<crossgait.Controller {}: {}, {}>", quoted(c.name),
                           c.targets == Targets::kJoints ? "joints" : "feet", shown(self.attr("walk")));
      });
}

}  // namespace crossgait::python
