"""unitree_rl_lab's deploy.yaml."""

from __future__ import annotations

from typing import Any

from crossgait.importing import terms
from crossgait.importing.contract import Contract
from crossgait.importing.forms.shared import Options, order_of_joints, say_command, say_isaac_history
from crossgait.importing.joint_orders import joints_in_order, match_joints
from crossgait.importing.stated import Stated


def read(root: Stated, contract: Contract, options: Options) -> None:
    """unitree_rl_lab's deploy.yaml.

    joint_ids_map[i] is the motor of the policy's joint i; stiffness and damping go by motor, all else by the policy's
    joints (its exporter, export_deploy_cfg).
    """
    motors = _motors(root, contract, options)
    joint_map = root.at("joint_ids_map")
    indices = [item.integer() for item in joint_map.items()]
    if sorted(indices) != list(range(len(motors))):
        joint_map.fail(f"each of 0 to {len(motors) - 1} once", ", ".join(map(str, indices)))
    names = root.find("joint_names")
    source = (
        joint_map.place
        if names is not None
        else f"{joint_map.place} (motors by convention {order_of_joints(options, 'unitree-sdk')})"
    )
    contract.say_order([motors[i] for i in indices], source)
    contract.say("policy_dt", root.at("step_dt").number(), root.at("step_dt").place)
    if (dt := root.find("physics_dt")) is not None:
        contract.say("physics_dt", dt.number(), dt.place)
    for key, name in (
        ("stiffness", "servos.kp"),
        ("damping", "servos.kd"),
        ("armature", "servos.armature"),
        ("effort_limit", "servos.effort"),
    ):
        contract.say_by_joint(name, root.find(key), motors)
    contract.say_by_joint("joints.home", root.find("default_joint_pos"))
    _action(root.at("actions"), contract)
    _observations(root.at("observations"), contract)
    if (ranges := root.find("commands", "base_velocity", "ranges")) is not None:
        say_command(contract, ranges)


def _motors(root: Stated, contract: Contract, options: Options) -> list[str]:
    names = root.find("joint_names")
    if names is not None:
        return match_joints(names.texts(), contract.robot, names.place)
    return joints_in_order(order_of_joints(options, "unitree-sdk"), contract.robot, root.source)


def _action(actions: Stated, contract: Contract) -> None:
    entries = actions.entries()
    if list(entries) != ["JointPositionAction"]:
        actions.fail("JointPositionAction alone", ", ".join(entries))
    action = actions.at("JointPositionAction")
    contract.say("joints.command", "position", action.place)
    if (ids := action.find("joint_ids")) is not None:
        ids.fail("null: every joint, in the policy's order")
    if (names := action.find("joint_names")) is not None and names.texts() != [".*"]:
        names.fail('[".*"]: every joint')
    contract.say_by_joint("joints.scale", action.find("scale"))
    contract.say_by_joint("joints.offset", action.find("offset"))
    if (clip := action.find("clip")) is not None:
        _say_target_clip(contract, clip)


def _say_target_clip(contract: Contract, clip: Stated) -> None:
    """Limits of targets, [low, high] of every joint."""
    limits = [item.numbers(2) for item in clip.items()]
    if len(limits) != len(contract.joints):
        clip.fail(f"{len(contract.joints)} pairs", f"{len(limits)}")
    for side, name in ((0, "joints.lower"), (1, "joints.upper")):
        contract.say(name, {j: pair[side] for j, pair in zip(contract.joints, limits, strict=True)}, clip.place)


def _observations(observations: Stated, contract: Contract) -> None:
    if contract.is_set("observation"):
        observations.skip()
        return
    said = []
    for name, value in observations.entries().items():
        if name == "gait_phase":
            said += _phase(value, contract)
            continue
        block = terms.block_of(name, terms.ISAAC_LAB, value)
        if (params := value.find("params")) is not None:
            params.skip()
        if block == "height_scan":
            value.fail("terms without a grid, which deploy.yaml does not describe", name)
        history = value.find("history_length")
        item = terms.term(
            contract,
            block,
            value.find("scale"),
            value.find("clip"),
            max(history.integer(), 1) if history is not None else 1,
        )
        said.append((item, value.place))
    terms.say_terms(contract, said, observations)
    say_isaac_history(contract, observations)


def _phase(value: Stated, contract: Contract) -> list[tuple[dict[str, Any], str]]:
    """Sine and cosine of a clock of one period."""
    period = value.at("params", "period")
    contract.say("clock", {"frequency": 1 / period.number(), "phases": [0.0]}, period.place)
    history = value.find("history_length")
    if history is not None and history.integer() > 1:
        history.fail("1: a clock without history")
    clip, scale = value.find("clip"), value.find("scale")
    scales = scale.numbers(2) if scale is not None else [1.0, 1.0]
    return [
        (terms.term(contract, block, number, clip), value.place)
        for block, number in zip(("clock_sin", "clock_cos"), scales, strict=True)
    ]
