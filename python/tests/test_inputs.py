"""Environments, policies, engines and terrains: every function takes every form, and says what it expected."""

from __future__ import annotations

import inspect
import pickle
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest

import crossgait
import crossgait.envs  # registers environments
from crossgait import (
    ConfigError,
    Controller,
    EnvironmentConfig,
    FunctionPolicy,
    GaitGenerator,
    Policy,
    StartRanges,
    Terrain,
    Walk,
)
from crossgait.inputs import as_environment, as_policies, as_terrain
from crossgait.policies import MlpNetwork, PolicyInterface
from crossgait.studies.choices import WALK_KEYWORDS

FOLDER = Path(crossgait.models_dir()) / "policies" / "serial_joints"
SHORT = {"episode_seconds": 0.3, "settle_seconds": 0.1}
JOINTS = EnvironmentConfig.load(FOLDER / "environment.yaml").updated(SHORT)
GAIT = EnvironmentConfig(policy_dt=0.02, adapt=["step_length"], **SHORT)
TWO = crossgait.available_engines()[:2]


def numbers(document: Any) -> Any:
    """What a result says, but for what moved it, and how long that took."""
    left_out = ("provenance", "policy", "gait", "behaviour", "summary", "wall_seconds")
    if isinstance(document, dict):
        return {key: numbers(value) for key, value in document.items() if key not in left_out}
    return [numbers(item) for item in document] if isinstance(document, list) else document


#: What runs a policy in an environment: every function of the package that does.
RUNS: dict[str, Callable[[Any, Any], Any]] = {
    "walk": lambda policy, environment: crossgait.walk(policy, environment=environment),
    "compare": lambda policy, environment: crossgait.compare(policy, environment=environment, engines=TWO),
    "verdict": lambda policy, environment: crossgait.verdict(policy, environment=environment, engines=TWO, starts=4),
    "rollout": lambda policy, environment: crossgait.rollout(policy, environment, episodes=1),
    "rollout of several": lambda policy, environment: crossgait.rollout([policy], environment, episodes=1),
    "transfer": lambda policy, environment: crossgait.transfer(
        policy, environment, engines=TWO[:1], terrains="flat", episodes=1
    ),
    "course": lambda policy, environment: crossgait.course(policy, environment, sections="speed-1.0", episodes=1),
}


def in_memory() -> Policy:
    loaded = Policy.load("serial_joints")
    assert loaded.network is not None
    return Policy.from_network(loaded.network, JOINTS, name="mine")


def function() -> FunctionPolicy:
    policy = in_memory()
    return FunctionPolicy(lambda: policy.act, "mine")


POLICIES: dict[str, Callable[[], Any]] = {
    "folder": lambda: str(FOLDER),
    "path of a folder": lambda: FOLDER,
    "file": lambda: str(FOLDER / "serial_joints.safetensors"),
    "path of a file": lambda: FOLDER / "serial_joints.safetensors",
    "Policy of a name": lambda: Policy.load("serial_joints"),
    "Policy in memory": in_memory,
    "FunctionPolicy": function,
}


@pytest.mark.parametrize("run", RUNS)
def test_a_policy_is_taken_in_every_form(run: str) -> None:
    expected = numbers(RUNS[run]("serial_joints", JOINTS).document)
    for form, policy in POLICIES.items():
        assert numbers(RUNS[run](policy(), JOINTS).document) == expected, form


@pytest.fixture(scope="module")
def environments(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """GAIT in every form."""
    file = tmp_path_factory.mktemp("environments") / "mine.yaml"
    file.write_text(GAIT.to_yaml())
    made = gymnasium.make("Crossgait/AdaptiveGait-v0", config=file)
    mapping = GAIT.to_dict()
    return {"file": str(file), "path": file, "mapping": mapping, "environment": made, "its core": made.unwrapped.core}


@pytest.mark.parametrize("run", [*RUNS, "tune"])
def test_an_environment_is_taken_in_every_form(run: str, environments: dict[str, Any]) -> None:
    def tune(_: str, environment: Any) -> Any:
        how = {"iterations": 1, "population": 4, "terrains": 1, "unseen": 0, "engines": TWO[:1]}
        return crossgait.tune(environment, **how)

    call = {**RUNS, "tune": tune}[run]
    expected = numbers(call("zero", GAIT).document)
    for form, environment in environments.items():
        assert numbers(call("zero", environment).document) == expected, form


def test_whatever_is_made_in_an_environment_takes_every_form_of_it(environments: dict[str, Any]) -> None:
    for environment in environments.values():
        assert as_environment(environment) == GAIT
        assert Policy.load("zero", environment).environment == GAIT
    for form in ("file", "path", "mapping"):
        assert gymnasium.make("Crossgait/AdaptiveGait-v0", config=environments[form]).unwrapped.config == GAIT
    walk = Walk("walk", robot="serial_quadruped")
    assert as_environment(walk) == walk.environment()


def test_a_policy_has_an_environment_of_its_own(tmp_path: Path) -> None:
    assert Policy.load(FOLDER).environment == EnvironmentConfig.load(FOLDER / "environment.yaml")
    mine = in_memory()
    expected = numbers(crossgait.rollout("serial_joints", JOINTS, episodes=1).document)
    assert numbers(crossgait.rollout(mine, episodes=1).document) == expected
    assert numbers(crossgait.rollout(["zero", mine], episodes=1).document["policies"][1]) == expected["policies"][0]
    mine.save(tmp_path / "mine.safetensors")
    for run in ("walk", "verdict", "rollout"):
        with pytest.raises(ConfigError, match=r"mine.safetensors: environment: expected environment=, or"):
            RUNS[run](tmp_path / "mine.safetensors", None)
        with pytest.raises(ConfigError, match="function: environment: expected environment="):
            RUNS[run](FunctionPolicy(lambda: mine.act), None)
    (tmp_path / "environment.yaml").write_text(JOINTS.to_yaml())
    assert numbers(crossgait.rollout(tmp_path / "mine.safetensors", episodes=1).document) == expected


def test_engines_are_taken_in_every_form() -> None:
    if len(TWO) < 2:
        pytest.skip("needs two engines")
    objects = [engine for name in TWO for engine in crossgait.engines() if engine.name == name]
    for engines in (TWO, tuple(TWO), ",".join(TWO), ", ".join(TWO), objects):
        assert crossgait.compare("trot", engines=engines, seconds=0.1).engines == TWO
        judged = crossgait.verdict("trot", engines=engines, seconds=0.1, starts=4)
        assert judged.pairs[0]["engines"] == TWO
        cells = crossgait.transfer("zero", GAIT, engines=engines, terrains="flat", episodes=1).document["cells"]
        assert [cell["engine"] for cell in cells] == TWO
    for one in (TWO[0], objects[0]):
        assert crossgait.walk("trot", engine=one, seconds=0.1).engine == TWO[0]
        assert crossgait.conformance(one, only="free_fall").document["engine"]["name"] == TWO[0]
        assert EnvironmentConfig(engine=one).engine == TWO[0]
        assert gymnasium.make("Crossgait/AdaptiveGait-v0", engine=one).unwrapped.config.engine == TWO[0]


HEIGHTS = np.random.default_rng(1).uniform(0, 0.01, (81, 41)).astype(np.float32)


def test_terrains_are_taken_in_every_form(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    ground = Terrain.from_heights(HEIGHTS, size_x=1, size_y=2, name="my ground")
    ground.save(tmp_path / "ground.csv")
    text = f"{tmp_path}/ground.csv:size_x=1,size_y=2"
    walked = numbers(crossgait.walk("trot", terrain=text, seconds=0.2).document)
    for terrain in (ground, Path(text)):
        assert numbers(crossgait.walk("trot", terrain=terrain, seconds=0.2).document) | {"terrain": text} == walked
        for config in (
            EnvironmentConfig(terrain=terrain),
            EnvironmentConfig().updated(terrain=terrain),
            EnvironmentConfig.from_dict({"terrain": terrain}),
            gymnasium.make("Crossgait/AdaptiveGait-v0", terrain=terrain).unwrapped.config,
            Walk(terrain=terrain).environment(),
        ):
            made = Terrain(config.terrain)
            assert np.array_equal(made.heights, ground.heights)  # to the last bit
            assert made.size == (1, 2)
        told = crossgait.transfer("zero", GAIT, terrains=[terrain, "flat"], engines=TWO[:1], episodes=1)
        assert len(told.document["cells"]) == 2
        assert crossgait.World("scara_quadruped", terrain).state.p_WB[2] > 0
    assert len(list((tmp_path / "cache/crossgait/terrains").iterdir())) == 1  # the same heights, the same file
    assert EnvironmentConfig(terrain=Terrain()).terrain == "flat"
    with pytest.raises(ConfigError, match=r"plane"):
        Terrain().save(tmp_path / "flat.csv")
    with pytest.raises(ConfigError, match=r"\.csv or \.png"):
        ground.save(tmp_path / "ground.txt")


def test_robots_are_taken_in_every_form(scara: crossgait.Robot) -> None:
    file = Path(crossgait.models_dir()) / "robots/scara_quadruped/robot.yaml"
    for robot in ("scara_quadruped", file, str(file), scara):
        assert Walk(robot=robot) == Walk(robot=str(robot) if robot is not scara else "scara_quadruped")
        assert crossgait.World(robot).state.q.shape == scara.home.shape
        assert list(crossgait.legs(robot)) == ["FL", "FR", "RL", "RR"]
        assert len(crossgait.body_poses(robot, crossgait.World(scara).state)) == 21


def test_a_gait_is_a_walk_or_a_name() -> None:
    feet = crossgait.GaitGenerator(Walk("pace")).update(0.1)[0]
    assert np.array_equal(crossgait.GaitGenerator("pace").update(0.1)[0], feet)
    assert not np.array_equal(crossgait.GaitGenerator().update(0.1)[0], feet)  # the trot's


def test_options_of_a_walk_come_on_top_of_a_policys_environment() -> None:
    how = {"command": (0.3, 0, 0.1), "terrain": "rough", "seed": 3, "friction": 0.5, "seconds": 0.2, "settle": 0.1}
    walked = crossgait.walk("serial_joints", contact="impratio=10,solref=0.01:1", **how)
    keys = {"command": {"vx": 0.3, "vy": 0, "yaw_rate": 0.1}, "terrain": "rough", "terrain_seed": 3, "friction": 0.5}
    keys |= {"episode_seconds": 0.2, "settle_seconds": 0.1, "contact": {"impratio": 10, "solref": [0.01, 1]}}
    expected = crossgait.walk("serial_joints", environment=JOINTS.updated(keys))
    assert numbers(walked.document) == numbers(expected.document)
    assert (walked.terrain, walked.simulated_seconds, walked.contact["impratio"]) == ("rough", 0.2, 10)
    with pytest.raises(ConfigError, match="compensation"):
        crossgait.walk("serial_joints", compensation=False)


WRONG: list[tuple[str, Callable[[], Any], str]] = [
    ("a misspelt gait", lambda: crossgait.walk("tort"), r"walk: subject: expected one of trot, .*found tort"),
    ("a missing file", lambda: crossgait.verdict("x.safetensors"), r"or a policy: zero, random, .*x\.safetensors"),
    ("a number for a gait", lambda: crossgait.compare(3), r"compare: subject: expected a gait's name, .*found int"),
    ("no policy", lambda: crossgait.rollout(3), r"rollout: policy: expected a name, a file, a Policy or .*found int"),
    ("no policy in a list", lambda: crossgait.rollout(["zero", 3], GAIT), r"rollout: policy: .*found int"),
    ("a bare function", lambda: crossgait.rollout(np.tanh, GAIT), r"FunctionPolicy\(make\) of a function"),
    ("an unknown policy", lambda: crossgait.transfer("nope"), r"policy: nope: expected zero, random, .*serial_joints"),
    ("no environment", lambda: crossgait.rollout("zero", 3), r"rollout: environment: expected an EnvironmentConfig"),
    ("a key of none", lambda: crossgait.rollout("zero", {"engin": 1}), r"rollout: .*expected one of the keys"),
    (
        "an environment of a gait",
        lambda: crossgait.walk("trot", environment=3),
        r"environment: expected none beside a gait",
    ),
    ("an environment of a Walk", lambda: crossgait.walk(Walk(), environment=GAIT), r"expected none beside a gait"),
    ("no engine", lambda: crossgait.walk("trot", engine=3), r"walk: engine: expected one of mujoco.*found 3"),
    ("no engine in a list", lambda: crossgait.compare("trot", engines=["mujoco", 3]), r"compare: engine: .*found 3"),
    ("one engine", lambda: crossgait.verdict("trot", engines="mujoco"), r"verdict: engines: expected two or more"),
    ("one engine for two", lambda: crossgait.compare("serial_joints", engines="mujoco"), r"expected two or more"),
    *(
        (f"an array for ground: {where}", call, r"terrain: .*Terrain\.from_heights\), found (ndarray|list)")
        for where, call in {
            "walk": lambda: crossgait.walk("trot", terrain=HEIGHTS),
            "keywords": lambda: EnvironmentConfig(terrain=HEIGHTS),
            "a list": lambda: EnvironmentConfig(terrain=HEIGHTS.tolist()),
            "updated": lambda: EnvironmentConfig().updated(terrain=HEIGHTS),
            "a mapping": lambda: EnvironmentConfig.from_dict({"terrain": HEIGHTS}),
            "gymnasium": lambda: gymnasium.make("Crossgait/JointControl-v0", terrain=HEIGHTS),
            "transfer": lambda: crossgait.transfer("zero", GAIT, terrains=[HEIGHTS]),
            "a world": lambda: crossgait.World("serial_quadruped", HEIGHTS),
            "a picture": lambda: as_terrain(HEIGHTS),
            "a terrain": lambda: Terrain(HEIGHTS),
        }.items()
    ),
    (
        "grounds that are none",
        lambda: crossgait.transfer("zero", GAIT, terrains=[3]),
        r"transfer: terrain: .*found int",
    ),
    ("a robot of a configuration", lambda: EnvironmentConfig(robot=3), r"environment: robot: expected .*found int"),
    (
        "a number for ground",
        lambda: EnvironmentConfig().updated(terrain=3),
        r"environment: terrain: expected .*found int",
    ),
    ("heights without a size", lambda: Terrain.from_heights(HEIGHTS), r"heights: size_x, size_y: expected both"),
    ("heights of one row", lambda: Terrain.from_heights(HEIGHTS[0], size_x=1, size_y=1), r"two dimensions, found 1"),
    ("no robot for a world", lambda: crossgait.World(3), r"world: robot: expected .* or a Robot, found int"),
    ("no robot for poses", lambda: crossgait.body_poses(3, crossgait.State()), r"body_poses: robot: .* found int"),
    ("no walk for a gait", lambda: crossgait.GaitGenerator(3), r"gait: walk: expected .* name of a gait, found int"),
    ("no robot for legs", lambda: crossgait.legs(3), r"legs: robot: expected .* or a Robot, found int"),
    ("a robot that is none", lambda: Walk(robot=3), r"Walk: robot: expected a name, a file or a Robot, found int"),
    ("an unknown check", lambda: crossgait.conformance("mujoco", only="contact"), r"found contact"),
    ("no trace", lambda: crossgait.walk("trot", seconds=0.1).trace, r"walk: trace: expected trace=True"),
    ("no traces", lambda: crossgait.rollout("zero", GAIT).traces, r"rollout: trace: expected trace=True"),
    ("a function to diagnose", lambda: crossgait.diagnose(function(), JOINTS), r"diagnose: policy: .*FunctionPolicy"),
]


@pytest.mark.parametrize("mistake", WRONG, ids=lambda mistake: mistake[0])
def test_mistakes_are_named_in_words_of_python(mistake: tuple[str, Callable[[], Any], str]) -> None:
    _, call, message = mistake
    with pytest.raises(ConfigError, match=message):
        call()


@pytest.mark.parametrize(
    ("call", "meant"),
    [
        (lambda: Walk(terain="rough"), r"Walk\(\) has no keyword 'terain': did you mean 'terrain'\?"),
        (lambda: Terrain("rough", sed=1), r"Terrain\(\) has no keyword 'sed': did you mean 'seed'\?"),
        (lambda: crossgait.walk("trot", secnds=1), r"walk\(\) has no keyword 'secnds': did you mean 'seconds'\?"),
        (lambda: Walk(colour=1), r"Walk\(\) has no keyword 'colour': it has gait, command, parameters, robot, .*"),
        (lambda: crossgait.rollout("zero", engine="mujoco"), r"no keyword 'engine': it has policies, environment, .*"),
    ],
)
def test_keywords_say_what_was_meant(call: Callable[[], Any], meant: str) -> None:
    with pytest.raises(TypeError, match=meant):
        call()


def test_numbers_of_fewer_digits_are_those_that_were_written() -> None:
    for kind in (np.float16, np.float32, np.float64):
        config = EnvironmentConfig(policy_dt=kind(0.02), randomisation={"friction": np.array([0.4, 0.8], kind)})
        assert config.policy_dt == 0.02
        assert config.randomisation == {"friction": [0.4, 0.8]}
    assert EnvironmentConfig(terrain_seed=np.int32(3)).terrain_seed == 3


def test_heights_are_whatever_numpy_makes_an_array_of() -> None:
    whole = Terrain.from_heights(HEIGHTS, size_x=1, size_y=2)
    for given in (HEIGHTS.tolist(), HEIGHTS.astype(np.float64), np.asfortranarray(HEIGHTS)):
        assert np.array_equal(Terrain.from_heights(given, size_x=1, size_y=2).heights, whole.heights)
    assert (
        whole.height([0.1, 0.2], (0, 0.3)).tolist() == whole.height(np.array([0.1, 0.2]), np.array([0, 0.3])).tolist()
    )


def test_one_policy_or_several() -> None:
    assert as_policies("zero,random") == ["zero,random"]  # a file's name may have commas
    assert as_policies(("zero", "random")) == ["zero", "random"]
    assert len(as_policies(in_memory())) == 1


def test_an_action_has_the_shape_of_its_space() -> None:
    env = gymnasium.make("Crossgait/JointControl-v0", robot="serial_quadruped").unwrapped
    env.reset(seed=0)
    env.step(np.zeros(12))
    with pytest.raises(ConfigError, match=r"action: array: expected .* of shape \(12,\), found shape \(1, 12\)"):
        env.step(np.zeros((1, 12)))
    many = gymnasium.make_vec("Crossgait/JointControl-v0", num_envs=2, robot="serial_quadruped")
    many.reset(seed=0)
    with pytest.raises(ConfigError, match=r"of shape \(2, 12\), found shape \(24,\)"):
        many.step(np.zeros(24))


def test_keywords_of_a_walk_are_those_of_every_function_that_walks() -> None:
    for function in (crossgait.walk, crossgait.compare, crossgait.verdict):
        parameters = inspect.signature(function).parameters
        assert set(WALK_KEYWORDS) <= set(parameters)
        assert all(parameter.kind != inspect.Parameter.VAR_KEYWORD for parameter in parameters.values())
    said = dict(command=[0.1, 0, 0], parameters={"step_height": 0.03}, robot="serial_quadruped", terrain="rough")
    said |= dict(seed=3, friction=0.5, contact="impratio=10", seconds=1, physics_dt=0.0005, control_dt=0.001)
    said |= dict(settle=0.25, compensation=False, heading_hold=False, terminations=["fell"])
    assert set(said) == set(WALK_KEYWORDS)
    walk = Walk("walk", **said)
    assert walk.to_dict() == {"gait": "walk", **said}
    assert Walk(**walk.to_dict()) == walk


def test_a_speed_is_a_command_straight_ahead() -> None:
    ahead, said = crossgait.walk(speed=0.2, seconds=0.2), crossgait.walk(command=(0.2, 0, 0), seconds=0.2)
    assert (ahead.distance_m, ahead.mean_speed_mps) == (said.distance_m, said.mean_speed_mps)
    with pytest.raises(ConfigError, match=r"walk: speed: expected a speed or a command, found both"):
        crossgait.walk(speed=0.2, command=(0.2, 0, 0))
    with pytest.raises(TypeError, match=r"compare\(\): speed: expected float \| None, found str 'fast'"):
        crossgait.compare(speed="fast")  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="a Walk says itself what speed"):
        crossgait.verdict(Walk("trot"), speed=0.2)


def test_a_mistyped_keyword_is_told_what_it_may_mean() -> None:
    for call, key, meant in (
        (crossgait.walk, "terain", "terrain"),
        (crossgait.verdict, "engine", "engines"),
        (crossgait.course, "section", "sections"),
        (crossgait.conformance, "onyl", "only"),
    ):
        with pytest.raises(TypeError, match=rf"{call.__name__}\(\) has no keyword '{key}': did you mean '{meant}'\?"):
            call(**{key: 1})  # type: ignore[operator]
    with pytest.raises(TypeError, match=r"walk\(\) has no keyword 'abacus': it has subject, engine, .*"):
        crossgait.walk(abacus=1)  # type: ignore[call-arg]


def controller() -> Any:
    return lambda state: np.zeros(12)


@pytest.mark.parametrize(
    "thing",
    [
        Walk("auto", command=(0.2, 0, 0), parameters={"swing": "bezier"}),
        StartRanges(heading_rad=0.1, push_mps=0.02),
        Terrain("rough", seed=3),
        Terrain(),
        FunctionPolicy(controller, "mine"),
        GAIT,
    ],
    ids=lambda thing: type(thing).__name__,
)
def test_what_describes_a_run_can_be_read_and_pickled(thing: Any) -> None:
    assert " object at 0x" not in repr(thing)
    again = pickle.loads(pickle.dumps(thing))
    assert type(again) is type(thing)
    assert repr(again) == repr(thing)
    if isinstance(thing, Terrain):
        assert np.array_equal(again.heights, thing.heights)
        assert again.size == thing.size


def test_what_a_world_answers_can_be_read() -> None:
    world = crossgait.World("scara_quadruped")
    leg = crossgait.legs("scara_quadruped")["FL"]
    world.step(world.state.q[list(crossgait.Robot.load("scara_quadruped").servo_indices)], 300)
    network = MlpNetwork([(np.zeros((3, 4)), np.zeros(3)), (np.zeros((2, 3)), np.zeros(2))])
    things = [
        world,
        world.state,
        world.save(),
        world.contacts[0],
        world.foot_contacts[0],
        leg,
        GaitGenerator(),
        network,
    ]
    things.append(PolicyInterface(crossgait.EnvironmentConfig()))
    for thing in things:
        assert re.match(rf"<crossgait\.(policies\.)?{type(thing).__name__}\b.*>", repr(thing)), repr(thing)
    assert repr(leg) == "<crossgait.Leg FL, five_bar>"
    assert repr(network).endswith(" 4-3-2>")
    assert re.search(
        r"of FL at \(0\.\d{4}, 0\.\d{4}, -?0\.0\d{3}\) m, [\d.]+ N, [\d.e-]+ m deep", repr(world.contacts[0])
    )


def test_results_and_policies_can_be_pickled() -> None:
    walked = crossgait.walk("trot", seconds=0.1, trace=True)
    again = pickle.loads(pickle.dumps(walked))
    assert again.document == walked.document
    assert np.array_equal(again.trace.values, walked.trace.values)
    mine = in_memory()
    observation = np.full(len(mine.layout.observation), 0.1)
    for policy in (mine, Policy.load("serial_joints"), Policy.load("zero", GAIT)):
        copy = pickle.loads(pickle.dumps(policy))
        assert (copy.name, copy.environment) == (policy.name, policy.environment)
        if policy.network is not None:
            assert np.array_equal(copy.act(observation), policy.act(observation))
    assert (
        repr(Controller(controller, Walk(terrain="rough"), name="sway"))
        == "<crossgait.Controller 'sway': joints, Walk('trot', terrain='rough')>"
    )


def test_robots_and_terrains_are_equal_where_engines_see_the_same() -> None:
    """Whatever they are called, and by == alone."""
    robot, other = (crossgait.Robot.load(name) for name in ("scara_quadruped", "serial_quadruped"))
    assert robot == crossgait.Robot.load(Path(crossgait.models_dir()) / "robots/scara_quadruped/robot.yaml")
    assert hash(robot) == hash(crossgait.Robot.load("scara_quadruped"))
    assert robot not in (other, "scara_quadruped", None)
    rough = crossgait.Terrain("rough", seed=3)
    assert rough.size is not None
    again = crossgait.Terrain.from_heights(rough.heights, size_x=rough.size[0], size_y=rough.size[1], name="mine")
    assert rough == again
    assert len({rough, again, crossgait.Terrain("rough", seed=3)}) == 1
    assert crossgait.Terrain() == crossgait.Terrain("flat")
    wider = crossgait.Terrain.from_heights(rough.heights, size_x=2 * rough.size[0], size_y=rough.size[1])
    assert rough not in (crossgait.Terrain("rough", seed=4), crossgait.Terrain(), wider, "rough")


def test_states_are_equal_number_by_number() -> None:
    """And have no hash, since they can be changed."""
    world = crossgait.World("scara_quadruped")
    state, same = world.state, world.state
    assert state == same
    same.time += 1
    assert state != same
    for name in ("p_WB", "v_WB", "w_WB", "q", "qd"):
        changed = world.state
        setattr(changed, name, getattr(changed, name) + 1e-15)
        assert changed != state, name
    assert state not in (crossgait.State(), None)
    with pytest.raises(TypeError, match="has no hash: it can be changed"):
        hash(state)


def test_worlds_and_walks_take_numbers_as_they_were_written() -> None:
    """0.001 of float32 is 0.001."""
    world = crossgait.World("scara_quadruped", physics_dt=np.float32(0.001), friction=np.float16(0.7))
    assert world.physics_dt == 0.001
    walk = crossgait.Walk(physics_dt=np.float32(0.001), parameters={"step_height": np.float32(0.04)})
    assert walk == crossgait.Walk(physics_dt=0.001, parameters={"step_height": 0.04})
    for command in (np.array([0.1, 0, 0], np.float32), {"vx": np.float32(0.1)}):
        assert crossgait.Walk(command=command) == crossgait.Walk(command=[0.1, 0, 0])

    class Scalar:  # as other libraries have them
        dtype = object()

        def __float__(self) -> float:
            return 0.002

    assert crossgait.World("scara_quadruped", physics_dt=Scalar()).physics_dt == 0.002  # type: ignore[arg-type]
