"""The forms in which interfaces of policies are published: what each says, in the fields of a contract."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from crossgait.errors import ConfigError
from crossgait.importing import terms
from crossgait.importing.contract import Contract, by_pattern
from crossgait.importing.joint_orders import joints_in_order, match_joints
from crossgait.importing.stated import Stated


@dataclass(frozen=True)
class Form:
    """A kind of file, known by keys that it has to have."""

    name: str
    keys: tuple[str, ...]
    read: Callable[[Stated, Contract, Options], None]


@dataclass(frozen=True)
class Options:
    """What the caller says beside the files."""

    joint_order: str | None = None  #: a convention's name, in the place of the form's own


def find_form(root: Stated) -> Form:
    """The form of a file's contents. Raises ConfigError listing the forms."""
    if isinstance(root.raw, dict):
        for form in FORMS:
            if all(key in root.raw for key in form.keys):
                return form
        only = next(iter(root.raw.values())) if len(root.raw) == 1 else None
        if only is not None and isinstance(only.raw, dict) and any(key in only.raw for key in RL_SAR.keys):
            return RL_SAR
    known = "; ".join(f"{form.name} ({', '.join(form.keys)})" for form in (*FORMS, RL_SAR))
    raise ConfigError(root.source, "file", f"keys of one of these forms: {known}", "others")


def _read_deploy(root: Stated, contract: Contract, options: Options) -> None:
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
        else f"{joint_map.place} (motors by convention {_order(options, 'unitree-sdk')})"
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
    _deploy_action(root.at("actions"), contract)
    _deploy_observations(root.at("observations"), contract)
    if (ranges := root.find("commands", "base_velocity", "ranges")) is not None:
        _say_command(contract, ranges)


def _order(options: Options, otherwise: str) -> str:
    return options.joint_order or otherwise


def _motors(root: Stated, contract: Contract, options: Options) -> list[str]:
    names = root.find("joint_names")
    if names is not None:
        return match_joints(names.texts(), contract.robot, names.place)
    return joints_in_order(_order(options, "unitree-sdk"), contract.robot, root.source)


def _deploy_action(actions: Stated, contract: Contract) -> None:
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


def _deploy_observations(observations: Stated, contract: Contract) -> None:
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
    terms.say_terms(contract, said)
    _say_isaac_history(contract, observations)


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


def _say_isaac_history(contract: Contract, place: Stated) -> None:
    """Isaac Lab's circular buffers: term by term, oldest first, filled with the first observation."""
    source = f"{place.place} (Isaac Lab's buffers)"
    contract.say("history.by", "term", source)
    contract.say("history.order", "oldest_first", source)
    contract.say("history.before", "first", source)


def _say_command(contract: Contract, ranges: Stated) -> None:
    """Ranges of the velocity commands that it was trained for."""
    said = {}
    for key, name in (("lin_vel_x", "vx"), ("lin_vel_y", "vy"), ("ang_vel_z", "yaw_rate"), ("ang_vel_yaw", "yaw_rate")):
        if (limits := ranges.find(key)) is not None:
            said[name] = limits.numbers(2)
    if said:
        contract.say("command.ranges", said, ranges.place)


def _read_mjlab(root: Stated, contract: Contract, options: Options) -> None:
    """Metadata that mjlab writes into ONNX files (get_base_metadata)."""
    for key in ("run_path", "command_names"):
        if (value := root.find(key)) is not None:
            value.skip()
    contract.say_named_order(_listed(root.at("joint_names")))
    for key, name in (
        ("joint_stiffness", "servos.kp"),
        ("joint_damping", "servos.kd"),
        ("default_joint_pos", "joints.home"),
        ("action_scale", "joints.scale"),
    ):
        contract.say_by_joint(name, root.find(key))
    names = _listed(root.at("observation_names"))
    if contract.is_set("observation"):
        root.skip()
        return
    count = len(names.items())
    scales, clips, histories = (
        _listed(root.find(f"observation_terms_{key}"), count) for key in ("scale", "clip", "history_length")
    )
    if (flat := root.find("observation_terms_flatten_history_dim")) is not None:
        flat.skip()
    said = []
    for i, item in enumerate(names.items()):
        block = terms.block_of(item.text(), terms.MJLAB, item)
        history = max(int(histories[i].number()), 1) if histories is not None else 1
        clip = _mjlab_clip(clips[i]) if clips is not None else None
        scale = scales[i].number() if scales is not None else 1.0
        one = terms.term(contract, block, scale, None, history)
        if clip is not None:
            one["clip_unscaled"] = clip
        said.append((one, item.place))
    terms.say_terms(contract, said)
    _say_isaac_history(contract, names)


def _listed(value: Stated | None, count: int | None = None) -> Any:
    """A list, also of one element, which metadata writes as the element."""
    if value is None:
        return None
    if not isinstance(value.raw, list):
        value = Stated([Stated(value.raw, value.source, value.line, value.path)], value.source, value.line, value.path)
    if count is None:
        return value
    if len(value.items()) != count:
        value.fail(f"{count} elements, one for each of observation_names", f"{len(value.items())}")
    return value.items()


def _mjlab_clip(value: Stated) -> float | None:
    """The limit of "-100;100"; None for "-inf;inf"."""
    low, _, high = value.text().partition(";")
    try:
        limits = float(low), float(high)
    except ValueError:
        value.fail("LOW;HIGH")
    if limits[0] != -limits[1] or not limits[1] > 0:
        value.fail("limits of the same size, -X;X")
    return None if np.isinf(limits[1]) else limits[1]


def _read_isaac_lab(root: Stated, contract: Contract, options: Options) -> None:
    """env.yaml of a run of Isaac Lab."""
    dt, decimation = root.at("sim", "dt"), root.at("decimation")
    contract.say("physics_dt", dt.number(), dt.place)
    contract.say("policy_dt", dt.number() * decimation.integer(), decimation.place)
    robot = root.at("scene", "robot")
    action = _only(root.at("actions"), "one action term")
    _isaac_order(action, contract, options)
    if (pose := robot.find("init_state", "joint_pos")) is not None:
        home = {joint: 0.0 for joint in contract.joints} | by_pattern(pose, contract.joints)
        contract.say("joints.home", home, pose.place)
    _isaac_action(action, contract)
    for actuator in robot.at("actuators").entries().values():
        _isaac_actuator(actuator, contract, dt.number())
    _isaac_observation(root, contract)
    if (ranges := root.find("commands", "base_velocity", "ranges")) is not None:
        _say_command(contract, ranges)
    if (friction := root.find("scene", "terrain", "physics_material", "static_friction")) is not None:
        contract.say("friction", friction.number(), friction.place)
    if (seconds := root.find("episode_length_s")) is not None:
        contract.say("episode_seconds", seconds.number(), seconds.place)


def _only(mapping: Stated, expected: str) -> Stated:
    entries = {key: value for key, value in mapping.entries().items() if value.raw is not None}
    if len(entries) != 1:
        mapping.fail(expected, ", ".join(entries) or "none")
    value = next(iter(entries.values()))
    value.read = True
    return value


def _class_of(value: Stated) -> str:
    """The last part of "isaaclab.envs.mdp.actions.joint_actions:JointPositionAction"."""
    return value.text().replace(":", ".").rsplit(".", 1)[-1]


def _isaac_order(action: Stated, contract: Contract, options: Options) -> None:
    names, kept = action.find("joint_names"), action.find("preserve_order")
    if names is not None and kept is not None and kept.boolean() and len(names.items()) == len(contract.robot.servos):
        contract.say_named_order(names)
        return
    contract.say_convention(_order(options, "isaac-lab"), action.place)
    if names is not None:
        _every_joint(names, contract)


def _every_joint(names: Stated, contract: Contract) -> None:
    matched = by_pattern(
        Stated({n: Stated(0.0, names.source, names.line) for n in names.texts()}, names.source, names.line),
        contract.joints,
    )
    if len(matched) != len(contract.joints):
        names.fail(f"patterns of every servo of {contract.robot.name}", ", ".join(names.texts()))


_ISAAC_ACTIONS = {
    "JointPositionAction": "position",
    "RelativeJointPositionAction": "relative",
    "JointEffortAction": "torque",
}


def _isaac_action(action: Stated, contract: Contract) -> None:
    for key in ("asset_name", "debug_vis"):
        if (value := action.find(key)) is not None:
            value.skip()
    kind = action.at("class_type")
    if _class_of(kind) not in _ISAAC_ACTIONS:
        kind.fail(f"one of {', '.join(_ISAAC_ACTIONS)}", _class_of(kind))
    contract.say("joints.command", _ISAAC_ACTIONS[_class_of(kind)], kind.place)
    contract.say_by_joint("joints.scale", action.find("scale"))
    default = action.find("use_default_offset")
    offset = action.find("offset")
    if default is not None and default.boolean():
        if offset is not None:
            offset.skip()
    elif offset is not None and contract.get("joints.command") == "position":
        contract.say_by_joint("joints.offset", offset)
    if (clip := action.find("clip")) is not None:
        for side, name in ((0, "joints.lower"), (1, "joints.upper")):
            limits = {
                key: Stated(pair.numbers(2)[side], pair.source, pair.line, pair.path)
                for key, pair in clip.entries().items()
            }
            contract.say(name, by_pattern(Stated(limits, clip.source, clip.line), contract.joints), clip.place)


_ISAAC_ACTUATORS = ("ImplicitActuator", "IdealPDActuator", "DCMotor", "DelayedPDActuator")
_SERVO_NUMBERS = (
    ("stiffness", "servos.kp"),
    ("damping", "servos.kd"),
    ("armature", "servos.armature"),
    ("friction", "servos.friction"),
)


def _isaac_actuator(actuator: Stated, contract: Contract, dt: float) -> None:
    kind = actuator.at("class_type")
    if _class_of(kind) not in _ISAAC_ACTUATORS:
        kind.fail(f"one of {', '.join(_ISAAC_ACTUATORS)}", _class_of(kind))
    names = actuator.at("joint_names_expr")
    joints = list(
        by_pattern(
            Stated({n: Stated(0.0, names.source, names.line) for n in names.texts()}, names.source, names.line),
            contract.joints,
        )
    )
    if not joints:
        names.fail(f"patterns of servos of {contract.robot.name}", ", ".join(names.texts()))
    for key, name in _SERVO_NUMBERS:
        _extend(contract, name, actuator.find(key), joints)
    implicit = _class_of(kind) == "ImplicitActuator"
    contract.say("drive", "implicit: run as an explicit servo of these gains" if implicit else "explicit", kind.place)
    effort = actuator.find("effort_limit_sim") if implicit else None
    _extend(contract, "servos.effort", effort or actuator.find("effort_limit"), joints)
    if (ignored := actuator.find("effort_limit_sim")) is not None:
        ignored.read = True
    if _class_of(kind) == "DCMotor":
        _isaac_motor(actuator, contract, joints)
    if _class_of(kind) == "DelayedPDActuator":
        least, most = actuator.at("min_delay"), actuator.at("max_delay")
        if least.integer() != most.integer():
            most.fail("a delay that does not vary, as min_delay", f"{least.integer()} to {most.integer()} steps")
        contract.say("servos.delay", {joint: most.integer() * dt for joint in joints}, most.place)


def _extend(contract: Contract, name: str, value: Stated | None, joints: list[str]) -> None:
    """Take in numbers of some joints, beside those of others that are known."""
    if value is None:
        return
    if isinstance(value.raw, dict):
        numbers = by_pattern(value, joints)
    else:
        numbers = dict(zip(joints, value.numbers(len(joints)), strict=True))
    known = contract.fields.pop(name, None)
    if known is not None and not (known.value.keys() & numbers.keys()):
        contract.say(name, known.value | numbers, f"{known.source}; {value.place}")
        return
    if known is not None:
        contract.fields[name] = known
    if numbers:
        contract.say(name, numbers, value.place)


def _isaac_motor(actuator: Stated, contract: Contract, joints: list[str]) -> None:
    """A DC motor: what its torque may be falls in a straight line from saturation to none at the velocity limit."""
    stall, speed, effort = (actuator.at(key) for key in ("saturation_effort", "velocity_limit", "effort_limit"))
    for value in (stall, speed, effort):
        if isinstance(value.raw, dict):
            value.fail("one number for all joints of the motor")
    if not stall.number() > 0:
        stall.fail("a number above 0")
    corner = speed.number() * max(0.0, 1 - effort.number() / stall.number())
    contract.say("servos.no_load_speed", {j: speed.number() for j in joints}, speed.place)
    contract.say("servos.corner_speed", {j: corner for j in joints}, stall.place)


_TERM_SETTINGS = {
    "concatenate_terms",
    "concatenate_dim",
    "enable_corruption",
    "history_length",
    "flatten_history_dim",
    "nan_policy",
    "nan_check_per_term",
}


def _isaac_observation(root: Stated, contract: Contract) -> None:
    groups = root.at("observations")
    group = groups.find("policy") or groups.find("actor")
    if group is None:
        groups.fail("a group `policy` or `actor`", ", ".join(groups.entries()))
    for name, other in groups.entries().items():
        if name not in ("policy", "actor"):
            other.skip()  # critics and others that act on nothing
    if contract.is_set("observation"):
        group.skip()
        return
    own = group.find("terms")
    items = {k: v for k, v in (own or group).entries().items() if k not in _TERM_SETTINGS and v.raw is not None}
    whole = group.find("history_length")
    for key in _TERM_SETTINGS:
        if (value := group.find(key)) is not None:
            value.skip()
    said = []
    for value in items.values():
        value.read = True
        said.append((_isaac_term(value, root, contract, whole), value.place))
    terms.say_terms(contract, said)
    _say_isaac_history(contract, group)


def _isaac_term(value: Stated, root: Stated, contract: Contract, whole: Stated | None) -> dict[str, Any]:
    func = value.at("func")
    block = terms.block_of(_class_of(func), terms.ISAAC_LAB, func)
    for key in ("noise", "flatten_history_dim"):
        if (ignored := value.find(key)) is not None:
            ignored.skip()
    if (modifiers := value.find("modifiers")) is not None:
        modifiers.fail("null: terms without modifiers")
    _isaac_params(value, block, contract)
    history = whole or value.find("history_length")
    if block == "height_scan":
        _isaac_scan(value, root, contract)
    steps = max(history.integer(), 1) if history is not None else 1
    return terms.term(contract, block, value.find("scale"), value.find("clip"), steps)


def _isaac_params(value: Stated, block: str, contract: Contract) -> None:
    asset = value.find("params", "asset_cfg")
    if asset is None:
        return
    names, kept = asset.find("joint_names"), asset.find("preserve_order")
    ordered = names is not None and isinstance(names.raw, list) and kept is not None and kept.boolean()
    if (
        ordered
        and names is not None
        and len(names.items()) == len(contract.joints)
        and match_joints(names.texts(), contract.robot, names.place) != contract.joints
    ):
        names.fail(f"the order of the action's joints: {', '.join(contract.joints)}", ", ".join(names.texts()))
    asset.skip()


def _isaac_scan(value: Stated, root: Stated, contract: Contract) -> None:
    sensor = value.find("params", "sensor_cfg", "name")
    scanner = root.at("scene", sensor.text() if sensor is not None else "height_scanner")
    pattern = scanner.at("pattern_cfg")
    spacing = pattern.at("resolution").number()
    length, width = pattern.at("size").numbers(2)
    ordering = pattern.find("ordering")
    offset = value.find("params", "offset")
    contract.say(
        "height_scan",
        {
            "x": _grid(length, spacing),
            "y": _grid(width, spacing),
            "offset": offset.number() if offset is not None else 0.5,
            "x_first": ordering is None or ordering.text() == "xy",
        },
        pattern.place,
    )


def _grid(length: float, spacing: float) -> list[float]:
    """From -length / 2 to length / 2."""
    if not spacing > 0 or not 0 <= length / spacing <= 1000:
        raise ConfigError("height_scan", "resolution", "a spacing above 0 of at most 1000 points", f"{spacing:g}")
    count = int(np.floor(length / spacing + 1e-6)) + 1
    return [round(-length / 2 + i * spacing, 9) for i in range(count)]


def _read_rl_sar(root: Stated, contract: Contract, options: Options) -> None:
    """config.yaml or base.yaml of rl_sar: one mapping under the name of robot and policy.

    Joint i of the policy is joint_names[joint_mapping[i]]; everything else goes by the policy's joints.
    """
    body = _only(root, "one robot or policy")
    for key in ("num_of_dofs", "model_name", "framework", "fixed_kp", "fixed_kd", "joint_controller_names"):
        if (value := body.find(key)) is not None:
            value.skip()
    if (wheels := body.find("wheel_indices")) is not None and wheels.items():
        wheels.fail("[]: no wheels")
    _rl_sar_order(body, contract, options)
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
    _rl_sar_clip(body, contract)
    if (observations := body.find("observations")) is not None:
        _rl_sar_observation(observations, body, contract)


def _rl_sar_order(body: Stated, contract: Contract, options: Options) -> None:
    mapping, names = body.find("joint_mapping"), body.find("joint_names")
    if names is None:
        if not contract.joints:
            order = _order(options, "unitree-sdk")
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


def _rl_sar_clip(body: Stated, contract: Contract) -> None:
    lower, upper = body.find("clip_actions_lower"), body.find("clip_actions_upper")
    if lower is None or upper is None:
        return
    limits = set(upper.numbers()) | {-number for number in lower.numbers()}
    if len(limits) != 1:
        upper.fail("one limit for all joints, the same both ways")
    contract.say("joints.limit", limits.pop(), upper.place)


def _rl_sar_observation(observations: Stated, body: Stated, contract: Contract) -> None:
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
    terms.say_terms(contract, said)


#: What legged_gym's LeggedRobotCfg says; configurations inherit from it, and rarely come with its file.
_LEGGED_GYM = {"policy_dt": 0.02, "physics_dt": 0.005}
_LEGGED_GYM_SCALES = {"lin_vel": 2.0, "ang_vel": 0.25, "dof_pos": 1.0, "dof_vel": 0.05, "height_measurements": 5.0}
_LEGGED_GYM_SOURCE = "legged_gym's LeggedRobotCfg"
_LEGGED_GYM_GRID = ([round(-0.8 + 0.1 * i, 9) for i in range(17)], [round(-0.5 + 0.1 * i, 9) for i in range(11)])


def _read_legged_gym(root: Stated, contract: Contract, options: Options) -> None:
    """A class of configuration of legged_gym or unitree_rl_gym, with compute_observations as it is there."""
    contract.say_convention(_order(options, "isaac-gym"), root.place)
    control = root.at("control")
    kind = control.find("control_type")
    if kind is not None and kind.text() not in ("P", "T"):
        kind.fail("P or T: targets of angles or torques")
    if kind is not None:
        contract.say("joints.command", {"P": "position", "T": "torque"}[kind.text()], kind.place)
    if (angles := root.find("init_state", "default_joint_angles")) is not None:
        contract.say("joints.home", by_pattern(angles, contract.joints, whole=False), angles.place)
    for key, name in (("stiffness", "servos.kp"), ("damping", "servos.kd")):
        if (value := control.find(key)) is not None:
            contract.say(name, by_pattern(value, contract.joints, whole=False), value.place)
    contract.say_by_joint("joints.scale", control.find("action_scale"))
    dt, decimation = root.find("sim", "dt"), control.find("decimation")
    physics = dt.number() if dt is not None else _LEGGED_GYM["physics_dt"]
    if dt is not None:
        contract.say("physics_dt", physics, dt.place)
    contract.assume("physics_dt", physics, _LEGGED_GYM_SOURCE)
    if decimation is not None:
        contract.say("policy_dt", physics * decimation.integer(), decimation.place)
    contract.assume("policy_dt", physics * 4, _LEGGED_GYM_SOURCE)
    normalization = root.find("normalization")
    clip = normalization.find("clip_actions") if normalization is not None else None
    if clip is not None:
        contract.say("joints.limit", clip.number(), clip.place)
    contract.assume("joints.limit", 100.0, _LEGGED_GYM_SOURCE)
    _legged_gym_observation(root, contract)
    if (ranges := root.find("commands", "ranges")) is not None:
        _say_command(contract, ranges)
    if (friction := root.find("terrain", "static_friction")) is not None:
        contract.say("friction", friction.number(), friction.place)


def _legged_gym_observation(root: Stated, contract: Contract) -> None:
    if contract.is_set("observation"):
        return
    count = root.find("env", "num_observations")
    size = count.integer() if count is not None else 235
    if size not in (48, 235):
        assert count is not None
        count.fail("48 or 235, of which legged_gym says what they are; --set observation=[...] says it of others")
    scales = root.find("normalization", "obs_scales")

    def scale(key: str) -> float:
        value = scales.find(key) if scales is not None else None
        return value.number() if value is not None else _LEGGED_GYM_SCALES[key]

    clip = root.find("normalization", "clip_observations")
    limit = clip.number() if clip is not None else 100.0
    place = f"{count.place if count is not None else root.place} (legged_gym's compute_observations)"
    linear, angular = scale("lin_vel"), scale("ang_vel")
    parts: list[tuple[str, Any]] = [
        ("base_linear_velocity_local", linear),
        ("base_angular_velocity_local", angular),
        ("gravity", 1.0),
        ("command", [linear, linear, angular]),
        ("joint_offsets", scale("dof_pos")),
        ("joint_velocities", scale("dof_vel")),
        ("last_action", 1.0),
    ]
    if size == 235:
        parts.append(("height_scan", scale("height_measurements")))
        x, y = _legged_gym_grid(root)
        contract.say("height_scan", {"x": x, "y": y, "offset": 0.5, "x_first": False}, place)
    said = []
    for block, number in parts:
        item: dict[str, Any] = {"block": block, "clip": limit}
        if number != 1.0:
            item["scale"] = number if isinstance(number, float) else terms.one_or_all(number)
        if block == "height_scan":
            item["clip_unscaled"] = 1.0
        said.append((item, place))
    terms.say_terms(contract, said)


def _legged_gym_grid(root: Stated) -> tuple[list[float], list[float]]:
    x, y = root.find("terrain", "measured_points_x"), root.find("terrain", "measured_points_y")
    return (
        x.numbers() if x is not None else _LEGGED_GYM_GRID[0],
        y.numbers() if y is not None else _LEGGED_GYM_GRID[1],
    )


FORMS = (
    Form("deploy.yaml of unitree_rl_lab", ("joint_ids_map", "step_dt", "actions", "observations"), _read_deploy),
    Form("ONNX metadata of mjlab", ("joint_names", "observation_names"), _read_mjlab),
    Form("env.yaml of Isaac Lab", ("sim", "decimation", "scene", "actions", "observations"), _read_isaac_lab),
    Form("configuration class of legged_gym", ("control",), _read_legged_gym),
)
#: One mapping under a name; known by any of these below it.
RL_SAR = Form("base.yaml or config.yaml of rl_sar", ("num_of_dofs", "rl_kp", "observations"), _read_rl_sar)
