#include "diagnosis/candidate_fields.h"

#include <array>

#include "diagnosis/fields/fields.h"

namespace crossgait {
namespace {

constexpr bool kPhysics = true, kContract = false;

constexpr std::array kRows{
    FieldRow{"joints.order", "which joint each number of action and observation is", kContract, 10,
             fields::joint_order},
    FieldRow{"joints.observed",
             "which joint each number of the observation is, in another order than the action's", kContract,
             10, fields::joints_observed},
    FieldRow{"joints.signs", "which way joints turn", kContract, 2, fields::joint_signs},
    FieldRow{"joints.home", "default pose", kContract, 4, fields::joint_home},
    FieldRow{"joints.offset", "targets of the zero action", kContract, 4, fields::joint_offset},
    FieldRow{"joints.scale", "of actions", kContract, 4, fields::joint_scale},
    FieldRow{"joints.command", "what an action says", kContract, 4, fields::joint_command},
    FieldRow{"joints.limit", "clips of actions and targets", kContract, 2, fields::joint_limits},
    FieldRow{"joints.filter", "low pass of targets", kContract, 3, fields::joint_filter},
    FieldRow{"joints.delay", "from action to targets", kContract, 3, fields::joint_delay},
    FieldRow{"observation", "order of the terms", kContract, 4, fields::observation_order},
    FieldRow{"observation.BLOCK", "frame, zero, order of a quaternion, raw or processed", kContract, 8,
             fields::observation_blocks_taken},
    FieldRow{"observation.BLOCK.scale", "of a term", kContract, 4, fields::observation_scales},
    FieldRow{"observation.BLOCK.sign", "of a term", kContract, 2, fields::observation_signs},
    FieldRow{"observation.BLOCK.clip", "clip and noise of a term", kContract, 2, fields::observation_limits},
    FieldRow{"observation.delay", "age of what is seen", kContract, 3, fields::observation_delay},
    FieldRow{"history", "layout, and what was before the episode", kContract, 4, fields::history},
    FieldRow{"policy_dt", "rates of policy and physics", kContract, 6, fields::rates},
    FieldRow{"servos.kp", "gains, and the law: explicit, damping, drive", kContract, 7, fields::servo_gains},
    FieldRow{"servos.effort", "torque limit", kContract, 2, fields::servo_effort},
    FieldRow{"servos.armature", "armature, damping, dry friction", kContract, 5, fields::joint_losses},
    FieldRow{"servos.delay", "what drives fall short of", kContract, 3, fields::drives},
    FieldRow{"friction", "of the ground", kContract, 6, fields::ground_friction},
    FieldRow{"contact", "softness, cone, impratio", kPhysics, 6, fields::contact_law},
    FieldRow{"engine", "another engine or contact law", kPhysics, 6, fields::engine},
};

}  // namespace

std::span<const FieldRow> field_rows() { return kRows; }

EnvConfig with_joints_resolved(const EnvModel& model) {
  EnvConfig config = model.config;
  const EnvConfig resolved = model.resolved();
  config.joints.order = resolved.joints.order;
  config.joints.home = resolved.joints.home;
  config.joints.scale = resolved.joints.scale;
  return config;
}

}  // namespace crossgait
