"""Orders of joints that files mean without saying them, and joints by the names that files give them.

The conventions are rows of one table of the core's (diagnosis/joint_orders.cpp), which a diagnosis tries too.
"""

from __future__ import annotations

from crossgait._core import Robot, joint_orders
from crossgait.errors import ConfigError


def joints_in_order(name: str, robot: Robot, source: str) -> list[str]:
    """The robot's servos in the order of that name. Raises ConfigError naming `source`."""
    orders = joint_orders(robot)
    if name not in orders:
        raise ConfigError(source, "joint order", ", ".join(orders), f"'{name}'")
    return orders[name]


def match_joints(names: list[str], robot: Robot, source: str) -> list[str]:
    """The robot's servos of these names, which may lack or have "_joint" at their end. Raises ConfigError."""
    plain = {servo.lower().removesuffix("_joint"): servo for servo in robot.servos}
    found = [plain.get(name.lower().removesuffix("_joint")) for name in names]
    missing = [name for name, joint in zip(names, found, strict=True) if joint is None]
    joints = [joint for joint in found if joint is not None]
    if missing or sorted(joints) != sorted(robot.servos):
        expected = f"each servo of {robot.name} once: {', '.join(robot.servos)}"
        raise ConfigError(source, "joint names", expected, ", ".join(names))
    return joints
