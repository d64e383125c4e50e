#include "backends/contact/law_factors.h"

namespace crossgait::contact {

const std::vector<FactorRow<LawFactors>>& law_factor_rows() {
  using F = LawFactors;
  // Nobody ships half of a decision: each is a factor, and both together are its group.
  const std::string friction = "friction law", rigid = "rigid contact";
  static const std::vector<FactorRow<F>> kRows{
      {{"surface", "contact forces act on the robot's surface, not midway", {}}, &F::surface},
      {{"coulomb",
        "friction bounded by the normal force, not by MuJoCo's convex cone",
        {},
        nullptr,
        friction},
       &F::coulomb},
      {{"hard_friction", "friction stops slip at once, not like a damper", {}, nullptr, friction},
       &F::hard_friction},
      {{"hard_normal", "penetration stops at once, not like a spring and damper", {}, nullptr, rigid},
       &F::hard_normal},
      // A spring at a point that does not touch would push or pull through the air.
      {{"speculative", "points just above the ground count", {"hard_normal"}, nullptr, rigid},
       &F::speculative},
      {{"hard_joint_friction",
        "dry friction stops a joint at once, not like a damper",
        {},
        [](const RobotDescription& robot) { return robot.has_joint_friction(); }},
       &F::hard_joint_friction},
      {{"hard_joint_limits",
        "limits stop a joint at once, not like a spring and damper",
        {},
        [](const RobotDescription& robot) { return robot.has_joint_limits(); }},
       &F::hard_joint_limits},
  };
  return kRows;
}

std::string law_name(const LawFactors& factors) {
  std::string name = "mujoco";
  bool hard = true;
  for (const FactorRow<LawFactors>& row : law_factor_rows()) {
    if (row.member == &LawFactors::hard_joint_friction || row.member == &LawFactors::hard_joint_limits)
      continue;
    hard &= factors.*row.member;
    if (factors.*row.member) name += "+" + row.factor.name;
  }
  if (factors.stock) return "dart";
  if (factors.pyramid) return "hard+pyramid";
  return hard ? "hard" : name;
}

bool is_solved_by_minimum(const LawFactors& factors) {
  return !factors.hard_normal && !factors.hard_friction && !factors.coulomb && !factors.hard_joint_friction &&
         !factors.hard_joint_limits;
}

bool has_error_reduction(const LawFactors& factors) { return factors.hard_normal && !factors.stock; }

HardContact hard_contact(const ContactSpec& contact, const LawFactors& factors) {
  if (factors.stock) return {.error_reduction = 0.01, .most_push_out = 1e-3, .mixing = 1e-5};
  return {contact.erp, contact.max_depenetration_velocity, factors.hard_normal ? contact.cfm : 0.0};
}

std::string family_name(const LawFactors& factors) { return factors.hard_normal ? "rigid" : "compliant"; }

std::vector<std::string> own_parts() {
  return {"contact solver", "loop closures and coupled joints",
          "armature, damping and dry friction of joints"};
}

}  // namespace crossgait::contact
