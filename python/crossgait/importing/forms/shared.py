"""What several forms say alike."""

from __future__ import annotations

from dataclasses import dataclass

from crossgait.importing.contract import Contract
from crossgait.importing.stated import Stated


@dataclass(frozen=True)
class Options:
    """What the caller says beside the files."""

    joint_order: str | None = None  #: a convention's name, in the place of the form's own
    folders: tuple[str, ...] = ()  #: of the files that were given


def order_of_joints(options: Options, otherwise: str) -> str:
    """The convention that the caller names, else the form's own."""
    return options.joint_order or otherwise


def say_isaac_history(contract: Contract, place: Stated) -> None:
    """Isaac Lab's circular buffers: term by term, oldest first, filled with the first observation."""
    source = f"{place.place} (Isaac Lab's buffers)"
    contract.say("history.by", "term", source)
    contract.say("history.order", "oldest_first", source)
    contract.say("history.before", "first", source)


def say_command(contract: Contract, ranges: Stated) -> None:
    """Ranges of the velocity commands that it was trained for."""
    said = {}
    for key, name in (("lin_vel_x", "vx"), ("lin_vel_y", "vy"), ("ang_vel_z", "yaw_rate"), ("ang_vel_yaw", "yaw_rate")):
        if (limits := ranges.find(key)) is not None:
            said[name] = limits.numbers(2)
    if said:
        contract.say("command.ranges", said, ranges.place)


def only(mapping: Stated, expected: str) -> Stated:
    """The one entry that a mapping has to have; entries of null do not count."""
    entries = {key: value for key, value in mapping.entries().items() if value.raw is not None}
    if len(entries) != 1:
        mapping.fail(expected, ", ".join(entries) or "none")
    value = next(iter(entries.values()))
    value.read = True
    return value
