"""What is said of a policy's interface, field by field, each with where it was said."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from typing import Any

from crossgait._core import Robot
from crossgait.errors import ConfigError
from crossgait.importing.actuator import Actuator
from crossgait.importing.joint_orders import joints_in_order, match_joints
from crossgait.importing.stated import Stated


@dataclass(frozen=True)
class Field:
    """A field of the environment, its value, and where that comes from."""

    name: str
    value: Any
    source: str


#: Source of what the caller says.
SETTINGS = "settings"


def _same(a: Any, b: Any) -> bool:
    if isinstance(a, dict) and isinstance(b, dict):
        return a.keys() == b.keys() and all(_same(a[key], b[key]) for key in a)
    if isinstance(a, (list, tuple)) and isinstance(b, (list, tuple)):
        return len(a) == len(b) and all(map(_same, a, b))
    numbers = isinstance(a, (int, float)) and isinstance(b, (int, float))
    # Exporters write three digits: 0.333 is a third.
    return math.isclose(a, b, rel_tol=5e-3, abs_tol=1e-9) if numbers else bool(a == b)


@dataclass
class Contract:
    """The fields that are said so far. Values by joint are dictionaries of the robot's joints."""

    robot: Robot
    fields: dict[str, Field] = field(default_factory=dict)
    joints: list[str] = field(default_factory=list)  #: the robot's servos in the policy's order
    unstated: list[str] = field(default_factory=list)
    actuator: Actuator | None = None  #: a network in the place of the servos' law

    def say(self, name: str, value: Any, source: str) -> None:
        """Take in a field. Raises ConfigError naming both places where another was said before."""
        before = self.fields.get(name)
        if before is not None and self.is_set(name):
            if source != SETTINGS and not _same(before.value, value):
                self.fields[name] = Field(name, before.value, f"{SETTINGS}, where {source} says {_shown(value)}")
        elif before is None:
            self.fields[name] = Field(name, value, source)
        elif not _same(before.value, value):
            raise ConfigError(source, name, f"{_shown(before.value)}, as {before.source} says", _shown(value))

    def is_set(self, name: str) -> bool:
        """Whether the caller said it, in the place of what files say."""
        return name in self.fields and self.fields[name].source.startswith(SETTINGS)

    def assume(self, name: str, value: Any, source: str = "default") -> Any:
        """What was said of a field; if nothing was, `value`, and that nobody said it."""
        if name not in self.fields:
            self.fields[name] = Field(name, value, source)
            self.unstated.append(name)
        return self.fields[name].value

    def get(self, name: str, otherwise: Any = None) -> Any:
        """What was said of a field."""
        found = self.fields.get(name)
        return otherwise if found is None else found.value

    def say_order(self, joints: list[str], source: str) -> None:
        """Take in the order of the policy's joints."""
        self.say("joints.order", joints, source)
        self.joints = joints

    def say_named_order(self, names: Stated) -> None:
        """The same by the names in a list."""
        self.say_order(match_joints(names.texts(), self.robot, names.place), names.place)

    def say_convention(self, convention: str, source: str) -> None:
        """The same by a convention's name, unless the order is known."""
        if not self.joints:
            self.say_order(joints_in_order(convention, self.robot, source), f"{source} (convention {convention})")

    def say_actuator(self, actuator: Actuator) -> None:
        """Take in a network that makes torques of targets."""
        self.say("joints.actuator", actuator.file, actuator.place)
        self.actuator = actuator

    def say_by_joint(self, name: str, value: Stated | None, order: list[str] | None = None) -> None:
        """A number for every joint: a list in `order` (the policy's unless given), one number, or by pattern."""
        if value is None:
            return
        order = order or self.joints
        if isinstance(value.raw, dict):
            numbers = by_pattern(value, order)
            if numbers:
                self.say(name, numbers, value.place)
            return
        self.say(name, dict(zip(order, value.numbers(len(order)), strict=True)), value.place)


def by_pattern(value: Stated, joints: list[str], whole: bool = True) -> dict[str, float]:
    """Numbers by joint from a mapping of names or regular expressions of them.

    Args:
        value: the mapping
        joints: that may match
        whole: whether a pattern has to match the whole name, as in Isaac Lab; else it is a part of it, as in
            legged_gym

    """
    found: dict[str, float] = {}
    for pattern, number in value.entries().items():
        if number.raw is None:
            continue
        try:
            matches = [j for j in joints if (re.fullmatch(pattern, j) if whole else pattern in j)]
        except re.error as error:
            number.fail("a regular expression of joints' names", f"{pattern} ({error})")
        for joint in matches:
            found[joint] = number.number()
        number.read = True
    return found


def _shown(value: Any) -> str:
    if isinstance(value, dict):
        numbers = set(value.values()) if all(isinstance(v, (int, float)) for v in value.values()) else set()
        return (
            f"{numbers.pop():g} for every joint"
            if len(numbers) == 1
            else ", ".join(f"{k} {v}" for k, v in value.items())
        )
    if isinstance(value, (list, tuple)):
        return ", ".join(map(str, value))
    return f"{value:g}" if isinstance(value, float) else str(value)
