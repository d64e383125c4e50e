from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import time
import types
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
import training

import crossgait
from crossgait import ConfigError, _core
from crossgait.sb3 import CrossgaitVecEnv
from crossgait.sweep.strict_yaml import write_yaml
from crossgait.train import Plan, folder, presets
from crossgait.train.environments import TrainingEnvs
from crossgait.train.record import Board, Table, read
from crossgait.train.trainer import EVALUATIONS, PROGRESS, Clock, Trainer

BEST, LAST = "best.safetensors", "last.safetensors"
TWO = crossgait.available_engines()[::2][:2]  # of different laws, where there are more


def plan(**changes: Any) -> Plan:
    return Plan.parse(training.small(**changes), "train.yaml")


# ---- configuration


@pytest.mark.parametrize(
    ("changes", "element"),
    [
        ({"step": 3}, "step"),
        ({"steps": 0}, "steps"),
        ({"steps": True}, "steps"),
        ({"seed": -1}, "seed"),
        ({"environment": {"terain": "flat"}}, "terain"),
        ({"environment": {"engine": "mujoco"}}, "environment.engine"),
        ({"curriculum": [{"set": {"engine": "mujoco"}}]}, "curriculum[0].set.engine"),
        ({"evaluation": {"set": {"engine": "mujoco"}}}, "evaluation.set.engine"),
        ({"environment": {"reward": {"forwards": 1}}}, "reward"),
        ({"environment": "nowhere.yaml"}, "file"),
        ({"engines": {"havok": 1}}, "engines: havok"),
        ({"engines": {"mujoco": 0}}, "engines"),
        ({"engines": {TWO[0]: 1, TWO[-1]: 1000}, "environments": 2}, "environments"),
        ({"algorithm": {"n_stepss": 3}}, "algorithm.n_stepss"),
        ({"algorithm": 3}, "algorithm"),
        ({"algorithm": {"batch_size": 10_000, "n_steps": 40}}, "algorithm.batch_size"),
        ({"algorithm": {"learning_rate": [1e-3, -1]}}, "algorithm.learning_rate"),
        ({"network": {"activation": "sine"}}, "network.activation"),
        ({"network": {"hidden": [0]}}, "network.hidden"),
        ({"randomisation": {"gravity": [1, 2]}}, "gravity"),
        ({"curriculum": [{"from": 5}]}, "curriculum[0].from"),
        ({"curriculum": [{"from": 0}, {"from": 0}]}, "curriculum[1].from"),
        ({"curriculum": [{"until": 0}]}, "curriculum[0].until"),
        ({"curriculum": [{"command": {"vz": [0, 1]}}]}, "curriculum[0].command.vz"),
        ({"curriculum": [{"command": {"vx": [1, 0]}}]}, "curriculum[0].command.vx"),
        ({"curriculum": [{}, {"from": 9, "set": {"adapt": ["step_height"]}}]}, "curriculum[1].set"),
        ({"evaluation": {"terrain_seeds": [10, 30]}}, "evaluation.terrain_seeds"),
        ({"evaluation": {"score": "beauty"}}, "evaluation.score"),
        ({"evaluation": {"set": {"adapt": ["step_height"]}}}, "evaluation.set"),
        ({"evaluation": {"engines": ["havok"]}}, "evaluation.engines: havok"),
        ({"evaluation": {"score": "course", "course": "easy"}}, "evaluation.course"),
        ({"curriculum": [{"mix": [{"shares": 1}]}]}, "curriculum[0].mix[0].shares"),
        ({"curriculum": [{"mix": [{"share": 0}]}]}, "curriculum[0].mix[0].share"),
        ({"curriculum": [{"mix": [{}, {"command": {"vx": [2, 1]}}]}]}, "curriculum[0].mix[1].command.vx"),
        ({"curriculum": [{"mix": [{}, {"set": {"adapt": ["step_height"]}}]}]}, "curriculum[0].mix[1].set"),
        ({"curriculum": [{"mix": [{"share": 9}, {"share": 1, "set": {"terrain": "flat"}}]}]}, "curriculum[0].mix"),
        (
            {"curriculum": [{"mix": [{}, {"set": {"randomisation": {"terrain_seed": [1000005, 1000006]}}}]}]},
            "terrain_seeds",
        ),
    ],
)
def test_what_is_wrong_is_named(changes: dict[str, Any], element: str) -> None:
    with pytest.raises(ConfigError) as raised:
        plan(**changes)
    assert element in raised.value.element
    assert "line" not in raised.value.element  # of what is no file


def test_the_command_ends_with_2_for_what_is_wrong(tmp_path: Path) -> None:
    (tmp_path / "a.yaml").write_text("steps: 5\nsteps: 6\n")
    for arguments, words in (
        (["a.yaml"], "a.yaml: line 2: expected YAML, found steps stands there twice"),
        (["nowhere.yaml"], "nowhere.yaml: file"),
        (["--preset", "flying"], "preset: expected one of adaptive"),
        (["--preset", "adaptive", "--set", "steps"], "expected KEY=VALUE"),
        (["--preset", "adaptive", "--set", "algorithm.n_step=4"], "unknown key 'n_step' (did you mean n_steps?)"),
        (["--resume", "--out", "nowhere"], "no config.yaml"),
        ([], "either CONFIG.yaml or --preset"),
    ):
        out, err = training.done(["-m", "crossgait.train", *arguments], tmp_path, code=2)
        assert out == ""
        assert words in err
        assert err.count("\n") == 1
    assert [path.name for path in tmp_path.iterdir()] == ["a.yaml"]


def test_everything_that_is_printed_is_read_back(tmp_path: Path) -> None:
    for made in (*map(Plan.preset, presets()), plan()):
        file = tmp_path / "again.yaml"
        file.write_text(made.to_yaml())
        again = Plan.load(file)
        assert again.document == made.document
        assert [s.environment for s in again.stages] == [s.environment for s in made.stages]
        assert again.evaluated == made.evaluated


def test_files_are_found_from_the_folder_of_the_file_that_names_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    terrains = Path(crossgait.models_dir()) / "terrains"
    (tmp_path / "there").mkdir()
    for name in ("blocks.csv", "bumps.png"):
        shutil.copy(terrains / name, tmp_path / "there")
    environment = training.SMALL["environment"] | {"terrain": "blocks.csv"}
    said = training.small(environment=environment, curriculum=[{"set": {"terrain": "bumps.png:z_max=.02"}}])
    (tmp_path / "there/train.yaml").write_text(write_yaml(said))
    monkeypatch.chdir(tmp_path)
    made = Plan.load("there/train.yaml")
    assert made["environment"]["terrain"] == str(tmp_path / "there/blocks.csv")
    assert made.evaluated.terrain == f"{tmp_path}/there/bumps.png:z_max=.02"
    (tmp_path / "there/environment.yaml").write_text(made.stages[0].environment.to_yaml())
    (tmp_path / "other.yaml").write_text(write_yaml(training.small(environment="there/environment.yaml")))
    assert Plan.load("other.yaml").evaluated.terrain == made.evaluated.terrain


def test_presets_are_what_their_names_say() -> None:
    sizes = {}
    for name in presets():
        interface = _core.PolicyInterface(Plan.preset(name).evaluated)
        sizes[name] = (len(interface.action_layout), len(interface.observation_layout))
    assert sizes == {
        "adaptive": (16, 69),
        "adaptive-terrain": (16, 77),
        "guide": (16, 69),
        "hierarchical": (18, 72),
        "joints": (12, 48),
    }
    changed = Plan.preset("adaptive", ["algorithm.n_steps=64", "algorithm.batch_size=64", "environment.friction=1e-1"])
    assert changed["algorithm"]["n_steps"] == 64
    assert changed["environment"]["friction"] == 0.1


def test_engines_and_environments_go_by_name() -> None:
    for engines in (TWO, ",".join(TWO), ", ".join(TWO)):
        assert plan(engines=engines).engines == plan(engines=dict.fromkeys(TWO, 1)).engines
    said = training.SMALL["evaluation"]
    assert plan(evaluation=said | {"engines": ",".join(TWO)}).evaluation_engines == TWO
    beside = Path(crossgait.models_dir()) / "policies/serial_joints/environment.yaml"
    seeds = {"terrain_seed": [0, 5]}  # its own are those of evaluations
    by_name, by_file = (plan(environment=text, randomisation=seeds) for text in ("serial_joints", str(beside)))
    assert by_name.document == by_file.document
    assert by_name.stages[0].environment.robot == "serial_quadruped"
    for engines in ([], "", [3], {"mujoco": 0}):
        with pytest.raises(ConfigError, match="engines: expected engines by name, or with shares above zero"):
            plan(engines=engines)


def test_environments_are_shared_out() -> None:
    shares = {"mujoco": 0.5, "bullet": 0.25, "bullet:matched": 0.25}
    made = [name for name in shares if name in crossgait.available_engines()]
    counts = dict(plan(engines={name: shares[name] for name in made}, environments=9).engines)
    assert sum(counts.values()) == 9
    assert max(counts, key=lambda name: counts[name]) == made[0]


# ---- environments


def test_mixed_engines_are_the_engines_own_environments_side_by_side() -> None:
    made = plan(engines=dict.fromkeys(TWO, 1))
    envs = TrainingEnvs(made)
    envs.begin(made.stages[0], 7)
    parts = []
    for i, (engine, count) in enumerate(made.engines):
        alone = CrossgaitVecEnv("Crossgait/AdaptiveGait-v0", count, config=made.stages[0].environment, engine=engine)
        alone.seed(_core.derived_seed(7, i) % 2**63)
        parts.append(alone)
    np.testing.assert_array_equal(envs.reset(), np.concatenate([part.reset() for part in parts]))
    assert envs.get_attr("engine") == [engine for engine, count in made.engines for _ in range(count)]
    random = np.random.default_rng(0)
    for _ in range(30):
        actions = random.uniform(-1, 1, (4, *envs.action_space.shape)).astype(np.float32)
        seen, rewards, dones, infos = envs.step(actions)
        at = 0
        for part in parts:
            rows = slice(at, at + part.num_envs)
            at += part.num_envs
            expected = part.step(actions[rows])
            np.testing.assert_array_equal(seen[rows], expected[0])
            np.testing.assert_array_equal(rewards[rows], expected[1])
            np.testing.assert_array_equal(dones[rows], expected[2])
            for mine, theirs in zip(infos[rows], expected[3], strict=True):
                assert mine["distance"] == theirs["distance"]
    told = envs.tally.numbers()
    assert told["episodes_ended"] == 4  # 25 steps each
    assert told["reward"] == pytest.approx(told["reward.forward_velocity"], rel=1e-5)  # rewards are float32


def test_commands_are_drawn_for_every_episode_and_seen_from_its_first_observation() -> None:
    stage = {"command": {"vx": [0.1, 0.5], "yaw_rate": [-1, 1]}}
    environment = training.SMALL["environment"] | {
        "command": {"vx": 0.2, "vy": 0.05, "yaw_rate": 0},
        "observation": [{"block": "command", "scale": [2, 2, 0.25], "clip": 0.9}],
    }
    made = plan(environment=environment, curriculum=[stage])
    envs = TrainingEnvs(made)
    envs.begin(made.stages[0], 3)
    seen = envs.reset()
    assert len(np.unique(seen[:, 0])) == 4
    np.testing.assert_allclose(seen[:, 1], 0.1, rtol=1e-6)
    assert (np.abs(seen) <= 0.9).all()
    changes = 0
    for _ in range(60):
        now, _, dones, _ = envs.step(np.zeros((4, *envs.action_space.shape), np.float32))
        np.testing.assert_allclose(now[~dones], seen[~dones], rtol=1e-6)  # as the core shows it, float32
        changes += int((now[dones, 0] != seen[dones, 0]).sum())
        seen = now
    assert changes == 8  # two episodes each have ended
    envs.begin(made.stages[0], 3)
    first = envs.reset()
    envs.begin(made.stages[0], 4)
    assert not np.array_equal(first, envs.reset())


def test_a_stage_changes_the_ground() -> None:
    made = plan(curriculum=[{"set": {"terrain": "flat"}}, {"from": 100, "set": {"terrain": "stairs"}}])
    assert [made.stage(steps).index for steps in (0, 99, 100, 500)] == [0, 0, 1, 1]
    envs = TrainingEnvs(made)
    envs.begin(made.stages[1], 0)
    envs.reset()
    assert [config.terrain for config in envs.get_attr("config")] == ["stairs"] * 4


def test_shares_of_a_stage_meet_grounds_and_commands_of_their_own() -> None:
    mix = [
        {"share": 2, "command": {"vx": [0.1, 0.2]}},
        {
            "share": 1,
            "set": {"terrain": "slope:angle=5", "friction": 0.4},
            "command": {"vx": [0.3, 0.4], "vy": [0.1, 0.1]},
        },
        {"set": {"randomisation": {"push_impulse": [0.1, 0.2], "push_interval": [0.1, 0.2]}}},
    ]
    environment = training.SMALL["environment"] | {
        "command": {"vx": 0.2, "vy": 0, "yaw_rate": 0},
        "observation": ["command"],
    }
    stage = {"set": {"terrain": "stairs"}, "command": {"yaw_rate": [-0.3, -0.2]}, "mix": mix}
    made = plan(environment=environment, curriculum=[stage], engines=dict.fromkeys(TWO, 1), environments=8)
    dealt = [(engine, share.share, count) for engine, share, count in made.shared_out(made.stages[0])]
    assert dealt == [(engine, share, count) for engine in TWO for share, count in ((2.0, 2), (1.0, 1), (1.0, 1))]
    envs = TrainingEnvs(made)
    envs.begin(made.stages[0], 3)
    seen = envs.reset()
    terrains = [config.terrain for config in envs.get_attr("config")]
    assert terrains == ["stairs", "stairs", "slope:angle=5", "stairs"] * len(TWO)
    frictions = [config.friction for config in envs.get_attr("config")]
    assert frictions == [None, None, 0.4, None] * len(TWO)
    for row, (low, high) in enumerate([(0.1, 0.2), (0.1, 0.2), (0.3, 0.4), (0.2, 0.2)]):
        assert ((low - 1e-6 <= seen[row::4, 0]) & (seen[row::4, 0] <= high + 1e-6)).all()
    assert ((seen[:, 2] >= -0.3 - 1e-6) & (seen[:, 2] <= -0.2 + 1e-6)).all()  # the stage's, for every share
    np.testing.assert_allclose(seen[:, 1], [0, 0, 0.1, 0] * len(TWO), atol=1e-7)


# ---- runs


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run of the command in two engines, with two stages, that nothing stopped."""
    at = tmp_path_factory.mktemp("finished")
    curriculum = [{"set": {"terrain": "rough:amplitude=.005"}}, {"from": 300, "command": {"vx": [0.1, 0.3]}}]
    engines = dict.fromkeys(TWO, 1)
    (at / "train.yaml").write_text(write_yaml(training.small(engines=engines, curriculum=curriculum)))
    training.done(["-m", "crossgait.train", "train.yaml", "--out", "run"], at)
    return at


@pytest.mark.long
def test_killed_and_resumed_is_never_stopped(finished: Path, tmp_path: Path) -> None:
    """kill -9 three times, right after a checkpoint and within a rollout; at most that rollout is lost."""
    shutil.copy(finished / "train.yaml", tmp_path)
    run, checkpoint = tmp_path / "run", tmp_path / "run/checkpoint.pt"
    arguments = ["-m", "crossgait.train", "train.yaml", "--out", "run"]
    for wait in (0.0, 0.02, 0.01):  # s, less than the next rollout takes
        before = checkpoint.stat().st_mtime_ns if checkpoint.exists() else 0
        process = training.command(arguments, tmp_path)
        end = time.monotonic() + 600
        while not checkpoint.exists() or checkpoint.stat().st_mtime_ns == before:
            assert process.poll() is None, process.communicate()[1]
            assert time.monotonic() < end
            time.sleep(0.005)
        time.sleep(wait)
        process.kill()
        process.communicate()
        kept = torch.load(checkpoint, weights_only=True)["state"]["rollout"]
        assert kept >= len(read(run / PROGRESS)) - 1
        arguments = ["-m", "crossgait.train", "--resume", "--out", "run"]
    training.done(arguments, tmp_path)
    for name in (BEST, LAST, EVALUATIONS):
        assert (run / name).read_bytes() == (finished / "run" / name).read_bytes(), name
    ours, theirs = read(run / PROGRESS), read(finished / "run" / PROGRESS)
    assert len(ours) == len(theirs) == 4
    for mine, other in zip(ours, theirs, strict=True):
        assert {k: v for k, v in mine.items() if k not in training.TIMES} == {
            k: v for k, v in other.items() if k not in training.TIMES
        }
    commands = [json.loads(line) for line in (run / "commands.jsonl").read_text().splitlines()]
    assert len(commands) == 4


def test_a_run_keeps_files_that_are_not_its_own(tmp_path: Path) -> None:
    (tmp_path / "train.yaml").write_text(write_yaml(training.small()))
    for name in ("walker_v3.safetensors", "progress.csv", "notes.yaml"):
        mine = tmp_path / name.partition(".")[0]
        mine.mkdir()
        (mine / name).write_text("mine")
        arguments = ["-m", "crossgait.train", "train.yaml", "--out", mine.name]
        _, error = training.done(arguments, tmp_path, code=2)
        assert f"expected an empty one, or --resume, found {name}" in error
        assert [each.name for each in mine.iterdir() if not each.name.startswith(".")] == [name]
        assert (mine / name).read_text() == "mine"


def test_a_trainer_takes_no_place_of_another(finished: Path, tmp_path: Path) -> None:
    shutil.copytree(finished / "run", tmp_path / "run")
    with pytest.raises(ConfigError, match="expected an empty one, or resume=True, found a run"):
        Trainer(plan(), tmp_path / "run", resume=False)
    (tmp_path / "run/checkpoint.pt").unlink()
    with pytest.raises(ConfigError, match=r"checkpoint\.pt: file: expected what the run goes on from"):
        Trainer(plan(), tmp_path / "run", resume=True)
    assert (tmp_path / "run" / BEST).read_bytes() == (finished / "run" / BEST).read_bytes()


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("progress.csv", "a,b\n1,2\n", "rollout: expected a number in each row, found none"),
        ("progress.csv", "rollout\nx\n", "rollout: expected a number in each row, found 'x'"),
        ("progress.csv", "rollout,a\n1\n", "line 2: expected as many values as the first has names"),
        ("progress.csv", b"\xff\n", "expected a table of this run, in UTF-8"),
    ],
)
def test_tables_that_are_no_runs_are_refused(
    finished: Path, tmp_path: Path, name: str, text: Any, message: str
) -> None:
    shutil.copytree(finished / "run", tmp_path / "run")
    (tmp_path / "run" / name).write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(ConfigError, match=message):
        Trainer(Plan.load(tmp_path / "run/config.yaml"), tmp_path / "run", resume=True)


@pytest.mark.parametrize(
    "change", [{"rollout": "x"}, {"rollout": -5}, {"spent": "x"}, {"best": {"score": "x"}}, {"terms": [1]}, None]
)
def test_checkpoints_of_other_states_are_refused(finished: Path, tmp_path: Path, change: Any) -> None:
    shutil.copytree(finished / "run", tmp_path / "run")
    document = torch.load(tmp_path / "run/checkpoint.pt", weights_only=True)
    document["state"] = document["state"] | change if change else []
    torch.save(document, tmp_path / "run/checkpoint.pt")
    with pytest.raises(ConfigError, match=r"checkpoint\.pt"):
        Trainer(plan(), tmp_path / "run", resume=True)


def test_links_and_pipes_are_no_files_of_a_run(finished: Path, tmp_path: Path) -> None:
    shutil.copytree(finished / "run", tmp_path / "run")
    (tmp_path / "victim").write_text("mine")
    for make in (lambda file: file.symlink_to(tmp_path / "victim"), os.mkfifo):
        (tmp_path / "run/commands.jsonl").unlink()
        make(tmp_path / "run/commands.jsonl")
        _, error = training.done(["-m", "crossgait.train", "--resume", "--out", "run"], tmp_path, code=2)
        assert "commands.jsonl: expected a file of the run's own, found a link, a pipe or a device" in error
    assert (tmp_path / "victim").read_text() == "mine"


def test_a_folder_of_somebody_elses_runs_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    ran = tmp_path / "ran"
    monitor = tmp_path / "monitor"
    monitor.write_text(f"#!/bin/sh\ntouch {ran}\n")
    monitor.chmod(0o755)

    def git(*arguments: str) -> None:
        subprocess.run(["git", "-C", str(tmp_path), *arguments], check=True, capture_output=True)

    git("init")
    git("-c", "user.name=a", "-c", "user.email=a@b", "commit", "--allow-empty", "--message", "first")
    (tmp_path / ".git/hooks").mkdir(exist_ok=True)
    (tmp_path / ".git/info").mkdir(exist_ok=True)
    shutil.copy(monitor, tmp_path / ".git/hooks/post-index-change")
    (tmp_path / ".git/info/attributes").write_text("*.yaml filter=x\n")
    (tmp_path / "a.yaml").write_text("a")
    git("add", "a.yaml")
    git("-c", "user.name=a", "-c", "user.email=a@b", "commit", "--message", "second")
    git("config", "filter.x.clean", f"touch {ran}; cat")
    git("config", "core.fsmonitor", str(monitor))
    os.utime(tmp_path / "a.yaml", (1, 1))
    ran.unlink(missing_ok=True)
    git("status")
    assert ran.exists(), "git itself runs it"
    ran.unlink()
    os.utime(tmp_path / "a.yaml", (2, 2))
    monkeypatch.chdir(tmp_path)
    told = folder._git()
    assert told is not None
    assert told["changed"] in ([], ["a.yaml"])  # by its time alone
    assert not ran.exists()


def test_the_folder_tells_what_was_run(finished: Path) -> None:
    run = finished / "run"
    (told,) = map(json.loads, (run / "commands.jsonl").read_text().splitlines())
    assert told["command"][1:] == ["-m", "crossgait.train", "train.yaml", "--out", "run"]
    assert told["seed"] == 0
    assert told["versions"]["crossgait"] == crossgait.__version__
    assert set(TWO) <= set(told["engines"])
    assert "git" in told
    rows = read(run / PROGRESS)
    assert [row["steps"] for row in rows] == [160, 320, 480, 640]
    assert [row["stage"] for row in rows] == [0, 0, 1, 1]
    for column in (
        "reward.forward_velocity",
        "reward.termination",
        "parameter.step_length",
        "falls",
        "swing_contact_ratio",
        "slip_per_path",
    ):
        assert rows[-1][column] is not None, column
    assert rows[0]["parameter.step_length"] != rows[-1]["parameter.step_length"]
    for row in rows:
        assert row["share.physics"] + row["share.learner"] + row["share.python"] == pytest.approx(1)
    card = (run / "card.md").read_text()
    for words in ("train.yaml --out run", "| mujoco | zero |", "physics", "(learning-curve.png)", "forward_velocity 1"):
        assert words in card, words
    for picture in ("learning-curve", "reward-terms", "parameters"):
        assert (run / f"{picture}.png").stat().st_size > 1000
    # What was kept runs by what lies beside it.
    done = crossgait.rollout(str(run / BEST), crossgait.EnvironmentConfig.load(str(run / "environment.yaml")))
    assert done.document["policies"][0]["all"]["episodes"] == 3


def test_a_finished_run_goes_on_with_more_steps(finished: Path, tmp_path: Path) -> None:
    shutil.copytree(finished / "run", tmp_path / "run")
    training.done(["-m", "crossgait.train", "--resume", "--out", "run", "--steps", "700"], tmp_path)
    assert read(tmp_path / "run" / PROGRESS)[-1]["steps"] == 800
    _, err = training.done(["-m", "crossgait.train", "../nowhere.yaml", "--out", "run"], tmp_path, code=2)
    shutil.copy(finished / "train.yaml", tmp_path)
    _, err = training.done(["-m", "crossgait.train", "train.yaml", "--out", "run"], tmp_path, code=2)
    assert "an empty one, or --resume" in err


def test_a_checkpoint_of_another_configuration_is_refused(finished: Path, tmp_path: Path) -> None:
    shutil.copytree(finished / "run", tmp_path / "run")
    with pytest.raises(ConfigError, match=r"checkpoint\.pt"):
        Trainer(plan(network={"hidden": [8]}), tmp_path / "run", resume=True)
    (tmp_path / "run/checkpoint.pt").write_bytes(b"torn")
    with pytest.raises(ConfigError, match=r"checkpoint\.pt"):
        Trainer(plan(), tmp_path / "run", resume=True)


def test_the_policy_that_is_saved_is_that_of_stable_baselines(tmp_path: Path) -> None:
    trainer = Trainer(plan(steps=320), tmp_path, resume=False)
    trainer.run()
    saved = crossgait.Policy.load(tmp_path / LAST, trainer.plan.evaluated)
    raw = np.random.default_rng(0).normal(size=(50, len(saved.layout.observation)))
    theirs, _ = trainer.model.predict(trainer.normalise.normalize_obs(raw.astype(np.float32)), deterministic=True)
    np.testing.assert_allclose([saved.act(row) for row in raw], theirs, atol=1e-5)  # sums in another order
    assert np.abs(theirs).max() > 1e-3


def test_the_best_policy_is_that_of_the_worst_engine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """With made-up evaluations: what is kept is the policy with the largest smallest score."""
    from crossgait.train import evaluation

    scores = iter([{"a": 5.0, "b": 1.0}, {"a": 2.0, "b": 2.0}, {"a": 9.0, "b": 1.5}])

    def made_up(policies: list[str], *_: Any, **__: Any) -> dict[str, Any]:
        now = next(scores)
        said = {
            e: {"total_reward": {"mean": s, "deviation": 0.0}, "outcomes": {"walked": 1}, "ended_early": 0}
            for e, s in now.items()
        }
        return dict.fromkeys(policies, said)

    monkeypatch.setattr(evaluation, "evaluate", made_up)
    asked = training.SMALL["evaluation"] | {"every": 160}
    trainer = Trainer(plan(steps=480, evaluation=asked), tmp_path, resume=False)
    kept = []
    while trainer.steps < 480:
        trainer._rollout()
        kept.append((trainer.state["best"]["steps"], (tmp_path / BEST).read_bytes() == (tmp_path / LAST).read_bytes()))
    assert kept == [(160, True), (320, True), (320, False)]


def test_a_course_may_be_what_decides(tmp_path: Path) -> None:
    (tmp_path / "two.yaml").write_text(
        "seconds: 1\nsections: {even: {terrain: flat, speed: .2}, high: {terrain: stairs, speed: .3}}\n"
    )
    asked = training.SMALL["evaluation"] | {"score": "course", "course": "two.yaml", "episodes": 2}
    environment = training.SMALL["environment"] | {"command": {"vx": 0.2, "vy": 0, "yaw_rate": 0}}
    (tmp_path / "train.yaml").write_text(
        write_yaml(training.small(environment=environment, evaluation=asked, steps=320))
    )
    training.done(["-m", "crossgait.train", "train.yaml", "--out", "run"], tmp_path)
    run = tmp_path / "run"
    (row,) = read(run / EVALUATIONS)
    told = crossgait.course(
        str(run / BEST),
        crossgait.EnvironmentConfig.load(str(run / "environment.yaml")),
        course=str(tmp_path / "two.yaml"),
        episodes=2,
        seed=1,
    )
    assert row["score"] == row["mujoco.course"] == told.score()
    assert 0 < row["score"] != row["zero"]
    speeds = [cell["all"]["mean_speed_mps"]["mean"] for cell in told.document["cells"]]
    assert row["mujoco.mean_speed_mps"] == pytest.approx(np.mean(speeds))
    assert row["mujoco.mean_speed_mps.deviation"] == pytest.approx(np.std(speeds))
    card = (run / "card.md").read_text()
    for words in (
        "| section | policy, mujoco | zero, mujoco |",
        "| even |",
        "| high |",
        "| engine | policy | course |",
    ):
        assert words in card, words


def test_one_run_at_a_time_in_a_folder(tmp_path: Path) -> None:
    us = f"one that process {os.getpid()} is writing"
    with folder.locked(tmp_path), pytest.raises(ConfigError, match=us), folder.locked(tmp_path):
        pass
    with folder.locked(tmp_path):
        pass


# ---- what is written


def test_a_table_takes_back_what_a_checkpoint_does_not_know(tmp_path: Path) -> None:
    file = tmp_path / "t.csv"
    table = Table(file, "rollout", None)
    for k in range(1, 4):
        table.add({"rollout": k, "x": k / 3, "word": "a,b", "none": None})
    with file.open("a") as end:
        end.write("4,1.3333")  # torn
    again = Table(file, "rollout", 2)
    again.add({"rollout": 3, "x": 9.0, "word": "c"})
    assert read(file) == [
        {"rollout": 1, "x": 1 / 3, "word": "a,b", "none": None},
        {"rollout": 2, "x": 2 / 3, "word": "a,b", "none": None},
        {"rollout": 3, "x": 9.0, "word": "c", "none": None},
    ]
    Table(file, "rollout", None)
    assert not file.exists()


def test_tensorboard_is_given_every_number_where_it_is_installed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    written: list[Any] = []

    class SummaryWriter:
        def __init__(self, folder: str) -> None:
            written.append(folder)

        def add_scalar(self, *scalar: Any) -> None:
            written.append(scalar)

        def close(self) -> None:
            written.append("closed")

    stand_in = types.ModuleType("torch.utils.tensorboard")
    stand_in.SummaryWriter = SummaryWriter  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "torch.utils.tensorboard", stand_in)
    board = Board(tmp_path)
    board.add("train", 5, {"reward": 1.5, "swing_contact_ratio": None, "falls": 2})
    board.close()
    assert written == [str(tmp_path / "tensorboard"), ("train/reward", 1.5, 5), ("train/falls", 2, 5), "closed"]


def test_shares_of_time_leave_out_evaluations() -> None:
    assert Clock({"physics": 6.0, "learner": 3.0, "python": 1.0, "evaluation": 90.0}).shares() == {
        "physics": 0.6,
        "learner": 0.3,
        "python": 0.1,
    }


@pytest.mark.parametrize("change", ["seed=9", "algorithm.gamma=0.5", "environment.reward={alive: 1}"])
def test_a_run_goes_on_as_what_it_was(change: str, finished: Path, tmp_path: Path) -> None:
    shutil.copytree(finished / "run", tmp_path / "run")
    other = Plan.load(tmp_path / "run/config.yaml", [change])
    key = change.partition("=")[0].partition(".")[0]
    with pytest.raises(ConfigError, match=rf"checkpoint\.pt: {key}: expected .*as the run began with"):
        Trainer(other, tmp_path / "run", resume=True)


def test_a_trainer_of_ones_own_leaves_what_is_needed_beside_its_policy(tmp_path: Path) -> None:
    Trainer(plan(steps=320), tmp_path / "new/run", resume=False).run()
    assert crossgait.rollout(tmp_path / "new/run" / LAST, episodes=1).document["policies"]
    training.done(["-m", "crossgait.train", "--resume", "--out", "new/run", "--steps", "480"], tmp_path)
