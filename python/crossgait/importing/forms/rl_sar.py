"""base.yaml and config.yaml of rl_sar."""

from __future__ import annotations

from crossgait.importing import terms
from crossgait.importing.contract import Contract
from crossgait.importing.forms.shared import Options, only, order_of_joints
from crossgait.importing.joint_orders import joints_in_order, match_joints
from crossgait.importing.stated import Stated


def read(root: Stated, contract: Contract, options: Options) -> None:
    """config.yaml or base.yaml of rl_sar: one mapping under the name of robot and policy.

    Joint i of the policy is joint_names[joint_mapping[i]]; everything else goes by the policy's joints.
    """
    body = only(root, "one robot or policy")
    for key in ("num_of_dofs", "model_name", "framework", "fixed_kp", "fixed_kd", "joint_controller_names"):
        if (value := body.find(key)) is not None:
            value.skip()
    if (wheels := body.find("wheel_indices")) is not None and wheels.items():
        wheels.fail("[]: no wheels")
    _order(body, contract, options)
    dt, decimation = body.find("dt"), body.find("decimation")
    if dt is not None and decimation is not None:
        contract.say("physics_dt", dt.number(), dt.place)
        contract.say("policy_dt", dt.number() * decimation.integer(), decimation.place)
    for key, name in (
        ("rl_kp", "servos.kp"),
        ("rl_kd", "servos.kd"),
        ("torque_limits", "servos.effort"),
        ("default_dof_pos", "joints.home"),
        ("action_scale", "joints.scale"),
    ):
        contract.say_by_joint(name, body.find(key))
    _clip(body, contract)
    if (observations := body.find("observations")) is not None:
        _observation(observations, body, contract)


def _order(body: Stated, contract: Contract, options: Options) -> None:
    mapping, names = body.find("joint_mapping"), body.find("joint_names")
    if names is None:
        if not contract.joints:
            order = order_of_joints(options, "unitree-sdk")
            contract.say("joints.motors", order, f"convention {order}")
            motors = joints_in_order(order, contract.robot, body.place)
        else:
            motors = contract.get("joints.listed", contract.joints)
    else:
        motors = match_joints(names.texts(), contract.robot, names.place)
        contract.say("joints.listed", motors, names.place)
    if mapping is None:
        if not contract.joints:
            contract.say_order(motors, names.place if names is not None else body.place)
        return
    indices = [item.integer() for item in mapping.items()]
    if sorted(indices) != list(range(len(motors))):
        mapping.fail(f"each of 0 to {len(motors) - 1} once", ", ".join(map(str, indices)))
    # A policy's own file comes on top of the robot's.
    contract.fields.pop("joints.order", None)
    contract.say_order([motors[i] for i in indices], mapping.place)


def _clip(body: Stated, contract: Contract) -> None:
    lower, upper = body.find("clip_actions_lower"), body.find("clip_actions_upper")
    if lower is None or upper is None:
        return
    limits = set(upper.numbers()) | {-number for number in lower.numbers()}
    if len(limits) != 1:
        upper.fail("one limit for all joints, the same both ways")
    contract.say("joints.limit", limits.pop(), upper.place)


def _observation(observations: Stated, body: Stated, contract: Contract) -> None:
    if contract.is_set("observation"):
        body.skip()
        return
    history = body.find("observations_history")
    steps = [item.integer() for item in history.items()] if history is not None else []
    if history is not None and steps and sorted(steps) != list(range(len(steps))):
        history.fail("each of the last instants once: 0, 1, ...", ", ".join(map(str, steps)))
    if history is not None and steps:
        order = {tuple(sorted(steps)): "newest_first", tuple(sorted(steps, reverse=True)): "oldest_first"}.get(
            tuple(steps)
        )
        if order is None:
            history.fail("instants in one order", ", ".join(map(str, steps)))
        contract.say("history.order", order, history.place)
        contract.say("history.before", "zeros", f"{history.place} (rl_sar's buffer begins empty)")
    if (priority := body.find("observations_history_priority")) is not None and steps:
        by = {"time": "frame", "term": "term"}.get(priority.text())
        if by is None:
            priority.fail("time or term")
        contract.say("history.by", by, priority.place)
    elif steps:
        contract.assume("history.by", "frame", "default (rl_sar's, before there was a choice)")
    clip = body.find("clip_obs")
    scales = {
        "base_linear_velocity_local": "lin_vel_scale",
        "base_angular_velocity_local": "ang_vel_scale",
        "base_angular_velocity": "ang_vel_scale",
        "command": "commands_scale",
        "joint_offsets": "dof_pos_scale",
        "joint_velocities": "dof_vel_scale",
    }
    said = []
    for item in observations.items():
        block = terms.block_of(item.text(), terms.RL_SAR, item)
        scale = body.find(scales[block]) if block in scales else None
        one = terms.term(contract, block, scale, None, max(len(steps), 1))
        if clip is not None:
            one["clip"] = clip.number()
        said.append((one, item.place))
    for key in (*scales.values(), "num_observations"):
        if (value := body.find(key)) is not None:
            value.skip()
    terms.say_terms(contract, said, observations)
