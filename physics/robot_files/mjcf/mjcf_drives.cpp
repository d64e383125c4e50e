#include "physics/robot_files/mjcf/mjcf_drives.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Cholesky>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "physics/core/error.h"
#include "physics/robot/multibody.h"

namespace crossgait {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Torques or angles from one to the other; all there are unless something bounds them.
struct Bounds {
  double low = -kInfinity, high = kInfinity;
  std::vector<std::string> by;  ///< what bounds them, for people

  bool bounded() const { return std::isfinite(low) || std::isfinite(high); }
  /// @param scale  of the range's unit, of either sign
  void narrow(const MjcfRange& range, double scale, std::string what) {
    const double a = std::min(range[0] * scale, range[1] * scale);
    const double b = std::max(range[0] * scale, range[1] * scale);
    low = std::max(low, a), high = std::min(high, b);
    by.push_back(fmt::format("{} ({:g} to {:g})", what, a, b));
  }
};

std::string range_text(const Bounds& bounds) { return fmt::format("{:g} to {:g}", bounds.low, bounds.high); }

class Driver {
 public:
  Driver(const std::vector<MjcfActuator>& actuators, const MjcfModel& model, ParsedRobot& robot,
         ReaderWarnings& warnings)
      : model_(model), robot_(robot), warnings_(warnings) {
    for (const MjcfActuator& actuator : actuators) {
      all_of_joint_[actuator.joint].push_back(&actuator);
      if (actuator.kind == MjcfActuatorKind::kOther || actuator.bias[1] > 0) {
        warnings.count("ignored the force of ",
                       fmt::format(" <{}>, neither motor nor servo of a joint", actuator.tag),
                       actuator.place + actuator.numbers);
      } else {
        of_joint_[actuator.joint].push_back(&actuator);
      }
    }
  }

  void drive(const MjcfJointForces& forces) {
    for (Body& body : robot_.bodies) {
      const auto all = all_of_joint_.find(body.joint.name);
      if (all == all_of_joint_.end()) continue;
      for (const MjcfActuator* actuator : all->second) add_mechanics(*actuator, body.joint);
    }
    const Eigen::VectorXd inertias = reflected_inertias();
    for (std::size_t i = 1; i < robot_.bodies.size(); ++i) {
      Joint& joint = robot_.bodies[i].joint;
      for (const MjcfActuator* actuator : actuators_of(joint))
        add_servo(*actuator, inertias[static_cast<Eigen::Index>(i) - 1], joint);
      warn_of_unlike_filters(joint);
      set_effort(forces, joint);
      set_targets(joint);
    }
  }

 private:
  const std::vector<const MjcfActuator*>& actuators_of(const Joint& joint) const {
    static const std::vector<const MjcfActuator*> kNone;
    const auto found = of_joint_.find(joint.name);
    return found == of_joint_.end() ? kNone : found->second;
  }

  static void add_mechanics(const MjcfActuator& actuator, Joint& joint) {
    const double g2 = actuator.gear * actuator.gear;
    joint.armature += g2 * actuator.armature;
    joint.damping += g2 * actuator.damping;
  }

  /// What every joint moves, everything else free, at the angles at which the file has the bodies: the
  /// inverse of the diagonal of the inverse inertia (MuJoCo's dof_invweight0).
  Eigen::VectorXd reflected_inertias() const {
    RobotDescription robot;
    robot.bodies = robot_.bodies;
    RobotState state;
    state.q = JointVector::Zero(robot.joint_count());
    for (int i = 0; i < robot.joint_count(); ++i) state.q[i] = joint_of_file(robot.joint(i)).reference;
    const bool floats = std::any_of(model_.joints.begin(), model_.joints.end(), [](const MjcfJoint& joint) {
      return joint.type == MjcfJointType::kFree;
    });
    const Eigen::Index size = robot.joint_count() + (floats ? 6 : 0);
    const Eigen::LLT<Eigen::MatrixXd> M(mass_matrix(robot, state).bottomRightCorner(size, size));
    return M.solve(Eigen::MatrixXd::Identity(size, size)).diagonal().tail(robot.joint_count()).cwiseInverse();
  }

  const MjcfJoint& joint_of_file(const Joint& joint) const {
    return *std::find_if(model_.joints.begin(), model_.joints.end(),
                         [&](const MjcfJoint& j) { return j.name == joint.name; });
  }

  /// @param inertia  of the joint, kg m^2
  void add_servo(const MjcfActuator& a, double inertia, Joint& joint) {
    if (a.kind == MjcfActuatorKind::kMotor) {
      if (a.lag > 0 || a.delay > 0)
        warnings_.count(
            fmt::format("did not keep the lag of {:g} s and the delay of {:g} s of ", a.lag, a.delay),
            " motor(s): a servo's target has them, a torque has not", a.place);
      return;
    }
    const double g2 = a.gear * a.gear, kp = -a.bias[1] * g2;
    joint.kp += kp;
    if (a.bias[2] <= 0) {
      joint.kd -= a.bias[2] * g2;
    } else if (a.gain == -a.bias[1]) {
      const double kd = 2 * a.bias[2] * std::sqrt(kp * inertia);
      joint.kd += kd;
      robot_.reasons[joint.name]["kd"] =
          fmt::format("2 x {:g} sqrt(kp M), M = {:.4g} kg m^2 at the file's zero", a.bias[2], inertia);
    } else {
      warnings_.count(fmt::format("took {:g} for 0 as the damping (-biasprm[2]) of ", -a.bias[2]),
                      " actuator(s): it would drive what it damps", a.place);
    }
    take_law(joint);
    if (a.bias[0] != 0)
      warnings_.count(fmt::format("took {:g} for 0 as the constant force (biasprm[0]) of ", a.bias[0]),
                      " actuator(s)", a.place);
    if (!a.is_position()) return;
    const double per_control = a.gear == 0 ? 1 : a.gain / -a.bias[1] / a.gear;
    if (std::abs(per_control - 1) > 1e-9)
      warnings_.count(
          fmt::format(
              "takes targets for angles, which are {:.4g} times the controls (gain over kp and gear) of ",
              per_control),
          " actuator(s)", a.place);
    joint.lag = std::max(joint.lag, a.lag);
    joint.delay = std::max(joint.delay, a.delay);
  }

  void warn_of_unlike_filters(const Joint& joint) {
    const auto& actuators = actuators_of(joint);
    const bool unlike = std::ranges::any_of(actuators, [&joint](const MjcfActuator* a) {
      return a->is_position() && (a->lag != joint.lag || a->delay != joint.delay);
    });
    if (unlike)
      warnings_.list(" joint(s) have several servos, all of which get the lag and delay of one: ",
                     fmt::format("'{}' {:g} s and {:g} s", joint.name, joint.lag, joint.delay));
  }

  /// MuJoCo's implicit integrators take what actuators do by velocity at a step's end (mjd_actuator_vel).
  void take_law(Joint& joint) {
    const std::string integrator = robot_.contact.integrator.value_or("");
    if (!integrator.starts_with("implicit") || !(joint.kd > 0)) return;
    joint.implicit_damping = 1;
    robot_.reasons[joint.name]["implicit_damping"] = fmt::format("the file's integrator, {}", integrator);
  }

  Bounds torques_of(const MjcfActuator& a) const {
    Bounds bounds;
    if (a.force) bounds.narrow(*a.force, a.gear, "gear x forcerange");
    if (a.kind == MjcfActuatorKind::kMotor) {
      if (a.control) bounds.narrow(*a.control, a.gear * a.gain, "gear x gain x ctrlrange");
      if (a.lag > 0 && a.activation) bounds.narrow(*a.activation, a.gear * a.gain, "gear x gain x actrange");
    }
    return bounds;
  }

  void set_effort(const MjcfJointForces& forces, Joint& joint) {
    const auto& actuators = actuators_of(joint);
    Bounds sum;
    std::size_t unlimited = 0;
    bool free_servo = false;
    for (const MjcfActuator* actuator : actuators) {
      Bounds own = torques_of(*actuator);
      if (!own.bounded()) {
        // What a servo may add without a limit has none; a motor that nothing commands adds nothing.
        if (actuator->kind == MjcfActuatorKind::kServo) free_servo = true;
        ++unlimited;
        continue;
      }
      if (sum.bounded()) {
        sum.low += own.low, sum.high += own.high;
      } else {
        sum.low = own.low, sum.high = own.high;
      }
      sum.by.insert(sum.by.end(), own.by.begin(), own.by.end());
    }
    if (free_servo) sum = {};
    if (unlimited > 0 && sum.bounded())
      warnings_.list(
          fmt::format(" joint(s) have limited and unlimited actuators, and keep the limits ({} N m): ",
                      range_text(sum)),
          fmt::format("'{}'", joint.name));
    if (const auto own = forces.find(joint.name); own != forces.end())
      sum.narrow(own->second, 1, "actuatorfrcrange");
    if (!sum.bounded()) return;
    double positive = sum.high, negative = -sum.low;
    if (!(positive > 0) || !(negative > 0)) {
      const double both = std::max(positive, negative);
      warnings_.list(
          fmt::format(" joint(s) with torques from {} N m, taken for +-{:g} N m: ", range_text(sum), both),
          fmt::format("'{}'", joint.name));
      positive = negative = both;
    }
    if (!(positive > 0)) return;
    joint.effort_limit = positive;
    joint.effort_negative = negative == positive ? 0 : negative;
    robot_.reasons[joint.name]["effort"] = fmt::format("{}, N m", fmt::join(sum.by, ", "));
  }

  /// In the unit of the control, before the gear.
  std::optional<MjcfRange> control_of(const MjcfActuator& a, const Joint& joint) {
    if (a.inherit <= 0 || !a.control_limited) return a.control;
    const MjcfJoint& source = joint_of_file(joint);
    if (!(source.lower < source.upper)) {
      warnings_.count("ignored ", " inheritrange of joints without a range", a.place);
      return a.control;
    }
    const double middle = (source.lower + source.upper) / 2;
    const double half = (source.upper - source.lower) / 2 * a.inherit;
    return MjcfRange{middle - half, middle + half};
  }

  void set_targets(Joint& joint) {
    Bounds targets;
    for (const MjcfActuator* a : actuators_of(joint)) {
      if (!a->is_position() || a->gear == 0) continue;
      // gain control = -bias[1] length where there is no force.
      const double scale = a->gain / -a->bias[1] / a->gear;
      if (const auto control = control_of(*a, joint))
        targets.narrow(*control, scale, a->inherit > 0 ? "inheritrange of the joint's range" : "ctrlrange");
      if (a->lag > 0 && a->activation) targets.narrow(*a->activation, scale, "actrange");
    }
    if (!targets.bounded() || !(targets.low <= targets.high)) return;
    joint.target_lower = targets.low, joint.target_upper = targets.high;
    robot_.reasons[joint.name]["target_range"] =
        fmt::format("targets are clipped to the {}, rad", fmt::join(targets.by, ", "));
  }

  const MjcfModel& model_;
  ParsedRobot& robot_;
  ReaderWarnings& warnings_;
  std::map<std::string, std::vector<const MjcfActuator*>> of_joint_, all_of_joint_;  ///< that drive it; all
};

/// Lists joints as they and their actuators stand in the file.
void list_orders(const std::vector<MjcfActuator>& actuators, const MjcfModel& model, ParsedRobot& robot) {
  std::vector<std::string>& listed = robot.actuator_order;
  for (const MjcfActuator& a : actuators) {
    if (std::find(listed.begin(), listed.end(), a.joint) == listed.end()) listed.push_back(a.joint);
  }
  for (const MjcfJoint& joint : model.joints) robot.joint_order.push_back(joint.name);
}

}  // namespace

void drive_joints(const std::vector<MjcfActuator>& actuators, const MjcfJointForces& forces,
                  const MjcfModel& model, const std::string& path, ParsedRobot& robot,
                  ReaderWarnings& warnings) {
  for (const MjcfActuator& actuator : actuators) {
    const bool known = std::any_of(model.joints.begin(), model.joints.end(),
                                   [&](const MjcfJoint& joint) { return joint.name == actuator.joint; });
    if (!known)
      throw ConfigError(path, actuator.place, "a joint of the file", fmt::format("'{}'", actuator.joint));
  }
  Driver(actuators, model, robot, warnings).drive(forces);
  list_orders(actuators, model, robot);
}

}  // namespace crossgait
