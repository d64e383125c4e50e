"""Hierarchical policies in training: what members see and do, the three stages, and resuming between them."""

from __future__ import annotations

import shutil
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
import training

import crossgait
from crossgait import ConfigError
from crossgait.sweep.strict_yaml import write_yaml
from crossgait.train import Plan, hierarchy
from crossgait.train.environments import TrainingEnvs
from crossgait.train.hierarchy import Hierarchy
from crossgait.train.members import Pace
from crossgait.train.record import read
from crossgait.train.trainer import PROGRESS, Trainer
from crossgait.train.two_pace_policy import TwoPacePolicy

PARTS = ("planner", "residual", "together")
HIERARCHY: dict[str, Any] = {
    "planner_dt": 0.1,  # five steps; episodes have 25
    "planner": {"observation": ["v_WB.", "param."], "set": {"algorithm": {"n_steps": 8, "batch_size": 16}}},
    "together": {"set": {"algorithm": {"learning_rate": 0.0001}}},
}


def plan(**changes: Any) -> Plan:
    said = {"hierarchy": HIERARCHY, "steps": 320, "evaluation": training.SMALL["evaluation"] | {"every": 160}}
    return Plan.parse(training.small(**(said | changes)), "train.yaml")


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run of the command that nothing stopped."""
    at = tmp_path_factory.mktemp("finished")
    (at / "train.yaml").write_text(plan().to_yaml())
    training.done(["-m", "crossgait.train", "train.yaml", "--out", "run"], at)
    return at


@pytest.mark.parametrize(
    ("changes", "element"),
    [
        ({"planner_dt": 0.03}, "hierarchy.planner_dt"),
        ({"planner_dt": 0.001}, "hierarchy.planner_dt"),
        ({"planer": {}}, "hierarchy.planer"),
        ({"planner": {"observation": ["v"]}}, "hierarchy.planner: observation v"),
        ({"residual": {"steps": 0}}, "hierarchy.residual.steps"),
        ({"residual": {"set": {"environment": {}}}}, "hierarchy.residual.set.environment"),
        ({"together": {"set": {"algorithm": {"n_stepss": 3}}}}, "algorithm.n_stepss"),
    ],
)
def test_what_is_wrong_is_named(changes: dict[str, Any], element: str) -> None:
    with pytest.raises(ConfigError) as raised:
        plan(hierarchy=HIERARCHY | changes)
    assert element in raised.value.element


def test_parts_are_the_file_with_their_own_keys_over_it() -> None:
    made = plan(hierarchy=HIERARCHY | {"residual": {"steps": 480, "set": {"network": {"activation": "elu"}}}})
    assert list(made.parts) == list(PARTS)
    planner, residual, together = made.parts.values()
    assert planner.stages[0].environment.policy_dt == 0.1
    assert planner.evaluated.policy_dt == residual.stages[0].environment.policy_dt == 0.02
    assert (planner["algorithm"]["n_steps"], planner["algorithm"]["n_epochs"]) == (8, 2)
    assert (planner["steps"], residual["steps"], together["steps"]) == (320, 480, 320)
    assert residual["network"] == made["network"] | {"activation": "elu"}
    assert (residual["normalise"]["observation"], together["normalise"]["observation"]) == (True, False)


def test_a_plan_is_due_at_the_beginning_and_every_so_often() -> None:
    pace = Pace(2, 3)
    seen = []
    for step in range(8):
        seen.append(pace.due.tolist())
        ended = pace.advance(np.array([False, step == 4]))
        if step == 4:
            assert ended.tolist() == [False, False]  # the sixth step would have none
    assert [row[0] for row in seen] == [True, False, False, True, False, False, True, False]
    assert [row[1] for row in seen] == [True, False, False, True, False, True, False, False]  # anew after the fifth


def _make(tmp_path: Path) -> list[tuple[str, Trainer, Path]]:
    """Every part, trained for a rollout or two, with the file of its last policy."""
    made = plan()
    trained = []
    for name, learner in hierarchy._learners(made, tmp_path):
        folder = tmp_path / name
        folder.mkdir()
        trainer = Trainer(made.parts[name], folder, resume=False, learner=learner, title=name)
        trainer.run()
        trained.append((name, trainer, folder / "last.yaml"))
    return trained


def test_members_walk_in_training_as_the_description_does_in_the_core(tmp_path: Path) -> None:
    """Step by step: the same rewards, through the end of an episode into the next."""
    for name, trainer, file in _make(tmp_path):
        stage = trainer.plan.stages[0]
        trainer.envs.begin(stage, 5)
        model, normalise = trainer.model, trainer.normalise
        normalise.training = False
        observations = normalise.reset()
        policies = [crossgait.Policy.load(file, stage.environment) for _ in range(trainer.envs.num_envs)]
        alone = [
            _Alone(policy, stage.environment, seed) for policy, seed in zip(policies, _seeds(trainer), strict=True)
        ]
        acted = 0.0
        for _ in range(40):
            actions, _ = model.predict(observations, deterministic=True)  # type: ignore[arg-type]
            observations, _, dones, infos = normalise.step(actions)
            for i, one in enumerate(alone):
                reward = one.step()
                acted = max(acted, one.acted)
                # Observations are float32 here and float64 there.
                assert normalise.get_original_reward()[i] == pytest.approx(reward, abs=2e-5), name
                if dones[i]:
                    one.begin(_seeds(trainer)[i])
                    assert len(infos[i]["terminal_observation"]) == trainer.normalise.observation_space.shape[0]  # type: ignore[index]
        assert acted > 1e-3, name
        trainer.envs.close()


class _Alone:
    """A single environment under a policy of the core."""

    def __init__(self, policy: crossgait.Policy, environment: crossgait.EnvironmentConfig, seed: int) -> None:
        self.policy, self.env = policy, crossgait.envs.AdaptiveGaitEnv(environment)
        self.acted = 0.0
        self.begin(seed)

    def begin(self, seed: int) -> None:
        self.observation, _ = self.env.reset(seed=seed)
        self.policy.reset()

    def step(self) -> float:
        action = self.policy.act(self.observation)
        self.acted = float(np.abs(action).max())
        self.observation, reward, *_ = self.env.step(action)
        return float(reward)


def _seeds(trainer: Trainer) -> list[int]:
    return [int(seed) for seed in trainer.envs.get_attr("episode_seed")]


def test_both_together_begin_as_the_members_end(tmp_path: Path) -> None:
    trained = _make(tmp_path)
    made = plan()
    h = Hierarchy.of(made)
    together = hierarchy.BothTogether(h, tmp_path / "planner", tmp_path / "residual")
    (tmp_path / "fresh").mkdir()
    fresh = Trainer(made.parts["together"], tmp_path / "fresh", resume=False, learner=together)
    policy = fresh.model.policy
    assert isinstance(policy, TwoPacePolicy)
    seen = np.random.default_rng(0).normal(size=(20, policy.observation_space.shape[0])).astype(np.float32)  # type: ignore[index]
    seen[:, -1] = np.arange(20) % 2
    given = torch.as_tensor(seen)
    with torch.no_grad():
        actions, values, log_prob = policy(given, deterministic=True)
    for name, member in (("planner", h.planner), ("residual", h.residual)):
        bundle = hierarchy.read_bundle(tmp_path / name, name)
        own = bundle.network.evaluate(seen[:, member.observation].astype(np.float64))
        np.testing.assert_allclose(actions[:, torch.as_tensor(member.action)], own, atol=1e-5)  # float32
    fast = trained[1][1]
    theirs = fast.model.policy.predict_values(
        torch.as_tensor(fast.normalise.normalize_obs(seen[:, h.residual.observation]))
    )
    np.testing.assert_allclose(values, theirs.detach(), atol=1e-4)
    # At the mean a Gaussian's log probability is that of its widths alone, of the actions that count.
    each = -policy.log_std.detach() - 0.5 * np.log(2 * np.pi)
    fine = each[torch.as_tensor(h.residual.action)].sum()
    np.testing.assert_allclose(log_prob, np.where(seen[:, -1] == 1, each.sum(), fine), rtol=1e-5)


def test_a_planner_learns_from_the_steps_in_which_it_plans_alone(tmp_path: Path) -> None:
    *_, (_, trainer, _) = _make(tmp_path)
    policy = trainer.model.policy
    assert isinstance(policy, TwoPacePolicy)
    for due in (0.0, 1.0):
        policy.zero_grad()
        seen = torch.randn(6, policy.observation_space.shape[0])  # type: ignore[index]
        seen[:, -1] = due
        actions = torch.randn(6, 14)
        _, log_prob, entropy = policy.evaluate_actions(seen, actions)
        (log_prob.sum() + entropy.sum()).backward()  # type: ignore[no-untyped-call]
        planner = sum(float(p.grad.abs().sum()) for p in policy.planner.parameters() if p.grad is not None)
        assert (planner > 0) == (due == 1)
        assert any(float(p.grad.abs().sum()) > 0 for p in policy.residual.parameters() if p.grad is not None)
        widths = policy.log_std.grad
        assert widths is not None
        assert (widths[:2].abs().sum() > 0) == (due == 1)
        assert (widths[2:] != 0).all()


def test_one_command_trains_all_parts_and_says_what_each_is_worth(finished: Path) -> None:
    run = finished / "run"
    for name in PARTS:
        assert [row["steps"] for row in read(run / name / PROGRESS)][-1] == 320
    environment = crossgait.EnvironmentConfig.load(str(run / "environment.yaml"))
    assert environment.policy_dt == 0.02
    done = crossgait.rollout(str(run / "best.yaml"), environment)
    assert done.document["policies"][0]["all"]["episodes"] == 3
    card = (run / "card.md").read_text()
    for words in (
        "| mujoco | planner |",
        "| mujoco | residual |",
        "| mujoco | together |",
        "| mujoco | zero |",
        "of 0.1 s",
    ):
        assert words in card, words
    for name in PARTS:
        assert f"({name}/learning-curve.png)" in card
        assert (run / name / "learning-curve.png").stat().st_size > 1000
    best = max(PARTS, key=lambda name: max(row["score"] for row in read(run / name / "evaluations.csv")))
    assert (run / "best.yaml").read_bytes() == (run / best / "best.yaml").read_bytes()
    for folder in (run, *(run / name for name in PARTS)):  # no bundle that nothing names
        named = {
            name
            for file in ("best.yaml", "last.yaml")
            if (folder / file).exists()
            for name in hierarchy.bundles_of(folder / file)
        }
        assert {path.name for path in folder.glob("*.safetensors")} == named


@pytest.mark.long
def test_killed_in_any_part_and_resumed_is_never_stopped(finished: Path, tmp_path: Path) -> None:
    shutil.copy(finished / "train.yaml", tmp_path)
    run = tmp_path / "run"
    arguments = ["-m", "crossgait.train", "train.yaml", "--out", "run"]
    for name in PARTS:
        checkpoint = run / name / "checkpoint.pt"
        process = training.command(arguments, tmp_path)
        end = time.monotonic() + 600
        while not checkpoint.exists():
            assert process.poll() is None, process.communicate()[1]
            assert time.monotonic() < end
            time.sleep(0.005)
        process.kill()
        process.communicate()
        arguments = ["-m", "crossgait.train", "--resume", "--out", "run"]
    training.done(arguments, tmp_path)
    for path in sorted((finished / "run").rglob("*")):
        if path.suffix in (".safetensors", ".yaml") or path.name == "evaluations.csv":
            ours = run / path.relative_to(finished / "run")
            assert ours.read_bytes() == path.read_bytes(), path


def test_the_ground_of_a_part_changes_by_its_own_steps(tmp_path: Path) -> None:
    """A share of the environments is on another ground, under each member."""
    mix = [{"share": 3}, {"share": 1, "set": {"terrain": "stairs"}}]
    made = plan(curriculum=[{"mix": mix}])
    envs = TrainingEnvs(made.parts["planner"])
    assert [config.terrain for config in envs.get_attr("config")] == ["rough"] * 3 + ["stairs"]
    assert {config.policy_dt for config in envs.get_attr("config")} == {0.1}
    (tmp_path / "a.yaml").write_text(write_yaml(made.document))
    assert Plan.load(tmp_path / "a.yaml").document == made.document
