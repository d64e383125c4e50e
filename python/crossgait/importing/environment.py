"""The environment of a contract, and what nobody said of it."""

from __future__ import annotations

import math
import os
from typing import Any

from crossgait.importing.contract import Contract, Field
from crossgait.sweep.strict_yaml import write_yaml

#: Beyond what any action reaches, where nobody says where it is clipped.
_NO_LIMIT = 100.0
#: Of the ground in all simulators that publish policies, where nobody says another.
_FRICTION = 1.0
#: By which a target is found at which a servo's law gives a torque, N m/rad: 100 N m within 0.1 rad.
_GIVING_STIFFNESS = 1000.0
_IMPLICIT = ("implicit_stiffness", "implicit_damping")
SERVOS = ("kp", "kd", "effort", *_IMPLICIT, "armature", "friction", "corner_speed", "no_load_speed", "delay")


def make_environment(contract: Contract, robot: str) -> dict[str, Any]:
    """The environment's configuration, as its YAML has it.

    Fields that nobody stated are taken from the robot or by default, and listed as such in the contract.
    """
    policy_dt = contract.assume("policy_dt", 0.02)
    physics_dt = contract.assume("physics_dt", 0.002 if _divides(0.002, policy_dt) else policy_dt / 10)
    contract.assume("joints.order", contract.joints, "robot")
    contract.assume("joints.home", _home_of(contract), "robot")
    contract.assume("joints.command", "position")
    contract.assume("joints.scale", {joint: 1.0 for joint in contract.joints})
    contract.assume("joints.limit", _NO_LIMIT)
    for number in ("kp", "kd", "effort", "armature", "friction"):
        contract.assume(f"servos.{number}", "the robot's own", "robot")
    _let_servos_give_torques(contract)
    contract.assume("friction", _FRICTION, "default (of Isaac Gym, Isaac Lab and MuJoCo)")
    environment: dict[str, Any] = {
        "robot": os.path.abspath(robot) if os.path.exists(robot) else robot,
        "action": "joints",
        "joints": _joints(contract),
        "servos": {
            key: one_or_each(value, len(contract.joints))
            for key in SERVOS
            if isinstance(value := contract.get(f"servos.{key}"), dict)
            and (key not in _IMPLICIT or any(value.values()))
        },
        "friction": contract.get("friction"),
        "command": _command(contract),
        "observation": _observation(contract),
        "physics_dt": physics_dt,
        "control_dt": physics_dt,
        "policy_dt": policy_dt,
    }
    history = {key: contract.get(f"history.{key}") for key in ("by", "order", "before")}
    if any("history" in item for item in environment["observation"] if isinstance(item, dict)):
        environment["history"] = {key: value for key, value in history.items() if value is not None}
    start = {key.partition(".")[2]: f.value for key, f in contract.fields.items() if key.startswith("start.")}
    if start:
        environment["start"] = start
    if start or "joints.actuator" in contract.fields:
        # Nothing settles in the air, nor holds a robot whose servos' stiffness is not a servo's.
        environment["settle_seconds"] = 0.0
    for key in ("clock", "height_scan", "constants", "episode_seconds"):
        if (value := contract.get(key)) is not None:
            environment[key] = value
    return environment


def _let_servos_give_torques(contract: Contract) -> None:
    """A stiffness by which servos are made to give torques, where nobody states one or it is 0."""
    commands = contract.get("joints.command")
    of = commands if isinstance(commands, dict) else {joint: commands for joint in contract.joints}
    given = [j for j in contract.joints if of.get(j) in ("torque", "velocity") or "joints.actuator" in contract.fields]
    for key in _IMPLICIT:
        law = contract.fields.get(f"servos.{key}")
        if law is not None and any(law.value.get(joint) for joint in given):
            value = law.value | dict.fromkeys(given, 0.0)
            source = f"{law.source}; 0 where a servo is made to give torques"
            contract.fields[law.name] = Field(law.name, value, source)
    stated = contract.fields["servos.kp"]
    numbers = stated.value if isinstance(stated.value, dict) else {}
    lacking = [j for j in given if not numbers.get(j, 0.0 if "joints.actuator" in contract.fields else 1.0) > 0]
    if lacking:
        source = f"{stated.source}; {_GIVING_STIFFNESS:g} where a servo is made to give torques"
        value = numbers | {joint: _GIVING_STIFFNESS for joint in lacking}
        contract.fields["servos.kp"] = Field("servos.kp", value, source)


def to_text(environment: dict[str, Any]) -> str:
    """As YAML."""
    return write_yaml(environment)


def _divides(shorter: float, longer: float) -> bool:
    return math.isclose(round(longer / shorter) * shorter, longer, rel_tol=1e-9)


def _home_of(contract: Contract) -> dict[str, float]:
    robot = contract.robot
    home = {joint: float(robot.home[i]) for joint, i in zip(robot.servos, robot.servo_indices, strict=True)}
    return {joint: home[joint] for joint in contract.joints}


def one_or_each(numbers: dict[str, float], count: int | None = None) -> Any:
    """One number where it is the same for all: of `count` joints, if only some may be said."""
    whole = count is None or len(numbers) == count
    return next(iter(numbers.values())) if whole and len(set(numbers.values())) == 1 else numbers


def _joints(contract: Contract) -> dict[str, Any]:
    joints: dict[str, Any] = {"order": contract.get("joints.order"), "home": one_or_each(contract.get("joints.home"))}
    if (observed := contract.get("joints.observed")) not in (None, contract.joints):
        joints["observed"] = observed
    if (command := _command_of_joints(contract.get("joints.command"))) != "position":
        joints["command"] = command
    offset = contract.get("joints.offset")
    if offset is not None and offset != contract.get("joints.home"):
        joints["offset"] = one_or_each(offset, len(contract.joints))
    for key in ("scale", "lower", "upper"):
        if (value := contract.get(f"joints.{key}")) is not None:
            joints[key] = one_or_each(value, len(contract.joints))
    for key in ("limit", "delay", "filter"):
        if (value := contract.get(f"joints.{key}")) is not None:
            joints[key] = value
    return joints


def _command_of_joints(commands: Any) -> Any:
    """One word, or the most frequent one as `all` and the joints that have another."""
    if not isinstance(commands, dict):
        return commands
    of = list(commands.values())
    most = max(of, key=of.count)
    return {"all": most} | {joint: command for joint, command in commands.items() if command != most}


def _command(contract: Contract) -> dict[str, float]:
    """A walk forward at half a metre a second, within what it was trained for."""
    ranges = contract.get("command.ranges", {})
    low, high = ranges.get("vx", (-math.inf, math.inf))
    return dict(contract.assume("command", {"vx": min(max(0.5, low), high), "vy": 0.0, "yaw_rate": 0.0}))


def _observation(contract: Contract) -> list[Any]:
    items = []
    for block in contract.get("observation"):
        said = contract.get(f"observation.{block}")
        items.append({"block": block} | said if isinstance(said, dict) else block)
    return items
