from __future__ import annotations

import numpy as np
import pytest

from crossgait import EnvironmentConfig, _core
from crossgait.layout import EnvironmentLayout


def layout_of(text: str) -> EnvironmentLayout:
    return EnvironmentLayout.of(_core.Environment(EnvironmentConfig.parse(text)))


def test_names_units_and_places() -> None:
    layout = layout_of("{}")
    observation = layout.observation
    assert len(observation) == 69
    assert len(layout.action) == 16
    assert observation.names[:3] == ("p_WB.x", "p_WB.y", "p_WB.z")
    assert observation.index("v_WB.x") == 7
    assert observation.units[observation.index("w_WB.z")] == "rad/s"
    assert layout.action.index("residual.FL.x") == 4
    assert layout.hash == layout_of("{}").hash != layout_of("adapt: [cycle_time]").hash
    assert layout == layout_of("{}")
    assert layout.observation != layout_of("adapt: [cycle_time]").observation


def test_a_name_that_is_not_there_says_which_are_like_it() -> None:
    with pytest.raises(KeyError, match="v_WB"):
        layout_of("{}").observation.index("v_WBx")


def test_bounds_are_read_only() -> None:
    observation = layout_of("{}").observation
    for numbers in (observation.low, observation.high, *observation.box):
        with pytest.raises(ValueError, match="read-only"):
            numbers[0] = 0


@pytest.mark.parametrize(
    ("name", "low", "high"),
    [
        ("p_WB.x", -1e3, 1e3),
        ("v_WB.x", -100, 100),
        ("q.FL_tilt", -100, 100),
        ("w_WB.z", -1e3, 1e3),
        ("qd.FL_tilt", -50, 50),  # 0.05 times 1000 rad/s
        ("dq.FL_tilt", -200, 200),  # -2 times 100 rad
        ("q_WB.w", -1 - 1e-9, 1 + 1e-9),  # its own, wider by rounding
        ("contact.FL", 0, 1 + 1e-9),  # but zero stays zero
        ("command.vx", -5 - 5e-9, 5 + 5e-9),  # clipped
    ],
)
def test_boxes_are_finite(name: str, low: float, high: float) -> None:
    blocks = ["base_position", "base_linear_velocity", "base_angular_velocity", "joint_positions", "base_orientation"]
    blocks += ["foot_contacts", "{block: joint_velocities, scale: 0.05}", "{block: joint_offsets, scale: -2}"]
    blocks += ["{block: command, clip: 5}"]
    observation = layout_of(f"observation: [{', '.join(blocks)}]").observation
    i = observation.index(name)
    assert observation.box[0][i] == pytest.approx(low, rel=1e-15)
    assert observation.box[1][i] == pytest.approx(high, rel=1e-15)


@pytest.mark.parametrize("action", ["gait", "joints"])
def test_every_block_has_finite_bounds(action: str) -> None:
    blocks = ["base_position", "base_orientation", "terrain", "command", "gravity", "height", "last_action"]
    blocks += ["joint_offsets", "foot_positions", "foot_contacts", "base_angular_velocity_local"]
    if action == "gait":
        blocks += ["parameters", "phase"]
    text = f"{{action: {action}, observation: [{', '.join(blocks)}]}}"
    low, high = layout_of(text).observation.box
    assert np.isfinite(low).all()
    assert np.isfinite(high).all()
    assert (low < high).all()
