from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import crossgait
from crossgait import ConfigError, GaitGenerator, Robot, Walk


@pytest.fixture(params=crossgait.robots())
def robot(request: pytest.FixtureRequest) -> Robot:
    return Robot.load(str(request.param))


def random_feet(robot: Robot, leg: crossgait.Leg, count: int) -> np.ndarray:
    """Where any leg reaches: round its standing foot, within a fifth of its depth."""
    h = robot.standing_height
    home = leg.forward(robot.home[leg.servo_indices])[0]
    return np.asarray(home + np.random.default_rng(1).uniform(-0.2 * h, 0.2 * h, (count, 3)))


def test_inverse_then_forward_is_the_target(robot: Robot) -> None:
    for leg in crossgait.legs(robot).values():
        feet = random_feet(robot, leg, 200)
        angles, status = leg.inverse(feet)
        exact = [s == "ok" for s in status]
        assert sum(exact) > 100
        # 1e-9 m: the tolerance of least squares; closed forms are exact to rounding
        assert np.allclose(leg.forward(angles)[exact], feet[exact], atol=1e-9)
        assert np.isfinite(angles).all()


def test_the_jacobian_is_the_difference_quotient(robot: Robot) -> None:
    leg = crossgait.legs(robot)["FR"]
    angles = robot.home[leg.servo_indices]
    jacobian = leg.jacobian(angles)
    step = 1e-6
    for i in range(len(angles)):
        moved = np.stack([angles, angles])
        moved[0, i] += step
        moved[1, i] -= step
        ahead, behind = leg.forward(moved)
        # central differences: the error is of order step^2 and 1e-16 / step
        assert np.allclose(jacobian[:, i], (ahead - behind) / (2 * step), atol=1e-8)


def test_home_feet_stand_at_the_standing_height(robot: Robot) -> None:
    for leg in crossgait.legs(robot).values():
        foot = leg.forward(robot.home[leg.servo_indices])[0]
        assert 0.5 < -foot[2] / robot.standing_height < 2  # the home pose is about a stand
        assert leg.name in ("FL", "FR", "RL", "RR")
        assert [robot.joints[i] for i in leg.servo_indices] == leg.servos


def test_targets_out_of_reach_say_so(scara: Robot) -> None:
    leg = crossgait.legs(scara)["FL"]
    angles, status = leg.inverse([[0, 0, -1.0], [np.nan, 0, 0], [0, 0, -0.06]])
    assert status == ["clamped_too_far", "invalid_target", "ok"]
    assert np.isfinite(angles).all()
    assert set(leg.margins(angles[2])) == {"joint_limit", "serial", "parallel"}
    with pytest.raises(ConfigError, match="targets"):
        leg.inverse([[1, 2]])
    with pytest.raises(ConfigError, match="angles"):
        leg.forward([1.0])


def test_a_workspace_says_what_the_inverse_says(scara: Robot) -> None:
    leg = crossgait.legs(scara)["RL"]
    space = leg.workspace((5, 4, 3), ((-0.05, -0.02, -0.1), (0.05, 0.02, -0.03)))
    assert space["target"].shape == (60, 3)
    assert np.allclose(space["target"][0], [-0.05, -0.02, -0.1])
    assert np.allclose(space["target"][1], [-0.025, -0.02, -0.1])
    assert np.allclose(space["target"][-1], [0.05, 0.02, -0.03])
    _, status = leg.inverse(space["target"])
    assert list(space["status"]) == status
    assert np.array_equal(space["reachable"], [s == "ok" for s in status])
    assert 0 < space["reachable"].sum() <= 60
    with pytest.raises(ConfigError):
        leg.workspace((1, 2, 2))


def test_the_tables_are_the_programs() -> None:
    gaits = crossgait.gaits()
    assert {"trot", "walk", "pace", "bound", "pronk", "gallop"} <= set(gaits)
    assert gaits["trot"]["offsets"] == {"FL": 0, "FR": 0.5, "RL": 0.5, "RR": 0}
    table = crossgait.gait_parameters()
    assert table["step_length"]["unit"] == "m"
    assert all(row["min"] < row["max"] for row in table.values())


@pytest.mark.parametrize("gait", ["trot", "walk", "gallop"])
def test_feet_sweep_at_the_commanded_speed(gait: str) -> None:
    walk = Walk(gait, command=(0.1, 0, 0))
    generator = GaitGenerator(walk)
    cycle, dt = walk.parameters["cycle_time"], 1e-3
    history: list[Any] = [generator.update(dt) for _ in range(round(3 * cycle / dt))]
    feet = np.stack([row[0] for row in history])
    swing = np.stack([row[1] for row in history])
    stance = ~swing[1:] & ~swing[:-1]
    backwards = -np.diff(feet[:, :, 0], axis=0)[stance] / dt
    # Sweeps are the body's way at constant speed; steps across a boundary of the cycle are mixed.
    assert np.median(backwards) == pytest.approx(0.1, rel=1e-6)
    assert (~swing).mean() == pytest.approx(walk.parameters["duty_factor"], abs=0.03)  # whole steps of dt
    assert feet[..., 2].max() > feet[..., 2].min()


def test_a_generator_hands_out_arrays_of_their_own() -> None:
    generator = GaitGenerator()
    first, swing, _ = generator.update(0.01)
    kept = first.copy(), swing.copy()
    for _ in range(10):
        generator.update(0.01)
    assert np.array_equal(first, kept[0])
    assert np.array_equal(swing, kept[1])
    generator.reset()
    assert np.array_equal(generator.update(0.01)[0], kept[0])


def test_what_no_generator_can_do_is_refused() -> None:
    with pytest.raises(ConfigError, match="auto"):
        GaitGenerator(Walk("auto", command=(0.2, 0, 0)))
    with pytest.raises(ConfigError, match="dt"):
        GaitGenerator().update(0)
    with pytest.raises(ConfigError, match="command"):
        GaitGenerator().set_command(float("nan"))
