from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import epsilon

import crossgait
from crossgait import ConfigError, Controller, EnvironmentConfig, FunctionPolicy, Robot, State, Trace, Walk


def command(*arguments: str) -> Any:
    """The program's JSON."""
    done = subprocess.run(
        [sys.executable, "-m", "crossgait", *arguments, "--json", "-"],
        capture_output=True,
        text=True,
        check=True,
    )
    return json.loads(done.stdout)


def without_the_run(document: Any) -> Any:
    """Without provenance, whose command differs, and wall time."""
    if isinstance(document, dict):
        return {k: without_the_run(v) for k, v in document.items() if k not in ("provenance", "wall_seconds")}
    return [without_the_run(item) for item in document] if isinstance(document, list) else document


def files_of(document: Any) -> Any:
    """The files that a result was made of, with their hashes."""
    files = document["provenance"]["files"]
    assert "<models>/robots/scara_quadruped/robot.yaml" in files
    return files


def test_walk_is_the_command(engine: str) -> None:
    walked = crossgait.walk("trot", engine=engine, seconds=1, terrain="rough", seed=3, command=(0.2, 0, 0.1))
    written = command(
        "walk",
        "--engine",
        engine,
        "--seconds",
        "1",
        "--terrain",
        "rough",
        "--seed",
        "3",
        "--command",
        ".2,0,.1",
    )
    assert without_the_run(walked.to_dict()) == without_the_run(written)
    assert files_of(walked.to_dict()) == files_of(written)


def test_gait_parameters_are_those_of_set() -> None:
    walked = crossgait.walk("walk", seconds=1, parameters={"step_height": 0.03, "swing": "bezier"})
    written = command("walk", "--gait", "walk", "--seconds", "1", "--set", "step_height=.03", "--set", "swing=bezier")
    assert without_the_run(walked.to_dict()) == without_the_run(written)
    assert Walk("walk", parameters={"step_height": 0.03}).parameters["step_height"] == 0.03


def test_compare_is_the_command() -> None:
    result = crossgait.compare("trot", seconds=1)
    written = command("compare", "--seconds", "1")
    assert without_the_run(result.to_dict()) == without_the_run(written)
    assert files_of(result.to_dict()) == files_of(written)
    assert list(result.to_frame().index) == crossgait.available_engines() == result.engines


def test_verdict_is_the_command() -> None:
    engines = [e.name for e in crossgait.engines() if e.available]
    if len({tuple(e.laws.items()) for e in crossgait.engines() if e.available}) < 2:
        pytest.skip("needs engines of two laws")
    verdict = crossgait.verdict(
        "trot", seconds=0.2, starts=6, explain=True, margins={"slip_m": 0.5, "duty_factor": "9%"}
    )
    margins = ["--margin", "slip_m=0.5", "--margin", "duty_factor=9%"]
    written = command("verdict", "--seconds", ".2", "--starts", "6", "--explain", *margins)
    assert without_the_run(verdict.to_dict()) == without_the_run(written)
    assert files_of(verdict.to_dict()) == files_of(written)
    assert verdict.word in ("agrees", "differs", "step-dependent", "unresolved")
    assert verdict.summary in repr(verdict)
    assert verdict.statistic("distance_m")["unit"] == "m"
    assert verdict.statistic("slip_m")["margin"] == 0.5
    assert set(verdict.causes) <= {s["key"] for s in verdict.pairs[0]["statistics"]}
    assert set(verdict.pairs[0]["engines"]) <= set(engines)
    assert sum(verdict.outcomes[verdict.pairs[0]["engines"][0]].values()) == 6
    with pytest.raises(ConfigError, match="no_such"):
        crossgait.verdict("trot", seconds=0.1, starts=4, margins={"no_such": 1})


def test_rollout_is_the_command(tmp_path: Path) -> None:
    config = EnvironmentConfig.parse('{"policy_dt": 0.02, "episode_seconds": 1, "terrain": "rough"}')
    (tmp_path / "env.yaml").write_text(config.to_yaml())
    result = crossgait.rollout(["random", "zero"], config, episodes=2, seed=7)
    written = command(
        *("rollout", "--policy", "random,zero", "--config", str(tmp_path / "env.yaml")),
        *("--episodes", "2", "--seed", "7"),
    )
    assert without_the_run(result.to_dict()) == without_the_run(written)
    assert len(result.to_frame()) == 4


def test_without_an_environment_it_is_the_default() -> None:
    assert "episode_seconds: 20" in crossgait.EnvironmentConfig.parse("{}").resolved().to_yaml()
    with pytest.raises(ConfigError, match="policy"):
        crossgait.rollout("no-such-policy")
    with pytest.raises(ConfigError, match="policy"):
        crossgait.transfer("no-such-policy")


def test_verdicts_of_many_are_the_command() -> None:
    engines = crossgait.available_engines()[:3]
    if len(engines) < 3:
        pytest.skip("needs three engines")
    judged = crossgait.verdict("trot", engines=engines, starts=6, seconds=0.3)
    written = command("verdict", "--engines", ",".join(engines), "--starts", "6", "--seconds", ".3")
    assert without_the_run(judged.to_dict()) == without_the_run(written)
    assert [pair["engines"] for pair in judged.pairs] == [
        [engines[0], engines[1]],
        [engines[0], engines[2]],
        [engines[1], engines[2]],
    ]
    assert judged.pair(engines[1], engines[0]) == judged.pairs[0]
    assert judged.statistic("slip_m", engines[2], engines[1]) in judged.pairs[2]["statistics"]
    assert sorted(name for cluster in judged.clusters for name in cluster) == sorted(engines)
    assert judged.outlier is None  # two laws of contact
    assert "one vote" in judged.reason or judged.reason == "all agree"
    assert len(judged.to_frame()) == sum(len(pair["statistics"]) for pair in judged.pairs)
    assert judged.plot().axes
    assert "trot" in repr(judged)
    with pytest.raises(ConfigError, match="two or more"):
        crossgait.verdict("trot", engines=engines[:1])


def test_verdicts_between_setups_are_the_command() -> None:
    changes = {"gravity": "x0.5", "solref": (0.01, 1)}
    judged = crossgait.verdict("trot", against=changes, explain=True, starts=6, seconds=0.3)
    text = "gravity=x0.5,solref=0.01:1"
    written = command("verdict", "--against", text, "--explain", "--starts", "6", "--seconds", ".3")
    assert judged.pairs == written["pairs"]
    assert judged.to_dict()["against"]["changes"] == written["against"]["changes"]
    name = crossgait.available_engines()[0]
    assert judged.pairs[0]["engines"][0] == name
    assert judged.pairs[0]["engines"][1].startswith(f"{name} with gravity=x0.5,solref=0.01:1")
    leading = {name for row in judged.pairs[0]["attribution"]["statistics"] for name in row["cause"]["leading"]}
    assert "gravity" in leading <= {"gravity", "solref"}
    with pytest.raises(ConfigError, match=r"did you mean friction\?"):
        crossgait.verdict("trot", against="frction=0.4", seconds=0.1)
    with pytest.raises(ConfigError, match="quantity"):
        crossgait.verdict("trot", against={}, seconds=0.1)


def test_a_course_is_the_command() -> None:
    config = EnvironmentConfig.parse("{engine: bullet}")
    runs = crossgait.course("zero", config, sections=["speed-1.0"], engines=["mujoco", "bullet"], episodes=1)
    options = ["--sections", "speed-1.0", "--engines", "mujoco,bullet", "--episodes", "1"]
    assert without_the_run(command("course", *options)) == without_the_run(runs.to_dict())
    assert list(runs.to_frame().index) == [("speed-1.0", "mujoco"), ("speed-1.0", "bullet")]
    assert runs.score() == runs.score("mujoco") != runs.score("bullet")
    assert "of speed-1.0 of course hard in mujoco and" in repr(runs)
    assert runs.plot().axes
    with pytest.raises(ConfigError, match="speed-3"):
        crossgait.course("zero", config, sections=["speed-3"])


def test_transfer_and_tune_come_back_as_objects() -> None:
    config = EnvironmentConfig.parse('{"policy_dt": 0.02, "episode_seconds": 0.5, "adapt": [step_length]}')
    transfer = crossgait.transfer("zero", config, terrains=["flat"], episodes=1)
    assert len(transfer.to_frame()) == len(crossgait.available_engines())
    tuning = crossgait.tune(
        config, engines=crossgait.available_engines()[:1], iterations=1, population=4, terrains=1, unseen=1
    )
    assert tuning.environment is not None
    assert "step_length" in tuning.environment.to_yaml()
    assert f"tuned to {tuning.document['history'][-1]:.3f} m/s" in repr(tuning)
    assert tuning.plot().axes


def test_a_diagnosis_is_the_command() -> None:
    found = crossgait.diagnose("serial_joints", seed=3)
    assert found.healthy
    assert found.cause is None
    assert not found.abstained
    assert found.ranking == []
    assert without_the_run(command("diagnose", "serial_joints", "--seed", "3")) == without_the_run(found.to_dict())
    assert found.environment is not None
    assert found.summary in repr(found)


def test_a_diagnosis_of_a_policy_that_does_nothing() -> None:
    config = EnvironmentConfig.load(f"{crossgait.models_dir()}/policies/serial_joints/environment.yaml")
    found = crossgait.diagnose("zero", config, search=False)
    assert not found.healthy
    assert found.cause is None
    with pytest.raises(ConfigError, match="action"):
        crossgait.diagnose("zero", EnvironmentConfig())


def test_a_gait_is_tuned_for_a_course(tmp_path: Path) -> None:
    course = tmp_path / "two.yaml"
    course.write_text("seconds: .3\nsections: {even: {terrain: flat, speed: .2}, high: {terrain: stairs, speed: .3}}\n")
    config = EnvironmentConfig.parse('{"adapt": [cycle_time]}')
    engines = crossgait.available_engines()[:2]
    tuning = crossgait.tune(
        config, engines=engines, iterations=1, population=4, terrains=1, unseen=0, course=str(course)
    )
    assert "on course two" in repr(tuning)
    assert tuning.environment is not None
    scores = crossgait.course("zero", tuning.environment, course=str(course), engines=engines, episodes=1)
    assert tuning.document["history"][-1] == min(scores.score(engine) for engine in engines)
    options = ["--course", str(course), "--adapt", "cycle_time", "--iterations", "1", "--population", "4"]
    written = command("tune", *options, "--terrains", "1", "--unseen", "0", "--engines", ",".join(engines))
    assert written["parameters"] == tuning.document["parameters"]


def test_conformance_is_the_command(engine: str) -> None:
    card = crossgait.conformance(engine, only=["free_fall", "hard_friction"])
    written = command("conformance", "--engine", engine, "--only", "free_fall,hard_friction")
    assert without_the_run(card.to_dict()) == without_the_run(written)
    assert card.passed
    assert card.to_frame().loc["free_fall"]["holds"].all()
    assert len(card.plot().axes[0].get_yticklabels()) >= 3
    with pytest.raises(ConfigError, match="no_such_check"):
        crossgait.conformance(engine, only=["no_such_check"])


def test_a_trace_is_the_commands_file(tmp_path: Path) -> None:
    result = crossgait.walk("trot", seconds=0.5, trace=True)
    command("walk", "--seconds", ".5", "--trace", str(tmp_path / "a.csv"))
    result.trace.to_csv(tmp_path / "b.csv")
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()
    again = Trace.read_csv(tmp_path / "a.csv")
    assert np.array_equal(again.values, result.trace.values)
    assert again.names == result.trace.names
    frame = again.to_frame()
    assert frame.index.name == "time"
    assert np.array_equal(frame["p_WB.x"], again["p_WB.x"])
    assert list(again.group("contact")) == ["FL", "FR", "RL", "RR"]
    grouped = again.to_frame(grouped=True)
    assert np.array_equal(grouped["force"]["FL.z"], again["force.FL.z"])
    assert np.array_equal(grouped[("p_WB", "x")], again["p_WB.x"])
    with pytest.raises(ConfigError, match=r"p_WB\.w"):
        again["p_WB.w"]


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("a,b\n1,2\n", "time"),
        ("time,a\n0,x\n", "line 2"),
        ("time,a\n0\n", "line 2"),
        ("time\nnan\n", "finite"),
    ],
)
def test_bad_traces_are_refused(tmp_path: Path, text: str, what: str) -> None:
    (tmp_path / "t.csv").write_text(text)
    with pytest.raises(ConfigError, match=what):
        Trace.read_csv(tmp_path / "t.csv")


def test_results_show_themselves(tmp_path: Path) -> None:
    walked = crossgait.walk("trot", seconds=0.5, trace=True)
    assert "trot on flat" in repr(walked)
    assert "<pre>" in walked._repr_html_()
    assert walked.mean_speed_mps == walked.document["mean_speed_mps"]
    with pytest.raises(AttributeError):
        _ = walked.no_such_number
    walked.save(tmp_path / "walk.json")
    assert json.loads((tmp_path / "walk.json").read_text()) == walked.document
    assert walked.plot().axes
    compared = crossgait.compare("trot", seconds=0.5, trace=True)
    figure = compared.plot()
    assert len(figure.axes) == 5  # how far from the first, then the walks themselves
    assert figure.axes[0].get_yscale() == "log"
    assert len(figure.axes[0].lines) == len(compared.engines) - 1
    assert compared.summary in compared._repr_html_()
    assert compared._repr_html_().count(compared.summary) == 1  # the answer once, then groups and statistics
    assert sorted(name for group in compared.groups for name in group["engines"]) == sorted(compared.engines)
    assert all(group["sentence"] in str(compared) for group in compared.groups)
    with pytest.raises(ConfigError, match="trace"):
        crossgait.walk("trot", seconds=0.1).plot()


def test_a_name_in_a_result_is_text_in_a_notebook() -> None:
    hostile = Controller(lambda: lambda state: np.zeros(12), Walk(seconds=0.1), name="<script>alert(1)</script>")
    assert "<script>" not in crossgait.walk(hostile)._repr_html_()


def sway(robot: Robot) -> Any:
    home = robot.home[robot.servo_indices]

    def make() -> Any:
        calls = 0

        def controller(state: State) -> np.ndarray:
            nonlocal calls
            calls += 1  # its own, anew in every run
            return np.asarray(home + 0.05 * np.sin(0.02 * calls))

        return controller

    return make


def test_a_behaviour_of_ones_own_is_walked_compared_and_judged(scara: Robot) -> None:
    behaviour = Controller(sway(scara), Walk(seconds=0.5), name="sway")
    once, twice = crossgait.walk(behaviour), crossgait.walk(behaviour)
    assert without_the_run(once.document) == without_the_run(twice.document)
    assert once.document["gait"] == "sway"
    compared = crossgait.compare(behaviour)
    for pair in (pair for pair in compared.pairs if pair["same_laws"]):
        # Rounding of 250 steps; measured 1e-13 in double precision.
        assert pair["max_position_difference_m"] < 1e-10 + 10 * epsilon(pair["a"], pair["b"])
    judged = crossgait.verdict(behaviour, starts=6)
    assert judged.document["behaviour"].startswith("sway")
    assert without_the_run(judged.document) == without_the_run(
        crossgait.verdict(behaviour, starts=6, workers=1).document
    )


def test_feet_of_a_gait_walk_as_the_gait(scara: Robot) -> None:
    """Standing feet below the hips: it stays where it is."""
    feet = np.tile([0.0, 0.0, -0.062], (4, 1))
    behaviour = Controller(lambda: lambda state: feet, Walk(seconds=1), targets="feet")
    result = crossgait.walk(behaviour)
    assert result.outcome == "walked"
    assert abs(result.distance_m) < 5e-3  # settles by some millimetres
    assert result.duty_factor == {"FL": 1, "FR": 1, "RL": 1, "RR": 1}


def test_what_a_behaviour_raises_comes_out() -> None:
    def broken(state: State) -> float:
        raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        crossgait.walk(Controller(lambda: broken))
    with pytest.raises(KeyError, match="mine"):
        crossgait.verdict(Controller(lambda: broken, Walk(seconds=0.1)), starts=4)


@pytest.mark.parametrize(
    ("returned", "what"), [([1, 2], "12 numbers"), ("home", "12 numbers"), ([np.nan] * 12, "finite")]
)
def test_wrong_targets_of_a_behaviour_are_refused(returned: Any, what: str) -> None:
    with pytest.raises(ConfigError, match=what) as caught:
        crossgait.walk(Controller(lambda: lambda state: returned, name="mine"))
    assert caught.value.source == "mine"


def zeros(size: int) -> Any:
    return lambda: lambda observation: np.zeros(size)


def test_a_policy_of_ones_own_is_the_zero_policy_if_it_says_zero() -> None:
    config = EnvironmentConfig.parse('{"policy_dt": 0.02, "episode_seconds": 0.5}')
    mine = FunctionPolicy(zeros(16), "mine")
    rollout = crossgait.rollout([mine, "zero"], config, episodes=2).document["policies"]
    assert [run["policy"] for run in rollout] == ["mine", "zero"]
    assert without_the_run(rollout[0]["episodes"]) == without_the_run(rollout[1]["episodes"])
    judged = crossgait.verdict(mine, environment=config, starts=4)
    zero = crossgait.verdict("zero", environment=config, starts=4)
    assert judged.pairs[0]["statistics"] == zero.pairs[0]["statistics"]
    cells = crossgait.transfer(mine, config, terrains=["flat"], episodes=1).document["cells"]
    assert all(cell["policy"]["mean_speed_mps"] == cell["baseline"]["mean_speed_mps"] for cell in cells)


def test_a_policy_of_ones_own_remembers_within_an_episode_alone() -> None:
    config = EnvironmentConfig.parse('{"policy_dt": 0.02, "episode_seconds": 0.2}')
    lengths: list[int] = []

    def make() -> Any:
        lengths.append(0)

        def act(observation: np.ndarray) -> np.ndarray:
            lengths[-1] += 1
            return np.full(16, 1e3 if lengths[-1] == 1 else np.nan)  # clipped; counts as zero

        return act

    episodes = crossgait.rollout(FunctionPolicy(make), config, episodes=3, workers=1).document["policies"][0][
        "episodes"
    ]
    assert lengths == [10, 10, 10]
    assert all(episode["invalid_actions"] == 0 for episode in episodes)  # policies' actions are made valid before


def test_what_a_policy_raises_comes_out() -> None:
    config = EnvironmentConfig.parse('{"policy_dt": 0.02, "episode_seconds": 0.2}')

    def broken(observation: np.ndarray) -> np.ndarray:
        raise ZeroDivisionError("mine")

    for call in (crossgait.rollout, crossgait.transfer):
        with pytest.raises(ZeroDivisionError, match="mine"):
            call(FunctionPolicy(lambda: broken), config)
    with pytest.raises(ZeroDivisionError, match="mine"):
        crossgait.verdict(FunctionPolicy(lambda: broken), environment=config, starts=4)
    long = EnvironmentConfig.parse(
        '{"policy_dt": 0.02, "episode_seconds": 1e5}'
    )  # an hour of work, if its episode went on
    with pytest.raises(ZeroDivisionError, match="mine"):
        crossgait.rollout(FunctionPolicy(lambda: broken), long)
    with pytest.raises(ConfigError, match="16 numbers"):
        crossgait.rollout(FunctionPolicy(zeros(3)), config)
    with pytest.raises(ConfigError, match="environment"):
        crossgait.verdict(FunctionPolicy(zeros(16)))


def test_options_belong_to_gaits_by_name() -> None:
    with pytest.raises(TypeError, match="seconds"):
        crossgait.walk(Walk(), seconds=3)
    with pytest.raises(ConfigError, match=r"walk: subject: expected one of trot, .* a policy.*, found trott"):
        crossgait.walk("trott")
    with pytest.raises(ConfigError, match="two or more"):
        crossgait.verdict("trot", engines=["mujoco"])


def test_progress_is_told_and_ends_what_it_raises_in() -> None:
    reported: list[tuple[str, float]] = []

    def stop(stage: str, share: float) -> None:
        reported.append((stage, share))
        if share > 0:
            raise StopIteration("enough")

    with pytest.raises(StopIteration, match="enough"):
        crossgait.walk("trot", seconds=60, progress=stop)
    assert reported[-1][0] == "walking"
    assert 0 < reported[-1][1] < 1
    crossgait.walk("trot", seconds=0.1)  # and the next one works


def test_ctrl_c_ends_long_calls() -> None:
    program = """
import os, signal, threading, time, crossgait
signal.signal(signal.SIGINT, signal.default_int_handler)  # also where a shell has it ignored
threading.Timer(1, lambda: (begin.append(time.monotonic()), os.kill(os.getpid(), signal.SIGINT))).start()
begin = []
try:
    crossgait.verdict("trot", seconds=60, starts=50, progress=False)
except KeyboardInterrupt:
    print(time.monotonic() - begin[0])
print(crossgait.walk("trot", seconds=.1).outcome)
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=300, check=True)
    seconds, outcome = done.stdout.split()
    assert float(seconds) < 1  # 0.09 s on an idle machine
    assert outcome == "walked"
    assert done.stderr == ""


def test_pickled_configurations_are_the_same() -> None:
    import pickle

    config = EnvironmentConfig.parse('{"terrain": "rough", "policy_dt": 0.02}')
    assert pickle.loads(pickle.dumps(config)).to_yaml() == config.to_yaml()
    error = ConfigError("a", "b", "c", "d")
    assert str(pickle.loads(pickle.dumps(error))) == str(error)


def test_the_program_is_there() -> None:
    done = subprocess.run([sys.executable, "-m", "crossgait", "--version"], capture_output=True, text=True, check=True)
    assert crossgait.__version__ in done.stdout
