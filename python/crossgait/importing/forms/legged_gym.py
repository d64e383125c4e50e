"""legged_gym's classes of configuration."""

from __future__ import annotations

from typing import Any

from crossgait.importing import terms
from crossgait.importing.actuator import Actuator, find_file
from crossgait.importing.contract import Contract, by_pattern
from crossgait.importing.forms.shared import Options, order_of_joints, say_command
from crossgait.importing.stated import Stated

#: What legged_gym's LeggedRobotCfg says; configurations inherit from it, and rarely come with its file.
_DEFAULTS = {"policy_dt": 0.02, "physics_dt": 0.005}


_SCALES = {"lin_vel": 2.0, "ang_vel": 0.25, "dof_pos": 1.0, "dof_vel": 0.05, "height_measurements": 5.0}


_SOURCE = "legged_gym's LeggedRobotCfg"


_GRID = ([round(-0.8 + 0.1 * i, 9) for i in range(17)], [round(-0.5 + 0.1 * i, 9) for i in range(11)])


def read(root: Stated, contract: Contract, options: Options) -> None:
    """A class of configuration of legged_gym or unitree_rl_gym, with compute_observations as it is there."""
    contract.say_convention(order_of_joints(options, "isaac-gym"), root.place)
    control = root.at("control")
    kind = control.find("control_type")
    if kind is not None and kind.text() not in ("P", "T"):
        kind.fail("P or T: targets of angles or torques")
    if kind is not None:
        contract.say("joints.command", {"P": "position", "T": "torque"}[kind.text()], kind.place)
    _network(control, root, contract, options)
    if (angles := root.find("init_state", "default_joint_angles")) is not None:
        contract.say("joints.home", by_pattern(angles, contract.joints, whole=False), angles.place)
    for key, name in (("stiffness", "servos.kp"), ("damping", "servos.kd")):
        if (value := control.find(key)) is not None:
            contract.say(name, by_pattern(value, contract.joints, whole=False), value.place)
    contract.say_by_joint("joints.scale", control.find("action_scale"))
    dt, decimation = root.find("sim", "dt"), control.find("decimation")
    physics = dt.number() if dt is not None else _DEFAULTS["physics_dt"]
    if dt is not None:
        contract.say("physics_dt", physics, dt.place)
    contract.assume("physics_dt", physics, _SOURCE)
    if decimation is not None:
        contract.say("policy_dt", physics * decimation.integer(), decimation.place)
    contract.assume("policy_dt", physics * 4, _SOURCE)
    normalization = root.find("normalization")
    clip = normalization.find("clip_actions") if normalization is not None else None
    if clip is not None:
        contract.say("joints.limit", clip.number(), clip.place)
    contract.assume("joints.limit", 100.0, _SOURCE)
    _observation(root, contract)
    if (ranges := root.find("commands", "ranges")) is not None:
        say_command(contract, ranges)
    if (friction := root.find("terrain", "static_friction")) is not None:
        contract.say("friction", friction.number(), friction.place)


def _network(control: Stated, root: Stated, contract: Contract, options: Options) -> None:
    """The LSTM that legged_gym's ANYmal has in the place of its servos."""
    used = control.find("use_actuator_network")
    if used is None or not used.boolean():
        return
    file = control.at("actuator_net_file")
    dt = root.find("sim", "dt")
    found = find_file(file.text(), options.folders, file.place)
    contract.say_actuator(Actuator(found, file.place, True, dt.number() if dt is not None else _DEFAULTS["physics_dt"]))


def _observation(root: Stated, contract: Contract) -> None:
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
        return value.number() if value is not None else _SCALES[key]

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
        x, y = _grid(root)
        contract.say("height_scan", {"x": x, "y": y, "offset": 0.5, "x_first": False}, place)
    said = []
    for block, number in parts:
        item: dict[str, Any] = {"block": block, "clip": limit}
        if number != 1.0:
            item["scale"] = number if isinstance(number, float) else terms.one_or_all(number)
        if block == "height_scan":
            item["clip_unscaled"] = 1.0
        said.append((item, place))
    terms.say_terms(contract, said, root)


def _grid(root: Stated) -> tuple[list[float], list[float]]:
    x, y = root.find("terrain", "measured_points_x"), root.find("terrain", "measured_points_y")
    return (
        x.numbers() if x is not None else _GRID[0],
        y.numbers() if y is not None else _GRID[1],
    )
