"""Terms of observations by the names that frameworks give them."""

from __future__ import annotations

from typing import Any

from crossgait.importing.contract import SETTINGS, Contract
from crossgait.importing.stated import Stated

#: Blocks of ours by the names of Isaac Lab's functions, which unitree_rl_lab's deploy.yaml uses too.
ISAAC_LAB = {
    "base_lin_vel": "base_linear_velocity_local",
    "base_ang_vel": "base_angular_velocity_local",
    "imu_ang_vel": "base_angular_velocity_local",
    "projected_gravity": "gravity",
    "imu_projected_gravity": "gravity",
    "generated_commands": "command",
    "velocity_commands": "command",
    "joint_pos_rel": "joint_offsets",
    "joint_pos": "joint_positions",
    "joint_vel_rel": "joint_velocities",
    "joint_vel": "joint_velocities",
    "last_action": "last_action",
    "last_processed_action": "joint_targets",
    "root_quat_w": "base_orientation",
    "root_lin_vel_w": "base_linear_velocity",
    "root_ang_vel_w": "base_angular_velocity",
    "root_pos_w": "base_position",
    "height_scan": "height_scan",
}
#: mjlab's metadata lists names of terms, where joint_pos and joint_vel are relative to the default pose.
MJLAB = {
    "base_lin_vel": "base_linear_velocity_local",
    "base_ang_vel": "base_angular_velocity_local",
    "projected_gravity": "gravity",
    "command": "command",
    "joint_pos": "joint_offsets",
    "joint_vel": "joint_velocities",
    "actions": "last_action",
}
RL_SAR = {
    "lin_vel": "base_linear_velocity_local",
    "ang_vel": "base_angular_velocity_local",
    "ang_vel_body": "base_angular_velocity_local",
    "ang_vel_world": "base_angular_velocity",
    "gravity_vec": "gravity",
    "commands": "command",
    "dof_pos": "joint_offsets",
    "dof_vel": "joint_velocities",
    "actions": "last_action",
}
_PER_JOINT = {"joint_offsets", "joint_positions", "joint_velocities", "last_action", "joint_targets"}
_SIZES = {"command": 3, "base_orientation": 4, "base_orientation_xyzw": 4}


def block_of(name: str, table: dict[str, str], place: Stated) -> str:
    """The block of a term. Raises ConfigError naming the term where there is none."""
    if name not in table:
        place.fail(f"a term that Crossgait has: {', '.join(table)}", f"'{name}'")
    return table[name]


def size_of(block: str, contract: Contract) -> int | None:
    """How many numbers a block has; None where that depends on more."""
    if block == "last_action":
        return len(contract.robot.servos)
    if block in _PER_JOINT:
        return len(contract.get("joints.observed", contract.robot.servos))
    return None if block == "height_scan" else _SIZES.get(block, 3)


def one_or_all(numbers: list[float]) -> float | list[float]:
    """A number if all are the same."""
    return numbers[0] if len(set(numbers)) == 1 else numbers


def term(
    contract: Contract,
    block: str,
    scale: Stated | float | None = None,
    clip_unscaled: Stated | None = None,
    history: int = 1,
) -> dict[str, Any]:
    """An item of the environment's observation."""
    item: dict[str, Any] = {"block": block}
    size = size_of(block, contract)
    if isinstance(scale, Stated):
        numbers = scale.numbers(size) if size is not None else scale.numbers()
        if any(number == 0 for number in numbers):
            scale.fail("scales other than 0")
        if any(number != 1 for number in numbers):
            item["scale"] = one_or_all(numbers)
    elif scale is not None and scale != 1:
        item["scale"] = scale
    if clip_unscaled is not None:
        item["clip_unscaled"] = symmetrical(clip_unscaled)
    if history > 1:
        item["history"] = history
    return item


def symmetrical(limits: Stated) -> float:
    """The limit, both ways, of [low, high]. Raises ConfigError where they differ."""
    low, high = limits.numbers(2)
    if not (high > 0 and low == -high):
        limits.fail("limits of the same size, [-X, X]", f"[{low:g}, {high:g}]")
    return high


def say_terms(contract: Contract, terms: list[tuple[dict[str, Any], str]], stated: Stated) -> None:
    """Take in the whole observation, term by term; not beside one that the caller said.

    Raises ConfigError of where they are `stated` if there is none.
    """
    if not terms:
        stated.fail("at least one term", "none")
    if contract.is_set("observation") and terms[0][1] != SETTINGS:
        return
    contract.say("observation", [item["block"] for item, _ in terms], terms[0][1])
    for item, place in terms:
        said = {key: value for key, value in item.items() if key != "block"}
        contract.say(f"observation.{item['block']}", said or "as it is", place)
