"""The training run itself: PPO of Stable-Baselines3, a rollout at a time, each ending in a checkpoint."""

from __future__ import annotations

import json
import os
import time
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import torch
from stable_baselines3.common.utils import set_random_seed

from crossgait._core import derived_seed
from crossgait.errors import ConfigError
from crossgait.notes import tell_notes
from crossgait.sweep.pool import ProcessPool, usable_cores
from crossgait.train import checkpoint, evaluation, record
from crossgait.train.environments import TrainingEnvs
from crossgait.train.folder import BEST, CHECKPOINT, ENDINGS, EVALUATIONS, LAST, OF_TRAINER, PROGRESS, describe
from crossgait.train.learner import Learner, WholePolicy
from crossgait.train.plan import Plan
from crossgait.train.remote_envs import RemoteEnvs, Workers
from crossgait.train.rollouts import normalised
from crossgait.train.tally import of_environments

Json = dict[str, Any]

#: Of PPO's own log.
_LOGGED = (
    "value_loss",
    "policy_gradient_loss",
    "entropy_loss",
    "approx_kl",
    "clip_fraction",
    "explained_variance",
    "std",
)


class Clock:
    """Wall time by what it was spent on, s."""

    def __init__(self, spent: dict[str, float] | None = None) -> None:
        self.spent = {"physics": 0.0, "learner": 0.0, "python": 0.0, "evaluation": 0.0} | (spent or {})

    def shares(self) -> dict[str, float]:
        """Of the time of training, without evaluations."""
        parts = {name: self.spent[name] for name in ("physics", "learner", "python")}
        total = sum(parts.values())
        return {name: part / total if total > 0 else 0.0 for name, part in parts.items()}


@dataclass(frozen=True)
class Trained:
    """What a trainer has come to."""

    name: str  #: of the part of a hierarchical policy; "policy" of a whole one
    plan: Plan
    folder: Path
    best: Path  #: the file that `--policy` takes
    state: Json  #: of the trainer


def _of_run(plan: Plan) -> Json:
    """What a run cannot change when it goes on: all but how long it is."""
    return {key: value for key, value in plan.document.items() if key != "steps"}


def _check_same_run(folder: Path, saved: Json | None, plan: Plan) -> None:
    """Raise ConfigError where a checkpoint is of another plan. Those of earlier versions do not say."""
    if saved is None:
        return
    now = _of_run(plan)
    for key in dict.fromkeys([*saved, *now]):
        if (before := saved.get(key)) != (after := now.get(key)):
            expected = f"{json.dumps(before)}, as the run began with"
            raise ConfigError(str(folder / CHECKPOINT), key, expected, json.dumps(after))


class Trainer:
    """One run in one folder, whose lock is held by whoever makes it (`crossgait.train.folder.locked`)."""

    def __init__(
        self,
        plan: Plan,
        folder: str | os.PathLike[str],
        *,
        resume: bool,
        progress: bool | None = None,
        learner: Learner | None = None,
        title: str = "",
        workers: Workers | None = None,
    ) -> None:
        """Build environments and model; with `resume` as the folder's checkpoint, if it has one, says.

        `learner` is what is trained, one policy for the whole action by default; `title` begins the line of progress.
        `workers` collect rollouts where the plan says `block`, by default processes of this machine.

        Raises:
            ConfigError: for what cannot be made, workers without a `block`, or a folder that has another run.

        """
        folder = Path(folder)
        if not resume and any((folder / name).exists() for name in OF_TRAINER):
            raise ConfigError(str(folder), "folder", "an empty one, or resume=True", "a run")
        there = (folder / CHECKPOINT).exists()
        if not there and len(record.read(folder / PROGRESS)) > 1:
            expected = "what the run goes on from; it cannot be made again from the rest"
            raise ConfigError(str(folder / CHECKPOINT), "file", expected, "none")
        self.plan, self.folder, self._title = plan, folder, title
        tell_notes(plan.stages[0].environment)
        if learner is None:
            describe(folder, plan)
        self.learner = learner or WholePolicy(plan)
        torch.set_num_threads(plan["threads"])
        set_random_seed(plan["seed"])
        self.envs: TrainingEnvs | RemoteEnvs
        if plan["block"] is None:
            if workers is not None:
                expected = "a number of environments, where workers collect rollouts"
                raise ConfigError(plan.source, "block", expected, "null")
            self.envs = TrainingEnvs(plan)
        else:
            self.envs = RemoteEnvs(plan, self.learner, workers or partial(ProcessPool, usable_cores()))
        self.normalise = normalised(self.learner.environments(self.envs), plan)
        self.model = self.learner.model(plan, self.normalise)
        self.model.lr_schedule = self._learning_rate
        self.state: Json = {"rollout": 0, "best": None, "evaluated": -1, "zero": None, "spent": {}}
        if there:
            self.state = checkpoint.load(folder, self.model, self.normalise)
            _check_same_run(folder, self.state.pop("plan", None), plan)
            self.envs.keep(self.state.pop("terms", None))
        self.clock = Clock(self.state["spent"])
        last = self.state["rollout"] if there else None
        self._progress = record.Table(folder / PROGRESS, "rollout", last)
        self._evaluations = record.Table(folder / EVALUATIONS, "rollout", last)
        self._board = record.Board(folder)
        self._line = record.Line(progress, title)
        self._forward = _ForwardTime(self.model.policy)

    @property
    def steps(self) -> int:
        """Policy steps of all environments so far."""
        return int(self.model.num_timesteps)

    @property
    def trained(self) -> Trained:
        """What there is so far."""
        best = next(each for ending in ENDINGS if (each := self.folder / f"{BEST}{ending}").exists())
        return Trained(self._title or "policy", self.plan, self.folder, best, self.state)

    def run(self) -> None:
        """Train to the end; whatever stops it, what the last checkpoint holds is kept."""
        try:
            while self.steps < self.plan["steps"]:
                self._rollout()
            if self.state["evaluated"] != self.state["rollout"]:
                self._evaluate()
                self._save()
        finally:
            self._line.clear()
            self._board.close()
            self.envs.close()

    def _learning_rate(self, _: float) -> float:
        rate = self.plan["algorithm"]["learning_rate"]
        first, last = rate if isinstance(rate, list) else (rate, rate)
        done = min(1.0, self.model.num_timesteps / self.plan["steps"])
        return float(first + (last - first) * done)

    def _rollout(self) -> None:
        begin, core, forward = time.perf_counter(), self.envs.core_seconds, self._forward.seconds
        stage = self.plan.stage(self.steps)
        self.envs.begin(stage, derived_seed(self.plan["seed"], self.state["rollout"]))
        learner = -self.model.seconds
        if isinstance(self.envs, RemoteEnvs):
            self.envs.collect(self.model, self.normalise)
            self.model.train()
        else:
            self.model._last_obs = None  # so that `learn` begins with new episodes
            self.model.learn(self.model.n_steps * self.model.n_envs, reset_num_timesteps=False)
        learner += self.model.seconds
        self.state["rollout"] += 1
        row = self._row(stage.index)
        if isinstance(self.envs, TrainingEnvs):
            self.envs.end()
        wall = time.perf_counter() - begin
        physics, learner = self.envs.core_seconds - core, learner + self._forward.seconds - forward
        for name, spent in (("physics", physics), ("learner", learner), ("python", wall - physics - learner)):
            self.clock.spent[name] += spent
        row |= {"seconds": sum(self.clock.spent.values()), "steps_per_second": self.envs.tally.steps / wall}
        row |= {f"share.{name}": share for name, share in self.clock.shares().items()}
        self._progress.add(row)
        self._board.add("train", self.steps, row)
        every = self.plan["evaluation"]["every"]
        if self.steps // every > (self.steps - self.envs.tally.steps) // every:
            self._evaluate()
        self._save()
        trained = sum(self.clock.spent.values()) - self.clock.spent["evaluation"]
        self._line(self.steps, self.plan["steps"], self.steps / trained, row)

    def _row(self, stage: int) -> record.Row:
        row: record.Row = {"rollout": self.state["rollout"], "steps": self.steps, "stage": stage}
        row |= self.envs.tally.numbers()
        adapted = self.plan["environment"].get("adapt", ())
        row |= of_environments(self.envs.env_method("summary"), self.envs.get_attr("parameters"), adapted)
        log = self.model.logger.name_to_value
        row["learning_rate"] = self._learning_rate(0)
        row |= {name: float(log[f"train/{name}"]) for name in _LOGGED if f"train/{name}" in log}
        return row

    def _evaluate(self) -> None:
        begin = time.perf_counter()
        asked = self.plan["evaluation"]
        last = str(self.learner.save(self.model, self.normalise, self.folder, LAST))
        names = [last] + (["zero"] if self.state["zero"] is None else [])
        done = evaluation.of_plan(names, self.plan, asked["episodes"], asked["seed"])
        if self.state["zero"] is None:
            self.state["zero"] = evaluation.row(done["zero"], asked["score"])
        row = evaluation.row(done[last], asked["score"])
        # Of equals the later, which the reward has shaped for longer: a course's score ends at 1.
        if self.state["best"] is None or row["score"] >= self.state["best"]["score"]:
            self.learner.save(self.model, self.normalise, self.folder, BEST)
            self.state["best"] = {"steps": self.steps, "score": row["score"]}
        self.state["evaluated"] = self.state["rollout"]
        self.clock.spent["evaluation"] += time.perf_counter() - begin
        told = {"rollout": self.state["rollout"], "steps": self.steps, "zero": self.state["zero"]["score"]} | row
        self._evaluations.add(told)
        self._board.add("evaluation", self.steps, told)

    def _save(self) -> None:
        self.state["spent"] = dict(self.clock.spent)
        kept = self.state | {"terms": self.envs.kept(), "plan": _of_run(self.plan)}
        checkpoint.save(self.folder, self.model, self.normalise, kept)


class _ForwardTime:
    """Wall time of the policy's forward passes while a rollout is collected, s."""

    def __init__(self, policy: torch.nn.Module) -> None:
        self.seconds = self._begin = 0.0
        policy.register_forward_pre_hook(self._before)
        policy.register_forward_hook(self._after)

    def _before(self, *_: Any) -> None:
        self._begin = time.perf_counter()

    def _after(self, *_: Any) -> None:
        self.seconds += time.perf_counter() - self._begin
