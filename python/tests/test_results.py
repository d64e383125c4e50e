"""Results to look at: traces of forces and torques, tables that can be grouped, plots whose axes do not deceive."""

from __future__ import annotations

import json
import subprocess
import sys
import typing
from pathlib import Path

import numpy as np
import pytest

import crossgait
from crossgait import ConfigError, EnvironmentConfig, Robot, Walk
from crossgait.studies.walk_numbers import WalkNumbers

SHORT = EnvironmentConfig(policy_dt=0.02, episode_seconds=0.5, adapt=["step_length"])


def test_a_trace_has_velocities_torques_forces_and_contact_points(engine: str) -> None:
    """Of the SCARA machine; each is what mechanics says of the others."""
    trace = crossgait.walk("trot", engine=engine, seconds=1, trace=True).trace
    robot = Robot.load("scara_quadruped")
    assert list(trace.group("qd")) == list(trace.group("torque")) == robot.joints
    # The control step is 2 ms, in which joints of 1e2 rad/s^2 change their rate by .2 rad/s: of rates of some rad/s.
    servo = f"{robot.servos[0]}"
    differences = np.diff(trace[f"q.{servo}"]) / np.diff(trace.time)
    assert np.corrcoef(differences, trace[f"qd.{servo}"][1:])[0, 1] > 0.9
    weight = 9.81 * robot.mass_kg
    total = sum(trace[f"force.{leg}.z"] for leg in ("FL", "FR", "RL", "RR"))
    # Over a second of even trot the ground carries the weight, but for what the last stride's momentum is.
    assert total.mean() == pytest.approx(weight, rel=0.1)
    for leg in ("FL", "FR", "RL", "RR"):
        force = np.stack([trace[f"force.{leg}.{axis}"] for axis in "xyz"])
        assert np.allclose(np.linalg.norm(force, axis=0), trace[f"load.{leg}"], rtol=1e-12, atol=0)
        touching = trace[f"contact.{leg}"] == 1
        point = np.stack([trace[f"p_WP.{leg}.{axis}"] for axis in "xyz"], axis=1)
        assert np.all(point[~touching] == 0)
        assert np.abs(point[touching, 2]).max() < 0.01  # flat ground, into which feet sink by millimetres
    assert np.abs(trace[f"torque.{servo}"]).max() > 0


def test_every_command_of_a_policy_has_traces() -> None:
    rolled = crossgait.rollout(["serial_joints", "zero"], {**JOINTS, "episode_seconds": 0.4}, episodes=2, trace=True)
    assert list(rolled.traces) == ["serial_joints", "zero"]
    first = rolled.traces["serial_joints"]
    assert len(first) == 20
    assert len(first.group("torque")) == 12
    distance = rolled.to_frame().loc[("serial_joints", 0)]["distance_m"]
    assert first["p_WB.x"][-1] - first["p_WB.x"][0] == pytest.approx(distance, abs=0.02)  # a step of the policy apart
    compared = crossgait.compare("serial_joints", engines="mujoco,bullet", seconds=0.4, trace=True)
    assert [len(trace) for trace in compared.traces.values()] == [20, 20]
    assert len(compared.plot().axes) == 5


JOINTS = EnvironmentConfig.load(Path(crossgait.models_dir()) / "policies/serial_joints/environment.yaml").to_dict()


def test_terms_that_came_to_nothing_are_zero() -> None:
    config = {"action": "joints", "episode_seconds": 0.2, "policy_dt": 0.02}
    frame = crossgait.rollout(["zero", "random"], config, episodes=2).to_frame()
    terms = frame[[column for column in frame if column.startswith("reward_terms.")]]
    assert (terms.loc["zero"] == 0).any(axis=None)
    assert not terms.isna().any(axis=None)


def test_tables_are_told_apart_by_their_index() -> None:
    rolled = crossgait.rollout(["zero", "random"], SHORT, episodes=2).to_frame()
    assert rolled.index.names == ["policy", "episode"]
    assert rolled.index.is_unique
    assert rolled.loc[("random", 1)]["seed"] == rolled.loc[("zero", 1)]["seed"]
    assert len(rolled.groupby("policy")["distance_m"].mean()) == 2
    transfer = crossgait.transfer("zero", SHORT, terrains=["flat", "rough"], engines="mujoco,bullet", episodes=1)
    assert transfer.to_frame().index.names == ["terrain", "engine"]
    verdict = crossgait.verdict("trot", engines="mujoco,bullet", seconds=0.2, starts=4).to_frame()
    assert verdict.index.names == ["a", "b", "key"]
    assert verdict.xs("distance_m", level="key")["unit"].item() == "m"
    course = crossgait.course("zero", SHORT, sections="speed-1.0", engines="mujoco,bullet", episodes=1).to_frame()
    assert list(course.index) == [("speed-1.0", "mujoco"), ("speed-1.0", "bullet")]
    for frame in (rolled, transfer.to_frame(), verdict, course):
        assert frame.index.is_unique


def test_tables_without_rows_are_tables() -> None:
    healthy = crossgait.diagnose("serial_joints", search=False).to_frame()
    assert (len(healthy), healthy.index.name) == (0, "field")
    skipped = crossgait.conformance("mujoco", only="free_fall").to_frame()
    assert skipped.index.names == ["check", "what"]


def test_one_quantity_has_one_name_everywhere() -> None:
    walked = set(crossgait.walk("trot", seconds=0.2).to_frame().columns)
    rolled = set(crossgait.rollout("zero", SHORT, episodes=1).to_frame().columns)
    judged = {row["key"] for row in crossgait.verdict("trot", seconds=0.2, starts=4).pairs[0]["statistics"]}
    moved = crossgait.transfer("zero", SHORT, terrains="flat", engines="mujoco", episodes=1).to_frame()
    assert {"distance_m", "mean_speed_mps", "slip_m", "cost_of_transport"} <= walked & rolled & set(moved.columns)
    assert moved["mean_speed_mps"].mean() == moved["baseline.mean_speed_mps"].mean()
    assert not any(isinstance(cell, dict) for cell in moved.iloc[0])
    assert judged - {"failures"} <= {name.partition(".")[0] for name in walked}


def test_axes_of_amounts_begin_at_zero() -> None:
    for figure in (
        crossgait.rollout(["zero", "random"], SHORT, episodes=2).plot(),
        crossgait.transfer("zero", SHORT, terrains="flat", episodes=1).plot(),
    ):
        for axes in figure.axes:
            low, high = axes.get_xlim()
            assert low <= 0 <= high


def test_numbers_of_a_walk_are_known_before_it_is_made() -> None:
    walked = crossgait.walk("trot", seconds=0.2)
    known = typing.get_type_hints(WalkNumbers)
    assert set(known) == set(walked.document) - {"schema", "summary"}
    for name, kind in known.items():
        for result in (walked, crossgait.walk("serial_joints", seconds=0.2)):
            value = getattr(result, name)
            allowed = typing.get_args(kind) if typing.get_origin(kind) is not dict and "|" in str(kind) else (kind,)
            assert any(isinstance(value, typing.get_origin(one) or one) for one in allowed), name
    assert json.dumps(walked.to_dict())


MISSING = """
import sys
sys.modules.update({name: None for name in sys.argv[2:]})
import crossgait
walked = crossgait.walk("trot", seconds=.1, trace=True)
try:
    eval(sys.argv[1])
except ImportError as error:
    print(error)
"""


@pytest.mark.parametrize(
    ("call", "package", "extra"),
    [
        ("walked.to_frame()", "pandas", "frames"),
        ("walked.trace.to_frame()", "pandas", "frames"),
        ("walked.plot()", "matplotlib", "plot"),
        ("walked.trace.to_video('x.mp4', 'scara_quadruped')", "imageio", "video"),
        ("walked.trace.to_video('x.mp4', 'scara_quadruped')", "imageio_ffmpeg", "video"),
        ("crossgait.Policy.from_onnx('x.onnx', {})", "onnx", "onnx"),
    ],
)
def test_a_missing_package_is_named_with_its_pip_line(call: str, package: str, extra: str) -> None:
    done = subprocess.run([sys.executable, "-c", MISSING, call, package], capture_output=True, text=True, check=True)
    assert f"{package}: pip install 'crossgait[{extra}]'" in done.stdout


@pytest.mark.long
def test_type_checkers_know_the_keywords(tmp_path: Path) -> None:
    (tmp_path / "right.py").write_text(
        "import crossgait\n"
        "result = crossgait.walk('trot', seconds=1, terrain=crossgait.Terrain('rough'), trace=True)\n"
        "speed: float = result.mean_speed_mps\n"
        "policy = crossgait.Policy.load('zero', {})\n"
        "crossgait.compare(policy, environment={'engine': 'bullet'}, engines='mujoco,bullet')\n"
        "crossgait.Walk('trot', robot=crossgait.Robot.load('scara_quadruped'))\n"
    )
    (tmp_path / "wrong.py").write_text(
        "import crossgait\ncrossgait.walk('trot', secnds=1)\ncrossgait.walk('trot', seconds='1')\n"
    )
    run = [sys.executable, "-m", "mypy", "--strict", "--cache-dir", str(tmp_path / "cache")]
    right = subprocess.run([*run, "right.py"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert right.returncode == 0, right.stdout
    wrong = subprocess.run([*run, "wrong.py"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert 'Unexpected keyword argument "secnds"' in wrong.stdout
    assert 'Argument "seconds" to "walk" has incompatible type "str"' in wrong.stdout


def test_a_walk_says_what_it_was_made_of() -> None:
    assert repr(Walk()) == "Walk('trot')"
    assert repr(Walk("walk", friction=0.5)) == "Walk('walk', friction=0.5)"


def test_results_are_read_again_and_compared(tmp_path: Path) -> None:
    walked = crossgait.walk("trot", seconds=0.2, trace=True)
    walked.save(tmp_path / "walk.json")
    again = crossgait.WalkResult.load(tmp_path / "walk.json")
    assert again == walked == crossgait.walk("trot", seconds=0.2)  # whenever it was made, traced or not
    assert hash(again) == hash(walked)
    assert len({again, walked}) == 1
    assert str(again) == walked.summary
    assert again.to_frame().equals(walked.to_frame())
    assert walked != crossgait.walk("trot", seconds=0.3)
    assert walked != walked.document
    rolled = crossgait.rollout("zero", SHORT)
    rolled.save(tmp_path / "rollout.json")
    read = crossgait.Result.load(tmp_path / "rollout.json")
    assert isinstance(read, crossgait.Rollout)
    assert read == rolled != walked
    with pytest.raises(ConfigError, match=r"path: expected a file that is not read"):
        read.save(tmp_path / "rollout.json")


def test_results_that_are_equal_have_one_hash() -> None:
    walked = crossgait.walk("trot", seconds=0.1)
    other = crossgait.WalkResult({**walked.to_dict(), "lateral_m": -0.0}, "")
    same = crossgait.WalkResult({**walked.to_dict(), "lateral_m": 0}, "")
    assert other == same
    assert hash(other) == hash(same)


def test_a_class_of_ones_own_leaves_results_as_they_are(tmp_path: Path) -> None:
    class Mine(crossgait.WalkResult):
        def __init__(self, document: dict[str, typing.Any]) -> None:
            super().__init__(document, "mine")

    crossgait.walk("trot", seconds=0.1).save(tmp_path / "walk.json")
    assert type(crossgait.Result.load(tmp_path / "walk.json")) is crossgait.WalkResult
    assert Mine({"summary": "a"}).text == "mine"


@pytest.mark.parametrize(
    "change",
    [
        {"summary": 3},
        {"provenance": 3},
        {"provenance": {"files": [3]}},
        {"schema": {"name": "walk", "version": 999}},
    ],
)
def test_documents_that_break_later_are_refused(change: dict[str, typing.Any], tmp_path: Path) -> None:
    document = crossgait.walk("trot", seconds=0.1).to_dict() | change
    (tmp_path / "walk.json").write_text(json.dumps(document))
    with pytest.raises(ConfigError):
        crossgait.Result.load(tmp_path / "walk.json")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('{"schema": {"name": "verdict"}}', "schema.name: expected a result of walk, found 'verdict'"),
        ('{"schema": {"name": ["walk"]}}', "schema.name: expected a result of walk"),
        ('{"schema": 3}', "schema.name: expected a result of walk, found None"),
        (
            '{"schema": {"name": "walk", "version": "draft"}}',
            r"expected what a result of walk has \(docs/schemas/walk.json\), found KeyErr",
        ),
        ('{"schema": 1, "schema": 2}', "schema: expected each key once in an object, found twice"),
        ("[]", "expected a result as `--json` writes it, found no JSON object"),
        ("{", "expected a result as `--json` writes it, found no JSON object"),
    ],
)
def test_files_that_are_no_results_are_refused(text: str, said: str, tmp_path: Path) -> None:
    (tmp_path / "walk.json").write_text(text)
    with pytest.raises(ConfigError, match=said):
        crossgait.WalkResult.load(tmp_path / "walk.json")
