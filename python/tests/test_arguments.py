"""Arguments that do not fit: which of them, what was expected, what was found, in words of Python."""

from __future__ import annotations

import copy
import functools
import os
import pickle
import re
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import crossgait
from crossgait import ConfigError, EnvironmentConfig, FunctionPolicy, State, Walk, _core, terms
from crossgait.policies import MlpNetwork
from crossgait.sweep import ProcessPool

NANOBIND = "incompatible function arguments"


def world() -> Any:
    return crossgait.World("scara_quadruped")


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: crossgait.walk("trot", seconds="1"), r"walk\(\): seconds: expected float \| None, found str '1'"),
        (lambda: crossgait.walk("trot", seed=1.5), r"walk\(\): seed: expected int \| None, found float 1\.5"),
        (lambda: crossgait.walk("trot", heading_hold="yes"), r"heading_hold: expected bool \| None, found str 'yes'"),
        (lambda: crossgait.walk("trot", terminations="fell"), r"terminations: expected Sequence\[str\] .*found str"),
        (lambda: crossgait.verdict("trot", starts="6"), r"verdict\(\): starts: expected int, found str '6'"),
        (
            lambda: crossgait.bench(sections=[3]),
            r"bench\(\): sections: expected str \| Sequence\[str\], found list \[3\]",
        ),
        (lambda: crossgait.rollout("zero", episodes=1.5), r"rollout\(\): episodes: expected int, found float 1\.5"),
        (lambda: Walk(seed=-1), r"Walk\(\): seed: expected a number that is not negative, found int -1"),
        (lambda: Walk("trot", "rough"), r"Walk\(\): expected at most 1 arguments without their names, found 2"),
        (lambda: crossgait.World(), r"World\(\): robot: expected Robot \| str \| PathLike\[str\], found nothing"),
        (lambda: crossgait.World("go2", frction=0.5), r"World\(\) has no keyword 'frction': did you mean 'friction'\?"),
        (lambda: crossgait.StartRanges(x=3), r"StartRanges\(\) has no keyword 'x': it has position_m, heading_rad, .*"),
        (lambda: crossgait.Controller(lambda: 3, targts="feet"), r"no keyword 'targts': did you mean 'targets'\?"),
        (lambda: FunctionPolicy(3), r"FunctionPolicy\(\): make: expected Callable\[.*found int 3"),
        (lambda: crossgait.Robot.load(3), r"load\(\): name_or_file: expected str \| PathLike.*found int 3"),
        (lambda: world().step(np.zeros(12), "a"), r"step\(\): substeps: expected int, found str 'a'"),
        (lambda: world().reset(3), r"reset\(\): state: expected State \| None, found int 3"),
        (lambda: setattr(State(), "time", "x"), r"^expected float, found str 'x'"),
        (lambda: MlpNetwork(3), r"MlpNetwork\(\): layers: expected Sequence\[.*found int 3"),
        (lambda: crossgait.available_engines(3), r"available_engines\(\): expected no arguments .*, found 1"),
    ],
)
def test_what_does_not_fit_is_named(call: Callable[[], Any], message: str) -> None:
    with pytest.raises(TypeError, match=message):
        call()


HALF = "a\udc80b"  # of a surrogate pair: what Python makes of bytes in names that are no UTF-8


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: crossgait.World(HALF), r"robot: name: expected one of .* found 'a\\x80b'"),
        (lambda: crossgait.World("serial_quadruped", terrain=HALF), r"terrain 'a\\x80b': name: expected one of"),
        (lambda: crossgait.World("serial_quadruped", engine=HALF), r"world: engine: expected text that UTF-8 has"),
        (lambda: crossgait.World("a\ud800"), r"input: name: expected a name that a file can have, found 'a\\ud800'"),
        (lambda: crossgait.EnvironmentConfig(robot=HALF), r"environment: robot: expected a name in UTF-8"),
        (lambda: crossgait.EnvironmentConfig(gait=HALF), r"environment: text: expected text that UTF-8 has bytes for"),
        (lambda: crossgait.EnvironmentConfig(**{HALF: 1}), r"environment: key: expected text that UTF-8 has bytes for"),
        (lambda: crossgait.EnvironmentConfig.parse(HALF), r"text: expected text that UTF-8 has bytes for"),
        (lambda: crossgait.walk(HALF), r"text: expected text that UTF-8 has bytes for"),
        (lambda: crossgait.walk("trot", engine=HALF), r"walk: engine: expected text that UTF-8 has bytes for"),
        (lambda: _core.GaitGenerator(HALF), r"gait: expected text that UTF-8 has bytes for"),
        (
            lambda: crossgait.walk("trot", seconds=10**400),
            r"seconds: expected a number of at most 64 bits, found one of",
        ),
        (
            lambda: crossgait.verdict("trot", starts=10**400),
            r"starts: expected 2 to 10000, found a number of 1329 bits",
        ),
        (lambda: crossgait.walk("trot", command={"vx": 10**400}), r"command: expected forward m/s"),
        (lambda: crossgait.EnvironmentConfig(policy_dt=10**400), r"expected numbers below 1\.8e308, found a whole one"),
    ],
)
def test_what_no_text_and_no_number_can_be_is_named(call: Callable[[], Any], message: str) -> None:
    with pytest.raises((TypeError, ConfigError), match=message):
        call()


def test_a_robot_whose_name_is_no_text_walks_by_hand_alone(tmp_path: Path) -> None:
    folder = os.fsdecode(os.fsencode(tmp_path / "robot") + b"\xff")
    shutil.copytree(Path(crossgait.models_dir()) / "robots/serial_quadruped", folder)
    file = f"{folder}/robot.yaml"
    assert crossgait.World(file).step([0.0] * 12) == "ok"
    for robot in (file, crossgait.Robot.load(file)):
        with pytest.raises(ConfigError, match=r"robot: expected a name in UTF-8"):  # before the work, not after it
            crossgait.walk("trot", robot=robot, seconds=1e6)
        with pytest.raises(ConfigError, match=r"robot: expected a name in UTF-8"):
            crossgait.EnvironmentConfig(robot=robot)


def test_numbers_of_more_digits_than_pythons_are_taken() -> None:
    config = crossgait.EnvironmentConfig(policy_dt=np.longdouble("0.02"))
    assert config.to_dict()["policy_dt"] == 0.02


def callables_of_the_core() -> Iterator[tuple[str, Any]]:
    for name, member in vars(_core).items():
        if callable(member):
            yield name, member
        if isinstance(member, type):
            members = {f"{name}.{n}": getattr(member, n) for n in vars(member) if not n.startswith("_")}
            yield from ((n, one) for n, one in members.items() if callable(one))


def test_no_function_of_the_core_answers_with_a_list_of_signatures() -> None:
    said = {}
    for name, function in callables_of_the_core():
        for positional, keywords in (([object()] * 9, {}), ([], {"no_such_keyword": 1})):
            try:
                function(*positional, **keywords)
            except (TypeError, ConfigError, ValueError) as error:
                said[name] = str(error)
    assert [name for name, text in said.items() if NANOBIND in text] == []
    assert len(said) > 100


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: crossgait.walk("trot", command=(1, 2)), r"walk: command: expected forward m/s, .*found \(1, 2\)"),
        (lambda: crossgait.walk("trot", command={"v": 1}), r"walk: command: .* a mapping of vx, vy, yaw_rate"),
        (lambda: EnvironmentConfig(polcy_dt=0.02), r"EnvironmentConfig: polcy_dt: expected one of the keys"),
        (lambda: EnvironmentConfig(engine=3), r"environment: engine: expected a name, found int"),
        (lambda: world().step("x"), r"array: values: expected numbers, found 'x'"),
        (
            lambda: crossgait.rollout(FunctionPolicy(lambda: 3), EnvironmentConfig()),
            r"a function that returns a function",
        ),
        (lambda: MlpNetwork([]), r"network: layers: expected at least one, found none"),
        (lambda: MlpNetwork([(np.zeros((3, 2)), np.zeros(2))]), r"size of a layer's bias: expected 3, found 2"),
        (
            lambda: crossgait.rollout(["serial_joints", crossgait.Policy.load("serial_joints")]),
            r"policies: expected policies of different names.*'serial_joints' twice",
        ),
        (lambda: crossgait.rollout(["zero", "zero"]), r"policies: expected policies of different names.*'zero' twice"),
        (lambda: crossgait.rollout("net.onnx", EnvironmentConfig()), r"expected .*crossgait import"),
        (lambda: terms.Terms(rewards=[1]), r"terms: rewards: expected a mapping of names to RewardTerm, found list"),
        (lambda: terms.Terms(rewards={"a": terms.RewardTerm(3)}), r"RewardTerm: function: expected a function"),
        (lambda: terms.Terms(rewards={"a": terms.RewardTerm(len, "x")}), r"RewardTerm: weight: expected a number"),
        (lambda: term(lambda env, limit: 0, limt=1), r"RewardTerm: params: expected what .*limit\).* takes beside env"),
    ],
)
def test_what_cannot_be_meant_is_an_error_of_its_own(
    call: Callable[[], Any], message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("net.onnx").write_bytes(b"")
    with pytest.raises(ConfigError, match=message):
        call()


def term(function: Callable[..., Any], **params: Any) -> terms.Terms:
    return terms.Terms(rewards={"a": terms.RewardTerm(function, params=params)})


def test_commands_and_contact_are_taken_in_every_form() -> None:
    expected = crossgait.walk("trot", command=(0.1, 0, 0), contact="impratio=10,solref=0.01:1", seconds=0.2).document
    given = {"command": {"vx": 0.1}, "contact": {"impratio": 10, "solref": [0.01, 1]}}
    assert crossgait.walk("trot", seconds=0.2, **given).document["distance_m"] == expected["distance_m"]


def test_a_configuration_is_made_of_whatever_stands_for_one(tmp_path: Path) -> None:
    one = EnvironmentConfig(engine="bullet", friction=0.5)
    file = tmp_path / "mine.yaml"
    file.write_text(one.to_yaml())
    for given in (one, one.to_dict(), file, str(file)):
        assert EnvironmentConfig(given) == one
        assert EnvironmentConfig(given, friction=0.7) == one.updated(friction=0.7)


def test_a_configuration_with_terms_is_copied_but_not_pickled() -> None:
    made = crossgait.with_terms(EnvironmentConfig(), term(lambda env: env.time))
    assert copy.copy(made) == copy.deepcopy(made) == made
    with pytest.raises(ConfigError, match=r"terms: .*functions of the program"):
        pickle.dumps(made)


@pytest.mark.parametrize(
    ("name", "where"),
    [
        ("Robot", r"Robot\.load"),
        ("Engine", r"crossgait\.engines\(\)"),
        ("Leg", r"crossgait\.legs\(robot\)"),
        ("Contact", r"World\.contacts"),
        ("FootContact", r"World\.foot_contacts"),
        ("Snapshot", r"World\.save"),
        ("Batch", r"env\.unwrapped\.batch"),
        ("SavedEpisode", "save"),
    ],
)
def test_what_is_not_made_by_its_name_says_where_it_comes_from(name: str, where: str) -> None:
    for arguments in ((), ("mujoco",)):
        with pytest.raises(TypeError, match=where):
            getattr(_core, name)(*arguments)


def test_walks_and_worlds_take_what_studies_take() -> None:
    assert Walk("trot", command={"vx": 0.2}) == Walk("trot", command=(0.2, 0, 0))
    assert Walk("trot", command=np.array([0.2, 0, 0])) == Walk("trot", command=(0.2, 0, 0))
    assert Walk(contact={"impratio": 10}) == Walk(contact="impratio=10")
    engine = next(e for e in crossgait.engines() if e.available)
    assert crossgait.World("serial_quadruped", engine=engine, contact={"impratio": 10}).engine == engine.name
    for call, message in (
        (lambda: Walk(command={"vx": 0.2, "v": 1}), "Walk: command: expected forward m/s"),
        (lambda: Walk(contact=3), "Walk: contact: expected settings as text, or a mapping of them, found int"),
        (lambda: crossgait.World("go2", engine=3), r"world: engine: expected a name, or one of crossgait\.engines"),
    ):
        with pytest.raises(ConfigError, match=message):
            call()


def test_states_and_engines_are_pickled() -> None:
    state = world().state
    assert np.array_equal(pickle.loads(pickle.dumps(state)).qpos, state.qpos)
    engine = crossgait.engines()[0]
    assert pickle.loads(pickle.dumps(engine)).name == engine.name


@pytest.mark.parametrize("engine", crossgait.available_engines())
def test_contacts_and_snapshots_are_pickled(engine: str) -> None:
    first, second = (crossgait.World("serial_quadruped", engine=engine) for _ in range(2))
    targets = first.state.q[:12]
    first.step(targets, 300)
    first.apply_wrench("trunk", force=(1.0, 2.0, 3.0))
    contact, foot = first.contacts[0], first.foot_contacts[0]
    assert repr(pickle.loads(pickle.dumps(contact))) == repr(contact)
    assert np.array_equal(pickle.loads(pickle.dumps(contact)).force, contact.force)
    assert pickle.loads(pickle.dumps(foot)).penetration == foot.penetration
    second.restore(pickle.loads(pickle.dumps(first.save())))
    assert len(second.contacts) == len(first.contacts)
    for world in (first, second):
        world.step(targets, 100)
    assert np.array_equal(first.state.qpos, second.state.qpos)
    assert np.array_equal(first.state.qvel, second.state.qvel)


@pytest.mark.parametrize("engine", crossgait.available_engines())
def test_snapshots_of_other_worlds_are_refused(engine: str) -> None:
    world = crossgait.World("scara_quadruped", engine=engine)
    world.step(np.zeros(12), 10)
    saved = world.save()
    for other in (
        crossgait.World("scara_quadruped_long", engine=engine),
        crossgait.World("scara_quadruped", "stairs", engine=engine),
        crossgait.World("scara_quadruped", engine=engine, friction=0.1),
        crossgait.World("scara_quadruped", engine=engine, physics_dt=5e-4),
        crossgait.World("scara_quadruped", engine=engine, gravity=(0, 0, -1.6)),
    ):
        with pytest.raises(ConfigError, match="restore: world: expected scara_quadruped"):
            other.restore(saved)
    state = list(saved.__getstate__())
    zero = np.zeros(3)
    for place, value in (
        (11, [(10**8, np.array([0, 0, 1e3]), zero, zero)]),
        (3, [(10**8, 0, zero, zero, 0.0, zero, 0.0)]),
        (5, np.zeros(3)),
    ):
        tampered = crossgait.Snapshot.__new__(crossgait.Snapshot)
        tampered.__setstate__((*state[:place], value, *state[place + 1 :]))
        with pytest.raises(ConfigError, match="restore"):
            world.restore(tampered)
    contact = crossgait.Contact.__new__(crossgait.Contact)
    with pytest.raises(ConfigError, match="contact: leg and body"):
        contact.__setstate__((0, 99, zero, zero, 0.0, zero, 0.0))


@pytest.mark.parametrize(
    ("kind", "state", "said"),
    [
        (crossgait.StartRanges, (-1.0, 0.0, None), "position_m: expected 0 to 100, found -1"),
        (crossgait.StartRanges, (None, float("nan"), None), "heading_rad: expected 0 to"),
        (crossgait.State, (0.0, *[np.zeros(n) for n in (3, 4, 3, 3, 33, 12)]), "q: expected at most 32 numbers"),
        (crossgait.Terrain, ("mine", "", 2, 2, 1.0, 1.0, bytes(12)), "heights: expected 2 x 2 = 4 values, found 3"),
        (crossgait.Terrain, ("mine", "", 2, 2, 0.0, 1.0, bytes(16)), "size_x: expected a positive extent"),
        (crossgait.Terrain, ("mine", "", -2, -2, 1.0, 1.0, bytes(16)), "columns: expected at least 2"),
    ],
)
def test_what_is_unpickled_keeps_its_bounds(kind: type, state: tuple[Any, ...], said: str) -> None:
    with pytest.raises(ConfigError, match=said):
        kind.__new__(kind).__setstate__(state)


@pytest.mark.parametrize("engine", crossgait.available_engines())
def test_angles_that_none_turns_to_are_refused(engine: str) -> None:
    world = crossgait.World("serial_quadruped", engine=engine)
    state = world.state
    state.q = np.full(12, 1e300)
    with pytest.raises(ConfigError):
        world.reset(state)


def test_an_episode_is_of_its_environment() -> None:
    one, two = (_core.Environment(EnvironmentConfig(friction=friction)) for friction in (0.6, 0.1))
    one.reset(0)
    two.reset(0)
    with pytest.raises(ConfigError, match="restore: configuration: expected an episode of this environment's"):
        two.restore(one.save())


def test_parameters_are_numbers_lists_arrays_and_tensors() -> None:
    torch = pytest.importorskip("torch")
    envs = _core.VectorEnvironment(EnvironmentConfig(), 4)
    envs.reset(1)
    batch = envs.batch()
    for four in (
        [20.0, 25, 30, 35],
        (20.0, 25, 30, 35),
        np.array([20.0, 25, 30, 35]),
        torch.tensor([20.0, 25, 30, 35]),
    ):
        batch.set_parameters({"kp": four})
        assert [one["kp"] for one in batch.parameters] == [20, 25, 30, 35]
    for one in (0.5, np.float32(0.5), torch.tensor(0.5)):
        batch.set_parameters({"friction": one})
        assert [said["friction"] for said in batch.parameters] == [0.5] * 4
    with pytest.raises(ConfigError, match="kp: expected an array of one number for each of 4, found 3"):
        batch.set_parameters({"kp": [1, 2, 3]})
    with pytest.raises(TypeError, match=r"Policy\.load"):
        crossgait.Policy("serial_joints")  # type: ignore[arg-type]


def test_indices_of_a_batch_are_those_of_numpy() -> None:
    envs = _core.VectorEnvironment(EnvironmentConfig(), 4)
    envs.reset(1)
    batch = envs.batch()
    mask = np.array([True, False, False, True])
    for indices, which in ((mask, [0, 3]), (-1, [3]), (slice(2), [0, 1]), ((0, 2), [0, 2]), (mask.tolist(), [0, 3])):
        batch.set_commands([0.0, 0.0, 0.0])
        batch.set_commands([0.1, 0.0, 0.0], indices)
        assert np.flatnonzero(batch.commands[:, 0]).tolist() == which
    for wrong in (4, "x", [0.5], np.ones(3, bool)):
        with pytest.raises(ConfigError, match=r"indices: expected numbers from 0 to 3, a slice, or a mask of 4"):
            batch.set_commands([0.1, 0.0, 0.0], wrong)


PROGRAMS = {
    "a controller": "import crossgait\nC = crossgait.Controller(lambda: (lambda s: s.q))",
    "an environment with terms": """
import crossgait.envs, gymnasium
from crossgait import terms
mine = terms.Terms(rewards={"b": terms.RewardTerm(lambda env: env.time)})
env = gymnasium.make("Crossgait/JointControl-v0", terms=mine)
env.reset(seed=0)
def f(): return env
""",
}


@pytest.mark.parametrize("program", PROGRAMS)
def test_what_a_module_keeps_ends_with_the_process(program: str) -> None:
    done = subprocess.run([sys.executable, "-c", PROGRAMS[program]], capture_output=True, text=True, check=False)
    assert (done.returncode, re.findall("leaked|terminate", done.stderr)) == (0, []), done.stderr


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda: crossgait.rollout("zero", episodes=10**9),
            r"rollout: episodes: expected 1 to 1000000, found 1000000000",
        ),
        (lambda: crossgait.tune(population=10**9), r"tune: population: expected 4 to 100000"),
        (lambda: crossgait.score("serial_joints", starts=10**4), r"score: starts: expected 2 to 1000"),
        (
            lambda: crossgait.compare("trot", position_tolerance=float("nan")),
            r"position_tolerance: .*a number, found nan",
        ),
        (lambda: crossgait.StartRanges(push_mps=float("nan")), r"StartRanges: push_mps: expected 0 to 10, found nan"),
        (lambda: crossgait.StartRanges(position_m=-1), r"StartRanges: position_m: expected 0 to 100, found -1"),
    ],
)
def test_numbers_have_the_bounds_of_the_commands(call: Callable[[], Any], message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        call()


def test_keys_within_themselves_are_refused() -> None:
    circle: dict[str, Any] = {}
    circle["reward"] = circle
    nested: Any = []
    for _ in range(20_000):
        nested = [nested]
    for keys in (circle, {"observation": nested}):
        with pytest.raises(ConfigError, match=r"keys: expected at most 32 levels"):
            EnvironmentConfig.from_dict(keys)


def test_results_and_traces_are_not_written_over_what_they_are_of(tmp_path: Path) -> None:
    ground, file = tmp_path / "ground.csv", tmp_path / "mine.yaml"
    ground.write_text("0,0,0\n0,0,0\n0,0,0\n")
    file.write_text(f"terrain: '{ground}:size_x=4,size_y=4'\nepisode_seconds: 0.1\n")
    rolled = crossgait.rollout("zero", file, episodes=1, trace=True)
    moved = crossgait.transfer("zero", file, engines="mujoco", terrains="flat", episodes=1)
    trace = rolled.traces["zero"]
    for write in (rolled.save, moved.save, trace.to_csv):
        with pytest.raises(ConfigError, match="a file that is not read"):
            write(file)
    for write in (rolled.save, trace.to_csv):
        with pytest.raises(ConfigError, match="a file that is not read"):
            write(ground)
    trace.to_csv(tmp_path / "t.csv")
    again = crossgait.Trace.read_csv(tmp_path / "t.csv")
    with pytest.raises(ConfigError, match="a file that is not read"):
        again.to_csv(tmp_path / "t.csv")
    rolled.save(tmp_path / "r.json")
    rolled.save(tmp_path / "r.json")


def test_a_file_that_is_replaced_keeps_who_may_read_it(tmp_path: Path) -> None:
    file = tmp_path / "r.json"
    walked = crossgait.walk("trot", seconds=0.1)
    walked.save(file)
    file.chmod(0o600)
    walked.save(file)
    assert file.stat().st_mode & 0o777 == 0o600


class Unsayable:
    """No number, and `repr` says what UTF-8 has no bytes for."""

    def __array__(self, *_: Any, **__: Any) -> Any:
        raise ValueError

    def __repr__(self) -> str:
        return "\udcff"


@pytest.mark.parametrize(
    "call",
    [
        lambda: crossgait.World("scara_quadruped").step(Unsayable()),
        lambda: EnvironmentConfig(episode_seconds=Unsayable()),
        lambda: crossgait.rollout(FunctionPolicy(lambda: lambda _: Unsayable()), {"episode_seconds": 0.1}),
        lambda: crossgait.walk(crossgait.Controller(lambda: lambda _: Unsayable(), Walk(seconds=0.1))),
        lambda: begun().set_parameters({"friction": "\udcff"}),
        lambda: begun().set_parameters({"solref": ["\udcff", 1]}),
        lambda: begun().set_parameters({"\udcff": 1}),
        lambda: begun().set_parameters({"friction": "0.5\0x"}),
        lambda: crossgait.World("scara_quadruped").step([10**5000] * 12),
        lambda: crossgait.World("scara_quadruped").step(np.ones(12) * 1j),
        lambda: begun().jacobian("trunk", [np.nan, 0, 0]),
        lambda: crossgait.World("scara_quadruped").jacobian("trunk", [np.nan, 0, 0]),
        lambda: EnvironmentConfig(keys=shared_lists(9)),
        lambda: crossgait.trust("/tmp\0harmless"),
        lambda: crossgait.verdict("trot", starts=4, seconds=0.05, runs="store\0.jsonl"),
        lambda: crossgait.Result.load("walk.json\0"),
        lambda: crossgait.walk(seconds=0.1).save("walk.json\0"),
    ],
)
def test_what_cannot_be_said_or_meant_is_refused(call: Callable[[], Any]) -> None:
    """What ended the process, was taken up to a byte of zero, or filled the memory."""
    with pytest.raises(ConfigError):
        call()


def begun() -> crossgait.Batch:
    core = _core.Environment(EnvironmentConfig())
    core.reset(0)
    return core.batch()


def shared_lists(levels: int) -> list[Any]:
    made: list[Any] = [1]
    for _ in range(levels):
        made = [made] * 10
    return made


def test_elements_of_a_state_act_or_are_refused() -> None:
    world = crossgait.World("serial_quadruped")
    state = world.state
    for array in (state.q, state.qd, state.qpos, state.qvel, state.q_WB):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1
    state.p_WB[2] = 2
    state.v_WB = [0, 0, 1]
    assert state.qpos[2] == 2
    assert state.qvel[2] == 1
    with pytest.raises(ConfigError, match="v_WB: expected 3 numbers"):
        state.v_WB = [1, 2]
    world.reset(state)
    assert world.state.p_WB[2] == 2
    world.reset(None)
    assert world.state.p_WB[2] < 1


def test_numbers_of_numpy_are_those_that_were_written() -> None:
    single = crossgait.walk("trot", seconds=0.2, friction=np.float32(0.7), command=[np.float32(0.1), 0, 0])
    assert single == crossgait.walk("trot", seconds=0.2, friction=0.7, command=[0.1, 0, 0])
    judged = crossgait.verdict("trot", seconds=0.1, starts=4, engines="mujoco", against={"kp": np.int64(30)})
    assert judged.word


def test_threads_have_a_most(tmp_path: Path) -> None:
    for call in (
        lambda: crossgait.rollout("zero", workers=3000),
        lambda: _core.VectorEnvironment(EnvironmentConfig(), 2, workers=10**6),
        lambda: ProcessPool(100_000),
    ):
        with pytest.raises(ConfigError, match=r"workers: expected .*1024"):
            call()


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (
            lambda: crossgait.FunctionPolicy(lambda observation: 0),
            r"FunctionPolicy: make: .* found <lambda>.observation.",
        ),
        (
            lambda: crossgait.Controller(lambda state: 0),
            r"Controller: make: .* one of a State: `lambda: f` .*<lambda>.state.",
        ),
        (lambda: crossgait.Controller(lambda state, gain=1: 0), r"found <lambda>.state, gain=1."),
    ],
)
def test_what_makes_a_controller_takes_nothing(make: Callable[[], Any], words: str) -> None:
    """A function of a state, instead of what makes one, is refused where it is given."""
    with pytest.raises(ConfigError, match=words):
        make()
    crossgait.FunctionPolicy(lambda scale=1: lambda observation: 0)
    crossgait.FunctionPolicy(functools.wraps(lambda observation: 0)(lambda: lambda observation: 0))
    crossgait.Controller(dict)  # says nothing of what it takes
