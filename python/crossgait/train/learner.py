"""What a run trains: one policy for the whole action, or a member of a hierarchical one (hierarchy.py)."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Protocol

from stable_baselines3.common.vec_env import VecEnv, VecNormalize

import crossgait
from crossgait.train import ppo
from crossgait.train.plan import Plan
from crossgait.train.ppo import TimedPPO


class Learner(Protocol):
    """How it sees the environments, its model, and the files that it becomes."""

    def environments(self, envs: VecEnv) -> VecEnv:
        """`envs` as the model sees them."""

    def model(self, plan: Plan, normalise: VecNormalize) -> TimedPPO:
        """A new one; `normalise` may be given what it begins with."""

    def save(self, model: TimedPPO, normalise: VecNormalize, folder: Path, name: str) -> Path:
        """Write the policy as it is, by a name without extension; returns the file that `--policy` takes."""


class WholePolicy:
    """One network for the whole action."""

    def __init__(self, plan: Plan) -> None:
        self._environment = plan.stages[0].environment

    def environments(self, envs: VecEnv) -> VecEnv:
        """As they are."""
        return envs

    def model(self, plan: Plan, normalise: VecNormalize) -> TimedPPO:
        """With the plan's network."""
        return ppo.make_single(plan, normalise)

    def save(self, model: TimedPPO, normalise: VecNormalize, folder: Path, name: str) -> Path:
        """As one bundle, checked against the model's own actions."""
        file = folder / f"{name}.safetensors"
        policy = crossgait.Policy.from_sb3(model, self._environment, normalise, observations=seen(model, normalise))
        policy.save(file)
        return file


def seen(model: TimedPPO, normalise: VecNormalize) -> Any:
    """Raw observations of the last step, for golden pairs; None before the first."""
    return normalise.get_original_obs() if model._last_obs is not None else None
