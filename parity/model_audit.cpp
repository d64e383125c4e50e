#include "parity/model_audit.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "parity/model_probes.h"
#include "physics/core/error.h"
#include "physics/robot/actuator.h"

namespace crossgait {
namespace {

// Keeps the largest difference of one quantity, in units of what is allowed.
class Worst {
 public:
  /// @param eps  of the coarser engine's numbers
  Worst(std::string quantity, std::string unit, double eps)
      : finding_{std::move(quantity), {}, 0, 0, std::move(unit)}, eps_(eps) {}

  /// @param scale  size that a relative tolerance of 1e-6 or 1000 eps refers to
  /// @param rounding  absolute tolerance, beside 10 eps; 0: none, of what may be of any size
  void add(double a, double b, double scale, double rounding, const std::string& element) {
    compared_ = true;
    const double absolute = rounding > 0 ? rounding + 10 * eps_ : 0;
    const double allowed = std::max(std::max(1e-6, 1000 * eps_) * scale, absolute);
    const double excess = std::abs(a - b) / allowed;
    if (excess <= 1 || excess <= worst_) return;
    worst_ = excess;
    finding_.a = a;
    finding_.b = b;
    finding_.element = element;
  }
  void append_to(ModelAudit& audit) const {
    if (compared_) audit.compared.push_back(finding_.quantity);
    if (worst_ > 0) audit.findings.push_back(finding_);
  }

 private:
  AuditFinding finding_;
  double eps_;
  double worst_ = 0;
  bool compared_ = false;
};

constexpr double kRounding = 1e-11;       // of numbers of order one that went through one engine step
constexpr double kRayTolerance = 1e-5;    // m, of a ray test (Capabilities::exact_field_query)
constexpr double kForceTolerance = 1e-3;  // solvers stop at their own tolerance
constexpr double kStepTolerance = 1e-7;   // m/s and rad/s, over a step from 10 rad/s (joint stage, Newton)
// In eps. A foot's friction may be found from what it changes of a velocity: eps of 256 m/s, the fastest that
// one is slid at, beside the .6 g h = 6e-3 m/s of a step of 1 ms.
constexpr double kFrictionRoundings = 256 / 6e-3;
// In eps: of 10 rad/s, through the inverse of an inertia of a condition of a hundred.
constexpr double kStepRoundings = 1000;

std::string body_label(const PhysicsBackend& world, int body) {
  return "body " + world.robot().bodies[static_cast<std::size_t>(body)].name;
}
std::string joint_label(const PhysicsBackend& world, int joint) {
  return "joint " + world.robot().joint(joint).name;
}

void audit_time(PhysicsBackend& a, PhysicsBackend& b, ModelAudit& audit) {
  const double eps = coarser_epsilon(a.info(), b.info());
  Worst time("time step", "s", eps);
  const double ta = probes::time_of_a_step(a), tb = probes::time_of_a_step(b);
  time.add(ta, tb, std::max(ta, tb), 0, "");
  time.append_to(audit);
}

void audit_inertias(const PhysicsBackend& a, const PhysicsBackend& b, ModelAudit& audit) {
  const double eps = coarser_epsilon(a.info(), b.info());
  Worst mass("mass", "kg", eps), centre("centre of mass", "m", eps), inertia("inertia", "kg m^2", eps);
  for (int i = 0; i <= a.robot().joint_count(); ++i) {
    const SpatialInertia x = a.body_inertia(i), y = b.body_inertia(i);
    mass.add(x.mass, y.mass, x.mass, 0, body_label(a, i));
    for (int k = 0; k < 3; ++k) centre.add(x.p_BC[k], y.p_BC[k], 0.01, kRounding, body_label(a, i));
    const double size = x.I_C.diagonal().maxCoeff();
    for (int k = 0; k < 9; ++k)
      inertia.add(x.I_C(k / 3, k % 3), y.I_C(k / 3, k % 3), size, 0, body_label(a, i));
  }
  for (const Worst* w : {&mass, &centre, &inertia}) w->append_to(audit);
}

// Where bodies sit in their parents, and what turning a joint does to that.
void audit_geometry(PhysicsBackend& a, PhysicsBackend& b, ModelAudit& audit) {
  const double eps = coarser_epsilon(a.info(), b.info());
  Worst placement("link placement", "m", eps), axis("joint axis", "-", eps);
  const int joints = a.robot().joint_count();
  for (int turned = -1; turned < joints; ++turned) {
    const std::vector<Pose> x = probes::poses_with_turned(a, turned),
                            y = probes::poses_with_turned(b, turned);
    for (int i = 0; i <= joints; ++i) {
      const Pose &X = x[static_cast<std::size_t>(i)], &Y = y[static_cast<std::size_t>(i)];
      Worst& worst = turned < 0 ? placement : axis;
      const std::string element = turned < 0 ? body_label(a, i) : joint_label(a, turned);
      for (int k = 0; k < 3; ++k) worst.add(X.translation()[k], Y.translation()[k], 0.1, kRounding, element);
      for (int k = 0; k < 9; ++k)
        worst.add(X.linear()(k / 3, k % 3), Y.linear()(k / 3, k % 3), 1, 0, element);
    }
  }
  placement.append_to(audit);
  axis.append_to(audit);
}

void audit_armature(PhysicsBackend& a, PhysicsBackend& b, ModelAudit& audit) {
  const double eps = coarser_epsilon(a.info(), b.info());
  Worst armature("armature", "kg m^2", eps);
  const Eigen::VectorXd x = probes::joint_inertias(a), y = probes::joint_inertias(b);
  for (int i = 0; i < x.size(); ++i) armature.add(x[i], y[i], x[i], 0, joint_label(a, i));
  armature.append_to(audit);
}

void audit_joint_friction(const PhysicsBackend& a, const PhysicsBackend& b, ModelAudit& audit) {
  const double eps = coarser_epsilon(a.info(), b.info());
  Worst friction("joint friction", "N m", eps);
  const JointVector x = a.joint_friction(), y = b.joint_friction();
  for (Eigen::Index i = 0; i < x.size(); ++i)
    friction.add(x[i], y[i], x[i], kRounding, joint_label(a, static_cast<int>(i)));
  friction.append_to(audit);
}

void audit_joint_limits(const PhysicsBackend& a, const PhysicsBackend& b, ModelAudit& audit) {
  // An engine without them declares it (Laws::joint_limits), and its model is not wrong for that.
  if (a.info().laws.joint_limits.empty() || b.info().laws.joint_limits.empty()) return;
  Worst limits("joint limit", "rad", coarser_epsilon(a.info(), b.info()));
  const JointRanges x = a.joint_limits(), y = b.joint_limits();
  const auto compare = [&](double of_a, double of_b, int joint) {
    if (of_a == of_b) return;  // both may be none
    constexpr double kNone = 1e3;
    limits.add(std::clamp(of_a, -kNone, kNone), std::clamp(of_b, -kNone, kNone), 1, kRounding,
               joint_label(a, joint));
  };
  for (int i = 0; i < x.lower.size(); ++i) {
    compare(x.lower[i], y.lower[i], i);
    compare(x.upper[i], y.upper[i], i);
  }
  limits.append_to(audit);
}

// Whether joints with dry friction are meant to move alike.
bool same_joint_friction(const PhysicsBackend& a, const PhysicsBackend& b) {
  const bool any = a.robot().has_joint_friction() || b.robot().has_joint_friction();
  return !any || a.info().laws.joint_friction == b.info().laws.joint_friction;
}

bool same_loops(const PhysicsBackend& a, const PhysicsBackend& b) {
  return a.robot().loops.empty() || a.info().laws.loops == b.info().laws.loops;
}

bool same_servos(const PhysicsBackend& a, const PhysicsBackend& b) {
  const std::vector<int> servos = a.robot().actuated_joints();
  return a.info().laws.implicit_servos == b.info().laws.implicit_servos ||
         std::none_of(servos.begin(), servos.end(), [&](int i) { return is_implicit(a.robot().joint(i)); });
}

bool same_couplings(const PhysicsBackend& a, const PhysicsBackend& b) {
  return a.robot().couplings.empty() || a.info().laws.couplings == b.info().laws.couplings;
}

void audit_ground(const PhysicsBackend& a, const PhysicsBackend& b, ModelAudit& audit) {
  const double eps = coarser_epsilon(a.info(), b.info());
  Worst heights("height of the ground", "m", eps), diagonal("diagonal of the height field", "m", eps);
  const HeightField* field = a.spec().terrain.field();
  const auto compare = [&](Worst& worst, double x, double y) {
    const double height_a = a.terrain_height(x, y), height_b = b.terrain_height(x, y);
    if (std::isnan(height_a) && std::isnan(height_b)) return;
    worst.add(std::isnan(height_a) ? 1e3 : height_a, std::isnan(height_b) ? 1e3 : height_b, 0, kRayTolerance,
              fmt::format("({:.4g}, {:.4g}) m", x, y));
  };
  if (field == nullptr) {
    for (const double x : {-0.5, 0.0, 0.7}) compare(heights, x, 0.3 * x);
  } else {
    constexpr int kMost = 40;  // cells looked at along each side
    const int skip_c = std::max(1, field->columns() / kMost), skip_r = std::max(1, field->rows() / kMost);
    for (int r = 1; r + 2 < field->rows(); r += skip_r) {
      for (int c = 1; c + 2 < field->columns(); c += skip_c) {
        const double x = c * field->cell_x() - field->size_x() / 2;
        const double y = r * field->cell_y() - field->size_y() / 2;
        compare(heights, x, y);
        // In the middle of a cell stands the mean of whichever diagonal it is split along.
        compare(diagonal, x + field->cell_x() / 2, y + field->cell_y() / 2);
      }
    }
  }
  heights.append_to(audit);
  diagonal.append_to(audit);
}

void audit_gravity(PhysicsBackend& a, PhysicsBackend& b, ModelAudit& audit) {
  const double eps = coarser_epsilon(a.info(), b.info());
  Worst gravity("gravity", "m/s^2", eps);
  const Vector3 x = probes::free_fall(a), y = probes::free_fall(b);
  constexpr std::array kAxes{"axis x", "axis y", "axis z"};
  for (int k = 0; k < 3; ++k) gravity.add(x[k], y[k], 10, 1e-7, kAxes[static_cast<std::size_t>(k)]);
  gravity.append_to(audit);
}

void audit_servos(PhysicsBackend& a, PhysicsBackend& b, ModelAudit& audit) {
  const double eps = coarser_epsilon(a.info(), b.info());
  Worst damping("joint damping", "N m s/rad", eps), stiffness("servo stiffness", "N m/rad", eps),
      effort("effort limit", "N m", eps), servo("servo damping", "N m s/rad", eps);
  for (int i = 0; i < a.robot().joint_count(); ++i) {
    const probes::ServoResponse x = probes::servo_response(a, i), y = probes::servo_response(b, i);
    const auto add = [&](Worst& worst, double probes::ServoResponse::*what) {
      worst.add(x.*what, y.*what, std::abs(x.*what), kRounding, joint_label(a, i));
    };
    add(damping, &probes::ServoResponse::joint_damping);
    add(stiffness, &probes::ServoResponse::stiffness);
    add(effort, &probes::ServoResponse::effort_limit);
    add(servo, &probes::ServoResponse::servo_damping);
  }
  for (const Worst* w : {&damping, &stiffness, &effort, &servo}) w->append_to(audit);
}

// Force ratios of sliding feet. A foot that one step stops, or slows as its law would have it, has no more
// friction than that takes, whatever the coefficient: a light foot under rigid contact, a heavy one under
// soft. So a foot counts where it slips on in both worlds and has the same ratio at four times the speed.
void audit_friction(PhysicsBackend& a, PhysicsBackend& b, ModelAudit& audit) {
  constexpr double kSlips = 0.05;                             // m/s, after the step
  constexpr std::array kSpeeds{1.0, 4.0, 16.0, 64.0, 256.0};  // m/s
  using Feet = LegArray<probes::PressedFoot>;
  std::array<Feet, kSpeeds.size()> x, y;
  for (std::size_t i = 0; i < kSpeeds.size(); ++i) {
    const RobotState sliding = probes::pressed(a, kSpeeds[i]);
    x[i] = probes::press_feet(a, sliding);
    y[i] = probes::press_feet(b, sliding);
  }
  const double eps = coarser_epsilon(a.info(), b.info());
  const auto tolerance = [eps](double ratio) {
    return std::max(kForceTolerance, kFrictionRoundings * eps) * std::max(0.1, ratio);
  };
  const auto limited = [&](const Feet& slower, const Feet& faster, Leg leg) {
    const double ratio = slower[leg].friction_ratio;
    return slower[leg].slip_after > kSlips && std::abs(faster[leg].friction_ratio - ratio) < tolerance(ratio);
  };
  Worst friction("friction", "-", eps);
  for (const Leg leg : kLegs) {
    for (std::size_t i = 0; i + 1 < kSpeeds.size(); ++i) {
      if (!limited(x[i], x[i + 1], leg) || !limited(y[i], y[i + 1], leg)) continue;
      const double ratio = x[i][leg].friction_ratio;
      friction.add(ratio, y[i][leg].friction_ratio, 0, tolerance(ratio), fmt::format("foot {}", name(leg)));
      break;
    }
  }
  friction.append_to(audit);
}

void audit_feet(PhysicsBackend& a, PhysicsBackend& b, ModelAudit& audit) {
  if (!a.robot().legs) return;
  const double eps = coarser_epsilon(a.info(), b.info());
  Worst radius("foot radius", "m", eps), law("contact law", "N", eps);
  const RobotState standing = probes::pressed(a, 0);
  const LegArray<probes::PressedFoot> x = probes::press_feet(a, standing),
                                      y = probes::press_feet(b, standing);
  const bool one_law = a.info().laws.contact == b.info().laws.contact && same_joint_friction(a, b);
  for (const Leg leg : kLegs) {
    const std::string element = fmt::format("foot {}", name(leg));
    radius.add(x[leg].depth, y[leg].depth, 0.01, 1e-9, element);
    if (one_law)
      law.add(x[leg].normal_force, y[leg].normal_force, 0, kForceTolerance * x[leg].normal_force, element);
  }
  radius.append_to(audit);
  audit_friction(a, b, audit);
  law.append_to(audit);
}

// Every body from several sides: which of its points come first to the ground, and how far out they are.
void audit_shapes(PhysicsBackend& a, PhysicsBackend& b, ModelAudit& audit) {
  const double eps = coarser_epsilon(a.info(), b.info());
  Worst depth("collision shape", "m", eps), points("contact points", "-", eps);
  // Six sides and two corners, none of them level: no two points are equally deep by symmetry.
  constexpr std::array<std::array<double, 3>, 8> kAttitudes{{{0.13, 0.29, 0.4},
                                                             {3.02, 0.31, 1.1},
                                                             {1.71, 0.17, -0.5},
                                                             {-1.39, 0.23, 2.2},
                                                             {0.21, 1.37, 0.7},
                                                             {0.37, -1.33, -1.6},
                                                             {0.83, 0.61, 0.3},
                                                             {-2.35, 0.57, -0.9}}};
  for (const auto& [roll, pitch, yaw] : kAttitudes) {
    for (int body = 0; body <= a.robot().joint_count(); ++body) {
      const auto state = probes::body_pressed(a, body, from_roll_pitch_yaw(roll, pitch, yaw));
      if (!state) continue;
      const auto x = probes::press_body(a, *state, body), y = probes::press_body(b, *state, body);
      if (!x || !y) continue;
      depth.add(x->depth, y->depth, 0, 1e-9, body_label(a, body));
      points.add(x->points, y->points, 0, 0.5, body_label(a, body));
    }
  }
  depth.append_to(audit);
  points.append_to(audit);
}

void audit_motion(PhysicsBackend& a, PhysicsBackend& b, ModelAudit& audit) {
  if (!same_joint_friction(a, b) || !same_loops(a, b) || !same_couplings(a, b) || !same_servos(a, b)) return;
  const double eps = coarser_epsilon(a.info(), b.info());
  Worst motion("motion in the air", "m/s or rad/s", eps);
  const RobotState state = probes::swinging(a);
  const Eigen::VectorXd x = probes::swing(a, state), y = probes::swing(b, state);
  for (int i = 0; i < x.size(); ++i)
    motion.add(x[i], y[i], 0, kStepTolerance + kStepRoundings * eps,
               i < 6 ? body_label(a, 0) : joint_label(a, i - 6));
  motion.append_to(audit);
}

}  // namespace

const std::vector<std::string>& audited_quantities() {
  static const std::vector<std::string> kQuantities{"time step",
                                                    "mass",
                                                    "centre of mass",
                                                    "inertia",
                                                    "link placement",
                                                    "joint axis",
                                                    "armature",
                                                    "joint friction",
                                                    "joint limit",
                                                    "height of the ground",
                                                    "diagonal of the height field",
                                                    "gravity",
                                                    "joint damping",
                                                    "servo stiffness",
                                                    "effort limit",
                                                    "servo damping",
                                                    "foot radius",
                                                    "friction",
                                                    "contact law",
                                                    "collision shape",
                                                    "contact points",
                                                    "motion in the air"};
  return kQuantities;
}

ModelAudit audit_models(PhysicsBackend& a, PhysicsBackend& b) {
  if (a.robot().bodies.size() != b.robot().bodies.size()) {
    throw ConfigError("model audit", "robots", fmt::format("{} bodies in both", a.robot().bodies.size()),
                      fmt::format("{}", b.robot().bodies.size()));
  }
  ModelAudit audit;
  audit_time(a, b, audit);
  audit_inertias(a, b, audit);
  audit_geometry(a, b, audit);
  audit_armature(a, b, audit);
  audit_joint_friction(a, b, audit);
  audit_joint_limits(a, b, audit);
  audit_ground(a, b, audit);
  audit_gravity(a, b, audit);
  audit_servos(a, b, audit);
  audit_feet(a, b, audit);
  audit_shapes(a, b, audit);
  audit_motion(a, b, audit);
  a.reset();
  b.reset();
  return audit;
}

std::string describe(const std::vector<AuditFinding>& findings) {
  std::string text;
  for (const AuditFinding& f : findings) {
    text += fmt::format("{}{}{}{}: {:.6g} against {:.6g}{}{}", text.empty() ? "" : "; ", f.quantity,
                        f.element.empty() ? "" : ", ", f.element, f.a, f.b, f.unit == "-" ? "" : " ",
                        f.unit == "-" ? "" : f.unit);
  }
  return text;
}

std::string describe(const ModelAudit& audit) {
  std::vector<std::string> others;
  for (const std::string& quantity : audited_quantities()) {
    if (std::find(audit.compared.begin(), audit.compared.end(), quantity) == audit.compared.end())
      others.push_back(quantity);
  }
  const std::string text = audit.findings.empty()
                               ? fmt::format("the same in {}", fmt::join(audit.compared, ", "))
                               : describe(audit.findings);
  return others.empty() ? text : fmt::format("{} (not compared: {})", text, fmt::join(others, ", "));
}

}  // namespace crossgait
