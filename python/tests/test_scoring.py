"""Scores of policies in engines, and of what a training elsewhere writes."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import published_policies as published
import pytest
from test_importing import ROBOT
from test_studies import command, without_the_run

import crossgait
from crossgait import ConfigError, EnvironmentConfig, Policy

SHORT: dict[str, Any] = {"engines": "mujoco", "starts": 2, "seconds": 1.5}
SHORT_COMMAND = ("--engines", "mujoco", "--starts", "2", "--seconds", "1.5")


def test_scores_and_the_matrix_are_the_commands() -> None:
    scores = crossgait.score("serial_joints", **SHORT)
    assert without_the_run(command("score", "serial_joints", *SHORT_COMMAND)) == without_the_run(scores.to_dict())
    assert scores.to_frame().loc[("serial_joints", "mujoco"), "value"] < 1
    assert scores.document["cells"][0]["trained_in"] == "mujoco"
    assert scores.summary == "serial_joints does what it is asked in 1 of 1 engine: mujoco."
    assert scores.plot().axes
    matrix = crossgait.matrix("serial_joints", **SHORT | {"trained_in": "bullet"})
    asked = command("matrix", "serial_joints", *SHORT_COMMAND, "--trained-in", "bullet")
    assert without_the_run(asked) == without_the_run(matrix.to_dict())
    assert matrix.plot().axes


def test_scores_of_policies_in_memory_and_by_name() -> None:
    policy = Policy.load("serial_joints")
    both = crossgait.score([policy, "serial_joints"], **SHORT | {"trained_in": {"serial_joints": "dart"}})
    first, second = both.document["cells"]
    assert {**first, "policy": "", "trained_in": ""} == {**second, "policy": "", "trained_in": ""}


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"starts": 1}, r"score: starts: expected 2 to 10000, found 1"),
        ({"seconds": 1}, r"score: seconds: expected 1\.5 to 1000 s, found 1"),
        ({"trained_in": {"other": "mujoco"}}, r"trained_in: expected names of policies: serial_joints, found 'other'"),
        ({"engines": "havok"}, "havok"),
        ({"environment": EnvironmentConfig()}, "action: expected joints"),
    ],
)
def test_refusals_of_scores(wrong: dict[str, Any], message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        crossgait.score("serial_joints", **SHORT | wrong)


@pytest.fixture(scope="module", params=[False, True], ids=["plain", "recurrent"])
def run(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """A run of rsl_rl as Isaac Lab leaves it; and the environment that an import made of it."""
    folder = tmp_path_factory.mktemp("run")
    (folder / "params").mkdir()
    (folder / "params" / "agent.yaml").write_text(published.AGENT_YAML)
    (folder / "params" / "env.yaml").write_text(published.ENV_YAML)
    size = published.ENV_YAML_OBSERVATIONS
    file, _ = published.checkpoint(folder / "model_10.pt", size, request.param)
    sources = [folder / "params" / "env.yaml", folder / "params" / "agent.yaml"]
    imported = crossgait.import_policy(file, ROBOT, folder / "walk", sources)
    return folder, imported.environment_file


def test_checkpoints_are_scored_without_an_import(run: tuple[Path, str]) -> None:
    folder, environment = run
    checkpoint = folder / "model_10.pt"
    imported = crossgait.score(folder / "walk", **SHORT).document["cells"][0]
    scored = crossgait.score(checkpoint, environment, **SHORT).document["cells"][0]
    asked = command("score", str(checkpoint), "--env", environment, *SHORT_COMMAND)
    assert scored == {**imported, "policy": "model_10.pt"}
    assert asked["cells"] == [scored]
    files = [Path(file).name for file in asked["provenance"]["files"]]
    assert {"model_10.pt", "agent.yaml", "environment.yaml"} <= set(files)
    assert not [name for name in files if name.endswith((".safetensors", ".onnx"))], "what was made on the way"


def test_a_server_takes_checkpoints_and_outlives_half_of_one(run: tuple[Path, str], tmp_path: Path) -> None:
    folder, environment = run
    half = tmp_path / "model_20.pt"
    half.write_bytes((folder / "model_10.pt").read_bytes()[:1000])
    asked = [
        {"policy": str(half), "env": environment, "agent": str(folder / "params" / "agent.yaml")},
        {"policy": str(folder / "model_10.pt"), "env": environment},
    ]
    done = subprocess.run(
        [sys.executable, "-m", "crossgait", "score", "--serve", *SHORT_COMMAND],
        input="".join(json.dumps(line) + "\n" for line in asked),
        capture_output=True,
        text=True,
        check=True,
    )
    first, second = (json.loads(line) for line in done.stdout.splitlines())
    assert "model_20.pt" in first["error"]
    assert second["cells"] == crossgait.score(folder / "model_10.pt", environment, **SHORT).document["cells"]


def test_what_a_checkpoint_is_refused_for(run: tuple[Path, str], tmp_path: Path) -> None:
    folder, environment = run
    alone = tmp_path / "model_10.pt"
    alone.write_bytes((folder / "model_10.pt").read_bytes())
    with pytest.raises(ConfigError, match=r"architecture: expected agent\.yaml"):
        crossgait.score(alone, environment, **SHORT)
    other = EnvironmentConfig.load(environment)
    with pytest.raises(ConfigError, match="environment"):
        crossgait.score(alone, **SHORT)
    (tmp_path / "agent.yaml").write_text("policy: {activation: elu, rnn_type: lstm}\n")
    assert crossgait.score(alone, other, **SHORT).document["cells"]
    (tmp_path / "agent.yaml").write_text("policy: {activation: gelu}\n")
    with pytest.raises(ConfigError, match=r"agent\.yaml.*expected one of elu"):
        crossgait.score(alone, other, **SHORT)
