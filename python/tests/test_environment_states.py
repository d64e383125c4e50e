"""Environments under drawn orders of reset, step, save and restore, held against the same from the beginning."""

from __future__ import annotations

import random

import numpy as np
import pytest

import crossgait
from crossgait import ConfigError, _core

ENGINES = crossgait.available_engines()
EPISODE_STEPS = 30  # of 2 ms


class Told:
    """An environment, and by what seed and actions it came where it is; None before the first reset."""

    def __init__(self, engine: str) -> None:
        self.environment = _core.Environment(crossgait.EnvironmentConfig(episode_seconds=0.06), engine)
        self.story: tuple[int, list[np.ndarray]] | None = None
        self.seen: list[float] = []

    @property
    def size(self) -> int:
        return len(self.environment.action_layout)

    def reset(self, seed: int) -> None:
        self.seen = list(self.environment.reset(seed))
        self.story = (seed, [])

    def step(self, action: np.ndarray) -> None:
        assert self.story is not None
        observation, reward, *ended = self.environment.step(action)
        self.seen = [*observation, reward, *ended]
        self.story[1].append(action)

    def told_again(self, engine: str) -> list[float]:
        other = Told(engine)
        assert self.story is not None
        other.reset(self.story[0])
        for action in self.story[1]:
            other.step(action)
        return other.seen


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("seed", range(3))
def test_any_order_of_calls_is_refused_or_does_what_it_says(engine: str, seed: int) -> None:
    draw = random.Random(seed)
    told = Told(engine)
    saved: list[tuple[_core.SavedEpisode, tuple[int, list[np.ndarray]], list[float]]] = []
    for _ in range(60):
        match draw.choice(["reset", "step", "step", "step", "save", "restore", "wrong size"]):
            case "reset":
                told.reset(draw.randrange(4))
            case "step" if told.story is None:
                with pytest.raises(ConfigError, match="a reset before it"):
                    told.environment.step(np.zeros(told.size))
            case "step" if len(told.story[1]) < EPISODE_STEPS:
                told.step(np.array([draw.uniform(-1, 1) for _ in range(told.size)]))
            case "save" if told.story is None:
                with pytest.raises(ConfigError, match="a reset before it"):
                    told.environment.save()
            case "save":
                saved.append((told.environment.save(), (told.story[0], list(told.story[1])), list(told.seen)))
            case "restore" if saved:
                state, story, told.seen = draw.choice(saved)
                told.environment.restore(state)
                told.story = (story[0], list(story[1]))
            case "wrong size":
                with pytest.raises(ConfigError):
                    told.environment.step(np.zeros(told.size + draw.choice([-1, 1])))
    if told.story is None:
        told.reset(0)
    told.step(np.zeros(told.size))
    assert told.seen == told.told_again(engine)  # to the last bit
