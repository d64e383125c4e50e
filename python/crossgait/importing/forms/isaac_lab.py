"""env.yaml of a run of Isaac Lab."""

from __future__ import annotations

from typing import Any

import numpy as np

from crossgait.errors import ConfigError
from crossgait.importing import terms
from crossgait.importing.contract import Contract, by_pattern
from crossgait.importing.forms.shared import Options, only, order_of_joints, say_command, say_isaac_history
from crossgait.importing.joint_orders import match_joints
from crossgait.importing.stated import Stated


def read(root: Stated, contract: Contract, options: Options) -> None:
    """env.yaml of a run of Isaac Lab."""
    dt, decimation = root.at("sim", "dt"), root.at("decimation")
    contract.say("physics_dt", dt.number(), dt.place)
    contract.say("policy_dt", dt.number() * decimation.integer(), decimation.place)
    robot = root.at("scene", "robot")
    action = only(root.at("actions"), "one action term")
    _order(action, contract, options)
    if (pose := robot.find("init_state", "joint_pos")) is not None:
        home = {joint: 0.0 for joint in contract.joints} | by_pattern(pose, contract.joints)
        contract.say("joints.home", home, pose.place)
    _action(action, contract)
    for actuator in robot.at("actuators").entries().values():
        _actuator(actuator, contract, dt.number())
    _observation(root, contract)
    if (ranges := root.find("commands", "base_velocity", "ranges")) is not None:
        say_command(contract, ranges)
    if (friction := root.find("scene", "terrain", "physics_material", "static_friction")) is not None:
        contract.say("friction", friction.number(), friction.place)
    if (seconds := root.find("episode_length_s")) is not None:
        contract.say("episode_seconds", seconds.number(), seconds.place)


def _class_of(value: Stated) -> str:
    """The last part of "isaaclab.envs.mdp.actions.joint_actions:JointPositionAction"."""
    return value.text().replace(":", ".").rsplit(".", 1)[-1]


def _order(action: Stated, contract: Contract, options: Options) -> None:
    names, kept = action.find("joint_names"), action.find("preserve_order")
    if names is not None and kept is not None and kept.boolean() and len(names.items()) == len(contract.robot.servos):
        contract.say_named_order(names)
        return
    contract.say_convention(order_of_joints(options, "isaac-lab"), action.place)
    if names is not None:
        _every_joint(names, contract)


def _every_joint(names: Stated, contract: Contract) -> None:
    matched = by_pattern(
        Stated({n: Stated(0.0, names.source, names.line) for n in names.texts()}, names.source, names.line),
        contract.joints,
    )
    if len(matched) != len(contract.joints):
        names.fail(f"patterns of every servo of {contract.robot.name}", ", ".join(names.texts()))


_ACTIONS = {
    "JointPositionAction": "position",
    "RelativeJointPositionAction": "relative",
    "JointEffortAction": "torque",
}


def _action(action: Stated, contract: Contract) -> None:
    for key in ("asset_name", "debug_vis"):
        if (value := action.find(key)) is not None:
            value.skip()
    kind = action.at("class_type")
    if _class_of(kind) not in _ACTIONS:
        kind.fail(f"one of {', '.join(_ACTIONS)}", _class_of(kind))
    contract.say("joints.command", _ACTIONS[_class_of(kind)], kind.place)
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


_ACTUATORS = ("ImplicitActuator", "IdealPDActuator", "DCMotor", "DelayedPDActuator")


_SERVO_NUMBERS = (
    ("stiffness", "servos.kp"),
    ("damping", "servos.kd"),
    ("armature", "servos.armature"),
    ("friction", "servos.friction"),
)


def _actuator(actuator: Stated, contract: Contract, dt: float) -> None:
    kind = actuator.at("class_type")
    if _class_of(kind) not in _ACTUATORS:
        kind.fail(f"one of {', '.join(_ACTUATORS)}", _class_of(kind))
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
        _motor(actuator, contract, joints)
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


def _motor(actuator: Stated, contract: Contract, joints: list[str]) -> None:
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


def _observation(root: Stated, contract: Contract) -> None:
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
        said.append((_term(value, root, contract, whole), value.place))
    terms.say_terms(contract, said)
    say_isaac_history(contract, group)


def _term(value: Stated, root: Stated, contract: Contract, whole: Stated | None) -> dict[str, Any]:
    func = value.at("func")
    block = terms.block_of(_class_of(func), terms.ISAAC_LAB, func)
    for key in ("noise", "flatten_history_dim"):
        if (ignored := value.find(key)) is not None:
            ignored.skip()
    if (modifiers := value.find("modifiers")) is not None:
        modifiers.fail("null: terms without modifiers")
    _params(value, block, contract)
    history = whole or value.find("history_length")
    if block == "height_scan":
        _scan(value, root, contract)
    steps = max(history.integer(), 1) if history is not None else 1
    return terms.term(contract, block, value.find("scale"), value.find("clip"), steps)


def _params(value: Stated, block: str, contract: Contract) -> None:
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


def _scan(value: Stated, root: Stated, contract: Contract) -> None:
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
