"""The policies that come with Crossgait: found by name, and worth what their cards say."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import crossgait
from crossgait import ConfigError, _core
from crossgait.train import Plan

NAMES = crossgait.policy_names()


def folder(name: str) -> Path:
    return Path(crossgait.models_dir()) / "policies" / name


def results(name: str) -> dict[str, Any]:
    said: dict[str, Any] = json.loads((folder(name) / "results.json").read_text())
    return said


def test_there_are_some() -> None:
    assert "scara_adaptive" in NAMES


def judged_by(what: str) -> list[str]:
    return [name for name in NAMES if results(name)["judged_by"] == what]


def some_engines(said: dict[str, Any]) -> list[str]:
    """One of each kind that there is."""
    return [engine for engine in said["engines"] if engine in crossgait.available_engines()][:2]


@pytest.mark.parametrize("name", judged_by("course"))
def test_the_card_is_what_the_course_gives(name: str) -> None:
    """The first runs of the hardest sections, to the last digit."""
    said = results(name)
    sections = ["slope-20deg", "pushed"]
    done = crossgait.course(name, sections=sections, engines=some_engines(said), episodes=2)
    for cell in done.document["cells"]:
        stored = said["course"]["policy"]["sections"][cell["engine"]][cell["section"]["name"]]["runs"]
        assert cell["scores"] == stored[:2], (cell["engine"], cell["section"]["name"])
    card = (folder(name) / "card.md").read_text()
    for engine in said["engines"]:
        mean, deviation = said["course"]["policy"]["scores"][engine]
        assert f"{mean:.3f} ± {deviation:.3f}" in card


@pytest.mark.parametrize("name", judged_by("commands"))
def test_the_card_is_how_it_follows_commands(name: str) -> None:
    """The first episodes at the fastest turn on rough ground."""
    said = results(name)
    own = crossgait.EnvironmentConfig.load(str(folder(name) / "environment.yaml"))
    weight = float(own.to_yaml().split("velocity_error: ")[1].split()[0])
    card = (folder(name) / "card.md").read_text().split("### rough")[1]
    for engine in some_engines(said):
        stored = said["commands"]["policy"]["rough"][engine]["1,0.5"]
        asked = {"engine": engine, "terrain": "rough:size_x=50,size_y=30"}
        command = {"vx": 1, "vy": 0, "yaw_rate": 0.5}
        done = crossgait.rollout(name, own.updated(json.dumps(asked | {"command": command}), "test"), episodes=2)
        episodes = done.document["policies"][0]["episodes"]
        errors = [e["reward_terms"]["velocity_error"] / weight / e["steps"] for e in episodes]
        # Sums in another order are other bits: 1e-13 here.
        assert errors == pytest.approx(stored["runs"][:2], rel=1e-6), engine
        row = next(line for line in card.splitlines() if line.startswith("| 1,0.5 |"))
        assert f"{stored['velocity_error']:.3f}, {stored['yaw_rate_error']:.3f}" in row


@pytest.mark.long
@pytest.mark.parametrize("name", judged_by("speed"))
def test_the_card_is_how_fast_it_goes(name: str) -> None:
    """All episodes in one engine."""
    said = results(name)
    own = crossgait.EnvironmentConfig.load(str(folder(name) / "environment.yaml"))
    engine = some_engines(said)[0]
    asked = {"engine": engine, "terrain": "rough:size_x=50,size_y=10", "episode_seconds": 20}
    done = crossgait.rollout(name, own.updated(json.dumps(asked), "test"), episodes=said["runs"])
    told = done.document["policies"][0]["all"]
    stored = said["speed"]["policy"][engine]
    for statistic in ("mean_speed_mps", "cost_of_transport", "swing_contact_ratio", "slip_per_path"):
        # Sums in another order are other bits, which a walk makes more of: 1e-15 here.
        assert told[statistic]["mean"] == pytest.approx(stored[statistic], rel=1e-6)
    card = (folder(name) / "card.md").read_text()
    assert f"| `{engine}` | policy | {stored['mean_speed_mps']:.3f} |" in card


@pytest.mark.parametrize("name", NAMES)
def test_the_card_says_its_verdict(name: str) -> None:
    """Which `scripts/quality/nightly policies-NAME` measures again."""
    said = results(name)["verdict"]
    card = (folder(name) / "card.md").read_text()
    assert f"**{said['word']}**" in card
    assert said["summary"] in " ".join(card.split())


@pytest.mark.parametrize("name", NAMES)
def test_the_file_that_made_it_is_beside_it(name: str) -> None:
    plan = Plan.load(folder(name) / "train.yaml")
    environment = crossgait.EnvironmentConfig.load(str(folder(name) / "environment.yaml"))
    assert plan.evaluated.resolved() == environment.resolved()
    policy = crossgait.Policy.load(name, environment)
    assert policy.interface.layout_hash == _core.PolicyInterface(environment).layout_hash
    for file in ("card.md", "training.md", "about.json"):
        assert (folder(name) / file).stat().st_size > 100
    assert sum(file.stat().st_size for file in folder(name).iterdir()) < 1_000_000


@pytest.mark.parametrize("name", NAMES)
def test_it_runs_by_its_name_alone(name: str, tmp_path: Path) -> None:
    program = Path(crossgait.__file__).parent / "bin" / "crossgait"
    command = [str(program)] if program.exists() else [sys.executable, "-m", "crossgait"]
    options = ["rollout", "--policy", name, "--episodes", "1", "--episode-seconds", "1", "--json", "-"]
    done = subprocess.run([*command, *options], cwd=tmp_path, capture_output=True, text=True, env=os.environ.copy())
    assert done.returncode == 0, done.stderr
    own = crossgait.EnvironmentConfig.load(str(folder(name) / "environment.yaml"))
    same = crossgait.rollout(name, own.updated('{"episode_seconds": 1}', "test"), episodes=1)
    told = json.loads(done.stdout)["policies"][0]["all"]
    assert told == same.document["policies"][0]["all"]


def test_an_unknown_name_is_told_which_there_are() -> None:
    with pytest.raises(ConfigError, match="scara_adaptive"):
        crossgait.rollout("scara_adaptiv", episodes=1)
