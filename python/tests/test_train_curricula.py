"""What terms keep from rollout to rollout: curricula whose rollouts workers collect, and runs that go on."""

from __future__ import annotations

import os
import signal
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import training

from crossgait import Batch, ConfigError, terms
from crossgait.sweep import Outcome, ProcessPool
from crossgait.terms.kept import plain

pytest.importorskip("stable_baselines3")

from test_train_remote import Here, plan, rollouts, same

from crossgait.train import Plan
from crossgait.train.remote_envs import RemoteEnvs
from crossgait.train.trainer import Trainer

STEP = 0.1  #: of the level, for each episode that is over


class Levels:
    """A level that rises with episodes; what it asks for follows it."""

    def __init__(self) -> None:
        self.level, self.lengths = 0.0, np.zeros(0)

    def __call__(self, env: Batch, indices: np.ndarray) -> None:
        self.level += STEP * len(indices)
        self.lengths = np.append(self.lengths, env.time[indices])

    def command(self, env: Batch, indices: np.ndarray) -> None:
        env.set_commands([self.level, 0, 0], indices.tolist())

    def paid(self, env: Batch) -> np.ndarray:
        return env.commands[:, 0].copy()

    def state(self) -> dict[str, Any]:
        return {"level": self.level, "lengths": self.lengths}

    def restore(self, state: dict[str, Any]) -> None:
        self.level, self.lengths = state["level"], state["lengths"]


class Silent(Levels):
    state = restore = None  # type: ignore[assignment]


@dataclass
class Asked:
    """Nothing to be called itself."""

    times: int

    def ask(self, env: Batch, indices: np.ndarray) -> None:
        self.times += 1


class Told(Asked):
    def state(self) -> int:
        return self.times

    def restore(self, state: int) -> None:
        self.times = state


def slippery(env: Batch, indices: np.ndarray) -> None:
    """What an environment's own parameters say is a state as well."""
    for i in map(int, indices):
        env.set_parameters({"friction": 0.9 * env.parameters[i].get("friction", 1.0)}, [i])


def friction(env: Batch) -> np.ndarray:
    return np.array([one["friction"] for one in env.parameters])


def mass(env: Batch) -> np.ndarray:
    return np.array([one["mass"] for one in env.parameters])


def mine(levels: Levels | None = None) -> terms.Terms:
    levels = levels or Levels()
    drawn = {"friction": (0.5, 1.5), "mass": (0.7, 0.8)}
    return terms.Terms(
        rewards={
            "paid": terms.RewardTerm(levels.paid),
            "friction": terms.RewardTerm(friction),
            "mass": terms.RewardTerm(mass),
        },
        events={
            "start": terms.EventTerm(terms.set_parameters_uniform, "startup", params=drawn),
            "command": terms.EventTerm(levels.command),
        },
        curriculum={"level": terms.CurriculumTerm(levels), "slippery": terms.CurriculumTerm(slippery)},
    )


def states(envs: RemoteEnvs) -> list[dict[str, Any]]:
    kept = envs.kept()
    assert kept is not None
    return [part["states"]["curriculum.level"] for part in kept["parts"]]


def test_the_state_of_a_curriculum_follows_its_episodes() -> None:
    _, envs = rollouts(plan().with_terms(mine()), 3)
    for state in states(envs):
        # Eight steps of a rollout are an episode of five and one that is cut off after three: of two environments in
        # three rollouts twelve, in whose time the robot does not fall.
        np.testing.assert_allclose(state["lengths"], np.tile([0.1, 0.1, 0.06, 0.06], 3))
        assert state["level"] == pytest.approx(12 * STEP)
    # The third rollout began with eight episodes behind it, and after five steps there were two more.
    numbers = envs.tally.numbers()
    assert numbers["reward.paid"] == pytest.approx((5 * 8 + 3 * 10) / 8 * STEP)
    for part in envs.kept()["parts"]:  # type: ignore[index]
        assert part["started"]
        # Drawn as the environments were made, once, and multiplied by each episode since.
        values = np.array([one["friction"] for one in part["parameters"]])
        assert ((values > 0.5 * 0.9**6) & (values < 1.5 * 0.9**6)).all()


def test_what_was_drawn_at_the_start_stays() -> None:
    made = plan().with_terms(mine())
    one, three = (rollouts(made, count)[1] for count in (1, 3))
    for a, b in zip(one.kept()["parts"], three.kept()["parts"], strict=True):  # type: ignore[index]
        assert [x["mass"] for x in a["parameters"]] == [x["mass"] for x in b["parameters"]]
        ratio = [y["friction"] / x["friction"] for x, y in zip(a["parameters"], b["parameters"], strict=True)]
        assert ratio == pytest.approx([0.9**4] * 2)
    assert one.tally.numbers()["reward.mass"] == pytest.approx(three.tally.numbers()["reward.mass"])


def test_curricula_do_not_depend_on_who_made_a_rollout_when() -> None:
    made = plan().with_terms(mine())
    kept, envs = rollouts(made, 3)
    again, lost = rollouts(made, 3, losses={0: ["lost", "lost"], 1: ["crashed"], 2: ["lost"]}, reverse=True)
    assert lost.lost == 4
    assert same(again, kept)
    assert str(lost.kept()) == str(envs.kept())
    assert lost.tally.numbers() == envs.tally.numbers()


@pytest.mark.parametrize("count", [1, 2, 3])
def test_processes_make_the_same_bits_also_where_one_is_killed(count: int) -> None:
    made = plan().with_terms(mine())
    due = [True] * (count > 1)

    def workers(make: Any) -> ProcessPool[Any, Any]:
        pool: ProcessPool[Any, Any] = ProcessPool(count, make)
        wait = pool.wait

        def waited(seconds: float) -> list[Outcome[Any, Any]]:
            outcomes = wait(seconds)
            busy = [worker for worker in pool._all if worker.tasks]
            if outcomes and busy and due:  # while other blocks are under way
                due.clear()
                os.kill(busy[0].process.pid, signal.SIGKILL)
            return outcomes

        pool.wait = waited  # type: ignore[method-assign]
        return pool

    kept, envs = rollouts(made, 3, workers=workers)
    envs.close()
    assert (envs.lost > 0) == (count > 1)
    here, reference = rollouts(made, 3)
    assert same(kept, here)
    assert str(envs.kept()) == str(reference.kept())


def staged(**changes: Any) -> Plan:
    """Two stages of two rollouts each, the second on two grounds, with commands of their own."""
    command = {"vx": [0.0, 0.3]}
    mix = [{"set": {"terrain": "rough"}, "command": command}, {"share": 2, "command": {"vx": [0.3, 0.6]}}]
    stages = [{"command": command}, {"from": 96, "mix": mix}]
    environment = training.SMALL["environment"] | {
        "terrain": "flat",
        "episode_seconds": 0.1,
        "observation": ["command"],
    }
    said = {"environment": environment, "curriculum": stages, "steps": 192}
    said["evaluation"] = training.SMALL["evaluation"] | {"every": 10_000}
    return plan(**said | changes)


def trained(made: Plan, folder: Path, resume: bool = False, **how: Any) -> tuple[bytes, list[list[str]]]:
    """The last policy, and the columns of progress.csv that are not of the clock."""
    folder.mkdir(exist_ok=True)
    Trainer(made, folder, resume=resume, progress=False, workers=partial(Here, **how) if made["block"] else None).run()
    rows = [line.split(",") for line in (folder / "progress.csv").read_text().splitlines()]
    columns = [i for i, name in enumerate(rows[0]) if name not in training.TIMES]
    return (folder / "last.safetensors").read_bytes(), [[row[i] for i in columns] for row in rows]


def test_stages_of_the_file_do_not_depend_on_workers(tmp_path: Path) -> None:
    policy, rows = trained(staged(), tmp_path / "one")
    assert [row[rows[0].index("stage")] for row in rows[1:]] == ["0", "0", "1", "1"]
    again = trained(staged(), tmp_path / "other", losses={0: ["lost"], 2: ["lost", "crashed"]}, reverse=True)
    assert again == (policy, rows)
    # The second stage is another one: without it other policies come out.
    assert trained(staged(curriculum=[{"command": {"vx": [0.0, 0.3]}}]), tmp_path / "third")[0] != policy


@pytest.mark.parametrize("block", [2, None])
def test_a_run_that_goes_on_is_the_same_with_curricula(tmp_path: Path, block: int | None) -> None:
    def made(steps: int) -> Plan:
        rate = training.SMALL["algorithm"] | {"n_steps": 8, "batch_size": 12, "n_epochs": 1, "learning_rate": 1e-3}
        return staged(block=block, steps=steps, algorithm=rate).with_terms(mine())

    whole = trained(made(288), tmp_path / "whole")
    for steps in (48, 144, 288):  # stops within either stage
        stopped = trained(made(steps), tmp_path / "stopped", resume=True)
    assert stopped == whole


def test_without_workers_another_ground_of_a_batch_has_its_own_terms(tmp_path: Path) -> None:
    trainer = Trainer(staged(block=None).with_terms(mine()), tmp_path, resume=False, progress=False)
    trainer.run()
    kept = trainer.envs.kept()
    assert kept is not None
    assert kept["stage"] == 1
    counts = [len(part["parameters"]) for part in kept["parts"]]
    assert counts == [2, 4]
    levels = [part["states"]["curriculum.level"]["level"] for part in kept["parts"]]
    assert levels == pytest.approx([STEP * 2 * 2 * count for count in counts])  # of two rollouts, and none before


def test_what_would_be_forgotten_is_said() -> None:
    with pytest.raises(ConfigError, match=r"terms: curriculum.level: expected state\(\) and restore\(state\)"):
        rollouts(plan().with_terms(mine(Silent())))
    # Also of one that is a method.
    asked = terms.Terms(curriculum={"asked": terms.CurriculumTerm(Asked(0).ask)})
    with pytest.raises(ConfigError, match=r"curriculum.asked: expected state\(\) and restore\(state\)"):
        rollouts(plan().with_terms(asked), 1)
    told = terms.Terms(curriculum={"told": terms.CurriculumTerm(Told(0).ask)})
    _, envs = rollouts(plan().with_terms(told), 2)
    assert [part["states"] for part in envs.kept()["parts"]] == [{"curriculum.told": 4}] * 3  # type: ignore[index]
    # One that keeps nothing is as any function.
    nothing = terms.Terms(curriculum={"slippery": terms.CurriculumTerm(terms.set_parameters_uniform)})
    rollouts(plan().with_terms(nothing), 1)

    half = type("Half", (), {"state": lambda self: 0, "__call__": lambda self, env, indices: None})
    with pytest.raises(ConfigError, match=r"curriculum.half: expected a restore\(state\) beside its state\(\)"):
        Trainer(
            plan(block=None).with_terms(terms.Terms(curriculum={"half": terms.CurriculumTerm(half())})),
            Path(),
            resume=False,
        )


def test_states_are_plain() -> None:
    kept = {"a": [1, 2.5, None, True, "x"], "b": (np.arange(3), np.float32(0.5)), 3: {"c": np.zeros((2, 2), bool)}}
    copied = plain(kept, "here")
    assert str(copied) == str(kept | {"b": (np.arange(3), 0.5)})
    kept["b"][0][0] = 7  # type: ignore[index]
    assert copied["b"][0][0] == 0
    for wrong in ({1, 2}, np.array(["x"]), object(), {None: 1}):
        with pytest.raises(ConfigError, match=r"terms: here: expected numbers, texts, lists, dicts and arrays"):
            plain({"a": wrong}, "here")


def test_evaluations_are_without_curricula() -> None:
    made = plan().with_terms(mine())
    assert made.evaluated.terms.curriculum == {}
    assert list(made.evaluated.terms.rewards) == ["paid", "friction", "mass"]
    assert made.without_terms()[1] is not None
    assert list(made.without_terms()[1].curriculum) == ["level", "slippery"]  # type: ignore[union-attr]
