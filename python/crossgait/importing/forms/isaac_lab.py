"""env.yaml of a run of Isaac Lab."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import numpy as np

from crossgait.errors import ConfigError
from crossgait.importing import terms
from crossgait.importing.actuator import Actuator, find_file
from crossgait.importing.contract import Contract, by_pattern
from crossgait.importing.forms.shared import Options, order_of_joints, say_command, say_isaac_history
from crossgait.importing.joint_orders import joints_in_order
from crossgait.importing.stated import Stated


def read(root: Stated, contract: Contract, options: Options) -> None:
    """env.yaml of a run of Isaac Lab."""
    dt, decimation = root.at("sim", "dt"), root.at("decimation")
    contract.say("physics_dt", dt.number(), dt.place)
    contract.say("policy_dt", dt.number() * decimation.integer(), decimation.place)
    robot = root.at("scene", "robot")
    actions = [value for value in root.at("actions").entries().values() if value.raw is not None]
    if not actions:
        root.at("actions").fail("an action term", "none")
    moved = _order(actions, contract, options)
    if (pose := robot.find("init_state", "joint_pos")) is not None:
        home = {joint: 0.0 for joint in contract.joints} | by_pattern(pose, contract.joints)
        contract.say("joints.home", home, pose.place)
    for action, joints in moved:
        _action(action, contract, joints)
    _one_command(contract)
    for actuator in robot.at("actuators").entries().values():
        _actuator(actuator, contract, dt.number(), options)
    _observe_joints(root, contract, options)
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


def _order(actions: list[Stated], contract: Contract, options: Options) -> list[tuple[Stated, list[str]]]:
    """Every action term with the joints that it moves; all of them, in that order, are the action."""
    convention = order_of_joints(options, "isaac-lab")
    listed = joints_in_order(convention, contract.robot, actions[0].place)
    moved: list[tuple[Stated, list[str]]] = []
    order: list[str] = []
    for action in actions:
        action.read = True
        names, kept = action.find("joint_names"), action.find("preserve_order")
        joints = listed if names is None else _joints_of(names, listed, kept is not None and kept.boolean(), contract)
        if (twice := set(joints) & set(order)) and names is not None:
            names.fail("joints that no other action term moves", ", ".join(sorted(twice)))
        moved.append((action, joints))
        order += joints
    if sorted(order) != sorted(listed):
        expected = f"action terms of every servo of {contract.robot.name}"
        actions[-1].fail(expected, f"none of {', '.join(sorted(set(listed) - set(order)))}")
    place = actions[0].place if order != listed else f"{actions[0].place} (convention {convention})"
    contract.say_order(order, place)
    return moved


def _joints_of(names: Stated, listed: list[str], kept: bool, contract: Contract) -> list[str]:
    """Joints by names or patterns of them, in the order of `listed` or, if it is kept, of the names."""
    texts = names.texts() if isinstance(names.raw, list) else [names.text()]
    short = {joint.removesuffix("_joint"): joint for joint in listed}
    found: list[str] = []
    for text in texts:
        exact = short.get(text.removesuffix("_joint"))
        try:
            matches = [exact] if exact else [joint for joint in listed if re.fullmatch(text, joint)]
        except re.error as error:
            names.fail("regular expressions of joints' names", f"{text} ({error})")
        if not matches:
            names.fail(f"patterns of joints of {contract.robot.name}", text)
        found += [joint for joint in matches if joint not in found]
    return found if kept else [joint for joint in listed if joint in found]


_ACTIONS = {
    "JointPositionAction": "position",
    "RelativeJointPositionAction": "relative",
    "JointEffortAction": "torque",
    "JointVelocityAction": "velocity",
}


def _action(action: Stated, contract: Contract, joints: list[str]) -> None:
    for key in ("asset_name", "debug_vis"):
        if (value := action.find(key)) is not None:
            value.skip()
    kind = action.at("class_type")
    if _class_of(kind) not in _ACTIONS:
        kind.fail(f"one of {', '.join(_ACTIONS)}", _class_of(kind))
    command = _ACTIONS[_class_of(kind)]
    _say_some(contract, "joints.command", {joint: command for joint in joints}, kind.place)
    scale = action.find("scale")
    if scale is None:
        _say_some(contract, "joints.scale", {joint: 1.0 for joint in joints}, f"{kind.place} (its default)")
    _extend(contract, "joints.scale", scale, joints)
    default = action.find("use_default_offset")
    offset = action.find("offset")
    if default is not None and default.boolean():
        if offset is not None:
            offset.skip()
    elif offset is not None and command == "position":
        _extend(contract, "joints.offset", offset, joints)
    elif offset is not None and any(numbers := offset.numbers(len(joints))):
        offset.fail(f"0, of a {command}", ", ".join(f"{n:g}" for n in numbers))
    if (clip := action.find("clip")) is not None:
        for side, name in ((0, "joints.lower"), (1, "joints.upper")):
            limits = {
                key: Stated(pair.numbers(2)[side], pair.source, pair.line, pair.path)
                for key, pair in clip.entries().items()
            }
            _extend(contract, name, Stated(limits, clip.source, clip.line), joints)


def _one_command(contract: Contract) -> None:
    """One word where all joints are commanded alike."""
    field = contract.fields["joints.command"]
    if isinstance(field.value, dict) and len(set(field.value.values())) == 1:
        contract.fields["joints.command"] = replace(field, value=next(iter(field.value.values())))


_NETWORKS = ("ActuatorNetMLP", "ActuatorNetLSTM")
_ACTUATORS = ("ImplicitActuator", "IdealPDActuator", "DCMotor", "DelayedPDActuator", *_NETWORKS)


_SERVO_NUMBERS = (
    ("stiffness", "servos.kp"),
    ("damping", "servos.kd"),
    ("armature", "servos.armature"),
    ("friction", "servos.friction"),
)


def _actuator(actuator: Stated, contract: Contract, dt: float, options: Options) -> None:
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
    if _class_of(kind) in _NETWORKS:
        if len(joints) != len(contract.joints):
            names.fail("every servo: one network for all", ", ".join(names.texts()))
        contract.say_actuator(_network(actuator, _class_of(kind), dt, options))
    implicit = _class_of(kind) == "ImplicitActuator"
    for name in ("servos.implicit_stiffness", "servos.implicit_damping"):
        # PhysX solves the drives of an ImplicitActuator; the others compute torques of a step's beginning.
        _say_some(contract, name, dict.fromkeys(joints, 1.0 if implicit else 0.0), kind.place)
    effort = actuator.find("effort_limit_sim") if implicit else None
    _extend(contract, "servos.effort", effort or actuator.find("effort_limit"), joints)
    if (ignored := actuator.find("effort_limit_sim")) is not None:
        ignored.read = True
    if _class_of(kind) in ("DCMotor", *_NETWORKS):
        _motor(actuator, contract, joints)
    if _class_of(kind) == "DelayedPDActuator":
        least, most = actuator.at("min_delay"), actuator.at("max_delay")
        if least.integer() != most.integer():
            most.fail("a delay that does not vary, as min_delay", f"{least.integer()} to {most.integer()} steps")
        contract.say("servos.delay", {joint: most.integer() * dt for joint in joints}, most.place)


def _network(actuator: Stated, kind: str, dt: float, options: Options) -> Actuator:
    file = actuator.at("network_file")
    found = find_file(file.text(), options.folders, file.place)
    if kind == "ActuatorNetLSTM":
        return Actuator(found, file.place, remembers=True, physics_dt=dt)
    order = actuator.at("input_order")
    if order.text() not in ("pos_vel", "vel_pos"):
        order.fail("pos_vel or vel_pos")
    return Actuator(
        found,
        file.place,
        remembers=False,
        physics_dt=dt,
        instants=tuple(item.integer() for item in actuator.at("input_idx").items()),
        velocity_first=order.text() == "vel_pos",
        error_scale=actuator.at("pos_scale").number(),
        velocity_scale=actuator.at("vel_scale").number(),
        torque_scale=actuator.at("torque_scale").number(),
    )


def _say_some(contract: Contract, name: str, values: dict[str, Any], source: str) -> None:
    """Say what holds for some joints, beside what is known of others."""
    known = contract.fields.get(name)
    if known is not None and not contract.is_set(name) and not known.value.keys() & values.keys():
        contract.fields[name] = replace(known, value=known.value | values, source=f"{known.source}; {source}")
    else:
        contract.say(name, values, source)


def _extend(contract: Contract, name: str, value: Stated | None, joints: list[str]) -> None:
    """Take in numbers of some joints, beside those of others that are known."""
    if value is None:
        return
    if isinstance(value.raw, dict):
        numbers = by_pattern(value, joints)
    else:
        numbers = dict(zip(joints, value.numbers(len(joints)), strict=True))
    if numbers:
        _say_some(contract, name, numbers, value.place)


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
    items = _policy_terms(root)
    whole = group.find("history_length")
    for key in _TERM_SETTINGS:
        if (value := group.find(key)) is not None:
            value.skip()
    said = []
    for value in items.values():
        value.read = True
        said.append((_term(value, root, contract, whole), value.place))
    terms.say_terms(contract, said, group)
    say_isaac_history(contract, group)


def _term(value: Stated, root: Stated, contract: Contract, whole: Stated | None) -> dict[str, Any]:
    func = value.at("func")
    block = terms.block_of(_class_of(func), terms.ISAAC_LAB, func)
    for key in ("noise", "flatten_history_dim"):
        if (ignored := value.find(key)) is not None:
            ignored.skip()
    if (modifiers := value.find("modifiers")) is not None:
        modifiers.fail("null: terms without modifiers")
    if (asset := value.find("params", "asset_cfg")) is not None:
        asset.skip()
    history = whole or value.find("history_length")
    if block == "height_scan":
        _scan(value, root, contract)
    steps = max(history.integer(), 1) if history is not None else 1
    return terms.term(contract, block, value.find("scale"), value.find("clip"), steps)


_OF_JOINTS = ("joint_offsets", "joint_positions", "joint_velocities")


def _observe_joints(root: Stated, contract: Contract, options: Options) -> None:
    """The joints that terms show, in their order: the articulation's, unless a term keeps one of its own."""
    listed = joints_in_order(order_of_joints(options, "isaac-lab"), contract.robot, root.place)
    every = listed + [joint for joint in contract.robot.joints if joint not in listed]
    for value in _policy_terms(root).values():
        func, asset = value.find("func"), value.find("params", "asset_cfg")
        if func is None or terms.ISAAC_LAB.get(_class_of(func)) not in _OF_JOINTS:
            continue
        names = asset.find("joint_names") if asset is not None else None
        kept = asset.find("preserve_order") if asset is not None else None
        if names is None or names.raw is None:
            contract.say("joints.observed", listed, f"{value.place} (of the articulation)")
        else:
            joints = _joints_of(names, every, kept is not None and kept.boolean(), contract)
            contract.say("joints.observed", joints, names.place)


def _policy_terms(root: Stated) -> dict[str, Stated]:
    groups = root.at("observations")
    group = groups.find("policy") or groups.find("actor")
    if group is None:
        groups.fail("a group `policy` or `actor`", ", ".join(groups.entries()))
    own = group.find("terms")
    return {k: v for k, v in (own or group).entries().items() if k not in _TERM_SETTINGS and v.raw is not None}


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
