"""What is limited or doubtful in what is asked for is said where it is asked for."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

import gymnasium
import pytest

import crossgait
from crossgait import commands
from crossgait.envs import AdaptiveGaitEnv, AdaptiveGaitVectorEnv
from crossgait.notes import tell_notes

HIGH = {"step_height": 0.3}
ONE = "mujoco"
HIGH_ENVIRONMENT = crossgait.EnvironmentConfig(parameters=HIGH, episode_seconds=0.2)

ASKED: list[Callable[[], Any]] = [
    lambda: crossgait.walk("trot", engine=ONE, parameters=HIGH, seconds=0.1),
    lambda: crossgait.walk(crossgait.Walk("trot", parameters=HIGH, seconds=0.1), engine=ONE),
    lambda: crossgait.walk("zero", engine=ONE, environment=HIGH_ENVIRONMENT),
    lambda: crossgait.compare("trot", engines="mujoco,bullet", parameters=HIGH, seconds=0.1),
    lambda: crossgait.rollout("zero", HIGH_ENVIRONMENT, episodes=1),
    lambda: crossgait.transfer("zero", HIGH_ENVIRONMENT, engines=ONE, terrains="flat", episodes=1),
    lambda: AdaptiveGaitEnv(HIGH_ENVIRONMENT),
    lambda: AdaptiveGaitVectorEnv(1, HIGH_ENVIRONMENT),
    lambda: gymnasium.make("Crossgait/AdaptiveGait-v0", config=HIGH_ENVIRONMENT),
    lambda: gymnasium.make_vec("Crossgait/AdaptiveGait-v0", 2, "vector_entry_point", config=HIGH_ENVIRONMENT),
]


def noted(ask: Callable[[], Any]) -> list[warnings.WarningMessage]:
    """Notes of a call, each time that they are told."""
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        ask()
    return told


@pytest.mark.parametrize("ask", ASKED)
def test_whoever_asks_for_what_is_limited_is_told_where_they_ask(ask: Callable[[], Any]) -> None:
    """As the command line tells it, and nothing else warns."""
    told = noted(ask)
    assert [str(warning.message) for warning in told] == crossgait.Walk("trot", parameters=HIGH).notes
    assert {warning.category for warning in told} == {crossgait.Note}
    assert {warning.filename for warning in told} == {__file__}


def test_a_note_says_by_how_much_feet_are_lifted() -> None:
    """A step that is higher than the legs is limited."""
    height, lift = crossgait.Walk("trot", parameters=HIGH).notes
    assert "outside the range" in height
    assert "feet are lifted by" in lift
    assert crossgait.EnvironmentConfig(parameters=HIGH).notes == [height, lift]


def test_a_physics_step_that_is_too_long_is_noted() -> None:
    """For its servos, and for soft contact."""
    long = crossgait.EnvironmentConfig(physics_dt=0.01, control_dt=0.02, policy_dt=0.02)
    assert any("explicit servos overshoot" in note for note in long.notes)
    assert any("in steps of 0.01 s" in note for note in crossgait.Walk(physics_dt=0.01, control_dt=0.02).notes)


def test_what_is_as_usual_is_not_noted() -> None:
    """Defaults, and a parameter within its range."""
    assert crossgait.Walk().notes == crossgait.EnvironmentConfig().notes == []
    assert noted(lambda: crossgait.walk("trot", engine=ONE, parameters={"step_height": 0.04}, seconds=0.1)) == []


def test_notes_are_warnings_that_a_filter_makes_errors() -> None:
    """So that a program of tests can refuse them."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", crossgait.Note)
        with pytest.raises(crossgait.Note, match="outside the range"):
            crossgait.walk("trot", engine=ONE, parameters=HIGH, seconds=0.1)


def test_a_command_says_its_notes_as_commands_do(capsys: pytest.CaptureFixture[str]) -> None:
    """Where there is no program to point at."""

    def work() -> int:
        for _ in range(2):  # once each
            tell_notes(crossgait.Walk("trot", parameters=HIGH))
        tell_notes(HIGH_ENVIRONMENT)
        return 0

    with warnings.catch_warnings():
        warnings.simplefilter("default")
        assert commands.exit_code("crossgait.train", work) == 0
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 2
    assert all(line.startswith("crossgait.train: note: step_height") for line in lines)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert commands.exit_code("crossgait.train", work) == commands.WRONG_INPUT
    assert capsys.readouterr().err.startswith("crossgait.train: step_height")
