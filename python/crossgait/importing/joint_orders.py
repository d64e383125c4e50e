"""Orders of joints that files mean without saying them: named data, each with the versions that it holds for."""

from __future__ import annotations

from dataclasses import dataclass

from crossgait._core import Robot
from crossgait.errors import ConfigError


@dataclass(frozen=True)
class JointOrder:
    """A rule that gives the servos of any quadruped an order."""

    name: str
    by: str  #: "leg": one leg after the other, from the hip; "depth": all hips first; "file": as the robot's file
    legs: tuple[str, ...]  #: in order; empty: by the names of their joints
    holds_for: str


#: A change of a rule in a later release is a row of its own, with a name that says from when on it holds.
JOINT_ORDERS = (
    JointOrder("unitree-sdk", "leg", ("FR", "FL", "RR", "RL"), "motor indices of Unitree's SDK, all quadrupeds"),
    JointOrder("isaac-gym", "leg", (), "Isaac Gym 1.0 preview 2 to 4: depth first, children by name"),
    JointOrder("isaac-lab", "depth", (), "PhysX articulations of Isaac Lab's core before 28.0.0: breadth first"),
    JointOrder("legs-fl-fr-rl-rr", "leg", ("FL", "FR", "RL", "RR"), "what says so by itself"),
    JointOrder("depth-fl-fr-rl-rr", "depth", ("FL", "FR", "RL", "RR"), "what says so by itself"),
    JointOrder("file", "file", (), "the robot's own file, as MuJoCo and mjlab have it"),
)


def joints_in_order(name: str, robot: Robot, source: str) -> list[str]:
    """The robot's servos in the order of that name. Raises ConfigError naming `source`."""
    row = next((order for order in JOINT_ORDERS if order.name == name), None)
    if row is None:
        raise ConfigError(source, "joint order", ", ".join(order.name for order in JOINT_ORDERS), f"'{name}'")
    servos = list(zip(robot.servos, robot.servo_legs, strict=True))
    if row.by == "file":
        return [joint for joint, _ in servos]
    hips = {leg: joint for joint, (leg, depth) in servos if depth == 0}
    legs = list(row.legs) or sorted(hips, key=lambda leg: hips[leg])
    by_leg = row.by == "leg"

    def place(servo: tuple[str, tuple[str, int]]) -> tuple[int, int]:
        leg, depth = servo[1]
        return (legs.index(leg), depth) if by_leg else (depth, legs.index(leg))

    return [joint for joint, _ in sorted(servos, key=place)]


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
