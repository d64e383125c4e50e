from __future__ import annotations

import numpy as np
import pytest

from crossgait import EnvironmentConfig, _core
from crossgait.layout import OTHER_BOUND, UNIT_BOUNDS, EnvironmentLayout, Layout, unit_bound


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
    with pytest.raises(ValueError, match="read-only"):
        layout_of("{}").observation.low[0] = 0


@pytest.mark.parametrize(
    ("unit", "bound"),
    [
        *UNIT_BOUNDS.items(),
        ("-", OTHER_BOUND),
        ("rad from 0.900", UNIT_BOUNDS["rad"]),
        ("rad/s x 0.05", 0.05 * UNIT_BOUNDS["rad/s"]),
        ("rad from -1.400 x -2", 2 * UNIT_BOUNDS["rad"]),
        ("m/s x 2e-07", 2e-7 * UNIT_BOUNDS["m/s"]),
    ],
)
def test_units_have_bounds(unit: str, bound: float) -> None:
    assert unit_bound(unit) == pytest.approx(bound, rel=1e-15)


def test_own_bounds_come_before_those_of_the_unit() -> None:
    low, high = Layout.of(
        [("a", "m", -np.inf, np.inf), ("b", "-", 0, 1), ("c", "m", -np.inf, 2), ("d", "rad x .1", -5, 5)]
    ).finite_bounds()
    # Wider by rounding, but zero stays zero.
    assert low == pytest.approx([-1e3, 0, -1e3, -5], rel=2e-9)
    assert high == pytest.approx([1e3, 1, 2, 5], rel=2e-9)
    assert low[1] == 0
    assert high[1] > 1


@pytest.mark.parametrize("action", ["gait", "joints"])
def test_every_block_has_finite_bounds(action: str) -> None:
    blocks = ["base_position", "base_orientation", "terrain", "command", "gravity", "height", "last_action"]
    blocks += ["joint_offsets", "foot_positions", "foot_contacts", "base_angular_velocity_local"]
    if action == "gait":
        blocks += ["parameters", "phase"]
    text = f"{{action: {action}, observation: [{', '.join(blocks)}]}}"
    low, high = layout_of(text).observation.finite_bounds()
    assert np.isfinite(low).all()
    assert np.isfinite(high).all()
    assert (low < high).all()
