from __future__ import annotations

import copy
import json
import pickle
import subprocess
import sys
from collections import defaultdict
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode
from gymnasium.wrappers import ClipAction, NormalizeObservation, RecordEpisodeStatistics, TimeLimit
from stable_baselines3.common.env_checker import check_env as sb3_check_env

import crossgait.envs
from crossgait import ConfigError, EnvironmentConfig, _core
from crossgait.sb3 import CrossgaitVecEnv

GAIT, JOINTS = "Crossgait/AdaptiveGait-v0", "Crossgait/JointControl-v0"
IDS = (GAIT, JOINTS)


def make(env_id: str = GAIT, **settings: Any) -> crossgait.envs.QuadrupedEnv:
    env = gymnasium.make(env_id, **settings).unwrapped
    assert isinstance(env, crossgait.envs.QuadrupedEnv)
    return env


def random_actions(env: gymnasium.Env[Any, Any], count: int, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).uniform(-1, 1, (count, env.action_space.shape[0]))


def run_python(code: str) -> str:
    return subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout


# Checkers of others. Every warning is an error (pyproject.toml).


@pytest.mark.parametrize("terrain", ["flat", "rough"])
@pytest.mark.parametrize("env_id", IDS)
def test_gymnasium_checks_pass(env_id: str, engine: str, terrain: str) -> None:
    # test_rendering.py renders.
    check_env(make(env_id, engine=engine, terrain=terrain), skip_render_check=True)


@pytest.mark.parametrize("terrain", ["flat", "rough"])
@pytest.mark.parametrize("env_id", IDS)
def test_stable_baselines_checks_pass(env_id: str, engine: str, terrain: str) -> None:
    for dtype in (np.float32, np.float64):
        sb3_check_env(make(env_id, engine=engine, terrain=terrain, dtype=dtype), skip_render_check=True)


# Configuration.


def test_importing_crossgait_imports_no_gymnasium() -> None:
    assert run_python("import sys, crossgait; print('gymnasium' in sys.modules)").strip() == "False"


def test_the_id_may_name_the_module() -> None:
    code = "import gymnasium; e = gymnasium.make('crossgait.envs:Crossgait/JointControl-v0'); print(e.unwrapped.action)"
    assert run_python(code).strip() == "joints"


def test_configurations_of_every_kind_are_the_same(tmp_path: Path) -> None:
    keys = {"terrain": "rough", "terrain_seed": 3, "adapt": ["cycle_time"], "policy_dt": 0.02}
    file = tmp_path / "env.yaml"
    file.write_text("terrain: rough\nterrain_seed: 3\nadapt: [cycle_time]\npolicy_dt: .02\n")
    expected = make(config=keys).config
    assert make(config=file).config == expected
    assert make(config=str(file)).config == expected
    assert make(config=EnvironmentConfig.load(str(file))).config == expected
    assert make(**keys).config == expected
    assert make(config=keys | {"policy_dt": 0.01}, policy_dt=0.02).config == expected
    assert make(config=keys, policy_dt=0.01).config != expected


def test_values_of_numpy_and_paths_are_values(tmp_path: Path) -> None:
    heights = tmp_path / "ground.csv"
    heights.write_text("0,0\n0,0\n")
    env = make(config={"terrain": heights, "policy_dt": np.float64(0.02), "command": {"vx": np.float32(0.5)}})
    assert env.config.terrain == str(heights)
    assert env.config.policy_dt == 0.02
    with pytest.raises(ConfigError, match="numbers, text, lists"):
        make(config={"policy_dt": object()})


def test_engine_and_terrain_come_on_top(engine: str) -> None:
    env = make(JOINTS, config={"engine": "mujoco", "terrain": "rough"}, engine=engine, terrain="waves")
    assert (env.core.engine, env.config.engine, env.config.terrain) == (engine, engine, "waves")


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"config": {"terrane": "flat"}}, "terrane"),
        ({"gravity": 3}, "gravity"),
        ({"policy_dt": -1}, "policy_dt"),
        ({"engine": "phys"}, "phys"),
        ({"config": {"action": "joints"}}, "action: expected gait"),
        ({"action": "joints"}, "action"),
        ({"config": "nowhere.yaml"}, "nowhere.yaml"),
        ({"dtype": np.int32}, "float64 or float32, found int32"),
    ],
)
def test_what_is_wrong_is_said(settings: dict[str, Any], words: str) -> None:
    with pytest.raises(ConfigError, match=words):
        make(**settings)


def test_a_render_mode_that_is_not_known_is_an_error() -> None:
    with pytest.raises(ConfigError, match="render_mode"):
        crossgait.envs.AdaptiveGaitEnv(render_mode="depth")


def test_a_files_action_has_to_be_the_environments(tmp_path: Path) -> None:
    file = tmp_path / "env.yaml"
    file.write_text("action: joints\n")
    assert make(JOINTS, config=file).config.action == "joints"
    with pytest.raises(ConfigError, match="expected gait, which this environment is of, found joints"):
        make(GAIT, config=file)


# Spaces.


def test_spaces_are_the_layouts() -> None:
    env = make(JOINTS, joints={"limit": 2})
    space = env.observation_space
    assert isinstance(space, gymnasium.spaces.Box)
    assert space.shape == (len(env.layout.observation),) == (48,)
    assert space.dtype == np.float64
    assert env.action_space == gymnasium.spaces.Box(-2, 2, (12,), np.float32)
    low, high = env.layout.observation.box
    np.testing.assert_array_equal(space.low, low)
    np.testing.assert_array_equal(space.high, high)


def test_observations_of_float32_are_the_rounded_ones() -> None:
    single, double = make(dtype=np.float32), make()
    assert single.observation_space.dtype == np.float32
    seen = [env.reset(seed=1)[0] for env in (single, double)]
    for action in [*random_actions(single, 5), None]:
        assert seen[0].dtype == np.float32
        np.testing.assert_array_equal(seen[0], seen[1].astype(np.float32))
        if action is not None:
            seen = [env.step(action)[0] for env in (single, double)]


@pytest.mark.parametrize("env_id", IDS)
def test_random_actions_stay_in_the_observation_space(env_id: str, engine: str) -> None:
    env = make(env_id, engine=engine, terrain="rough", policy_dt=0.02)
    env.reset(seed=1)
    for action in random_actions(env, 200):
        observation, _, _, _, info = env.step(action)
        assert info["out_of_bounds"] == ()
        assert observation in env.observation_space


def test_numbers_out_of_bounds_are_named_and_not_clipped() -> None:
    env = make(config={"command": {"vx": 0.3}, "observation": ["base_position", "command"]})
    env.reset(seed=0)
    env.set_command(123, 0, -2000)
    observation, _, _, _, info = env.step(np.zeros(16))
    assert info["out_of_bounds"] == ("command.vx", "command.yaw_rate")
    assert observation[env.layout.observation.index("command.vx")] == 123
    assert observation not in env.observation_space
    _, info = env.reset()
    assert info["out_of_bounds"] == ()


# Episodes.


def test_seeds_are_the_cores(engine: str) -> None:
    env = make(engine=engine, randomisation={"start_yaw": [-1, 1]})
    core = _core.Environment(env.config)
    for seed in (0, 7, 2**64 - 1):
        observation, _ = env.reset(seed=seed)
        assert env.episode_seed == seed
        assert observation.tobytes() == core.reset(seed).tobytes()


def test_further_episodes_follow_from_the_seed() -> None:
    one, other = (make(randomisation={"start_yaw": [-1, 1]}) for _ in range(2))
    seeds = []
    for seed in (3, None, None, 3, None, None):
        a, b = one.reset(seed=seed)[0], other.reset(seed=seed)[0]
        assert a.tobytes() == b.tobytes()
        seeds.append(one.episode_seed)
        assert other.reset(seed=one.episode_seed)[0].tobytes() == a.tobytes()  # and each can be had again
        other.np_random = copy.deepcopy(one.np_random)
    assert len(set(seeds)) == 3
    assert seeds[:3] == seeds[3:]
    assert make().reset()[0].tobytes() != b""  # of no seed at all


def test_a_seed_beyond_64_bits_and_options_are_errors() -> None:
    env = make()
    with pytest.raises(ConfigError, match="seed"):
        env.reset(seed=2**64)
    with pytest.raises(ConfigError, match="options: expected none, found height"):
        env.reset(options={"height": 1})
    env.reset(options={})


def test_a_step_before_reset_and_actions_of_a_wrong_size_are_errors() -> None:
    env = make()
    with pytest.raises(ConfigError, match="reset"):
        env.step(np.zeros(16))
    env.reset(seed=0)
    with pytest.raises(ConfigError, match=r"shape \(16,\), found shape \(3,\)"):
        env.step(np.zeros(3))
    env.step([0.0] * 16)  # any sequence will do
    env.step(np.zeros(16, np.float32))


def test_looking_at_a_world_that_is_not_yet_drawn_is_an_error() -> None:
    env = make(randomisation={"friction": [0.5, 0.6]})
    for look in ("state", "terrain"):
        with pytest.raises(ConfigError, match="a reset before it"):
            getattr(env.core, look)
    env.reset(seed=0)
    assert env.core.state.time > 0


def test_infos_say_what_the_step_did(engine: str) -> None:
    env = make(engine=engine)
    _, info = env.reset(seed=0)
    assert info["time"] == 0
    for action in random_actions(env, 20):
        _, reward, _, _, info = env.step(action)
        # Summed up in another order.
        assert sum(info["reward_terms"].values()) == pytest.approx(reward, rel=1e-12)
    assert info["time"] == pytest.approx(20 * env.config.policy_dt)
    assert info["outcome"] == "walked"
    assert (info["ik_clamped"], info["invalid_actions"]) == (0, 0)
    assert set(info) == {
        *("time", "distance", "lateral", "power", "limit_factor", "ik_clamped", "invalid_actions", "clipped_actions"),
        *("outcome", "out_of_bounds", "reward_terms"),
    }
    actions = np.zeros(16)
    actions[[0, 3]] = np.nan, np.inf
    actions[5:7] = 1.5, -1
    info = env.step(actions)[4]
    assert (info["invalid_actions"], info["clipped_actions"]) == (2, 1)


def test_parameters_follow_the_actions() -> None:
    env = make()
    env.reset(seed=0)
    before = env.parameters
    action = np.zeros(16)
    action[env.layout.action.index("delta.step_length")] = -1
    env.step(action)
    after = env.parameters
    assert before is not None
    assert after is not None
    assert after["step_length"] < before["step_length"]
    assert {k: v for k, v in after.items() if k != "step_length"} == {
        k: v for k, v in before.items() if k != "step_length"
    }
    assert make(JOINTS).parameters is None


def test_a_command_holds_until_the_episode_ends() -> None:
    env = make(JOINTS, observation=["command"])
    first, _ = env.reset(seed=0)
    env.set_command(0.1, vy=-0.2, yaw_rate=0.5)
    assert env.step(np.zeros(12))[0].tolist() == [0.1, -0.2, 0.5]
    assert env.reset(seed=0)[0].tolist() == first.tolist()
    with pytest.raises(ConfigError, match="command"):
        env.set_command(float("nan"))


def test_the_time_of_an_episode_truncates_it_and_nothing_moves_after() -> None:
    env = make(episode_seconds=0.01)
    env.reset(seed=0)
    ends = [env.step(np.zeros(16))[2:4] for _ in range(6)]
    assert ends == [(False, False)] * 4 + [(False, True)] * 2


def test_an_episode_goes_on_from_where_it_was_saved(engine: str) -> None:
    env, other = make(engine=engine, terrain="rough"), make(engine=engine, terrain="rough")
    actions = random_actions(env, 60)
    env.reset(seed=1)
    for action in actions[:30]:
        env.step(action)
    saved = env.core.save()
    expected = [env.step(action) for action in actions[30:]]
    other.core.restore(saved)
    for action, before in zip(actions[30:], expected, strict=True):
        after = other.step(action)
        assert after[0].tobytes() == before[0].tobytes()
        assert after[1:] == before[1:]


# The same bits as C++.


def test_ten_thousand_steps_are_the_cores_bit_for_bit(engine: str) -> None:
    env = make(engine=engine, terrain="rough")
    core = _core.Environment(env.config)
    assert env.reset(seed=5)[0].tobytes() == core.reset(5).tobytes()
    for action in random_actions(env, 10_000):
        observation, reward, terminated, truncated, _ = env.step(action)
        expected, *rest = core.step(action)
        assert observation.tobytes() == expected.tobytes()
        assert [reward, terminated, truncated] == rest
    assert truncated
    assert env.core.summary() == core.summary()


def test_an_episode_is_that_of_the_program_to_the_last_digit(engine: str) -> None:
    """10,000 steps against `crossgait rollout`, whose first episode has derived_seed(seed, 0)."""
    command = [sys.executable, "-m", "crossgait", "rollout", "--policy", "zero", "--episodes", "1", "--seed", "11"]
    command += ["--engine", engine, "--terrain", "rough", "--workers", "1", "--json", "-"]
    output = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    expected = json.loads(output)["policies"][0]["episodes"][0]

    env = make(engine=engine, terrain="rough")
    env.reset(seed=_core.derived_seed(11, 0))
    assert env.episode_seed == expected["seed"]
    total, terms, steps, done = 0.0, defaultdict[str, float](float), 0, False
    while not done:
        _, reward, terminated, truncated, info = env.step(np.zeros(16))
        done = terminated or truncated
        total += reward
        steps += 1
        for name, value in info["reward_terms"].items():
            terms[name] += value
    assert steps == expected["steps"] == 10_000
    assert total == expected["total_reward"]
    assert {name: value for name, value in terms.items() if value != 0} == expected["reward_terms"]
    assert env.parameters == expected["parameters"]
    summary = json.loads(json.dumps(env.core.summary()))
    assert summary == {key: expected[key] for key in summary}


# Arrays, copies, specifications, wrappers.


def test_arrays_that_were_returned_stay_as_they_were() -> None:
    for dtype in (np.float64, np.float32):
        env = make(dtype=dtype)
        returned = [env.reset(seed=0)[0]]
        returned += [env.step(action)[0] for action in random_actions(env, 30)]
        env.reset(seed=1)
        again = make(dtype=dtype)
        expected = [again.reset(seed=0)[0].copy()]
        expected += [again.step(action)[0].copy() for action in random_actions(env, 30)]
        np.testing.assert_array_equal(returned, expected)
        returned[0][:] = 0  # and are the caller's
        env.step(np.zeros(16))


def test_environments_refuse_copies() -> None:
    env = make()
    for copied in (copy.copy, copy.deepcopy, pickle.dumps):
        with pytest.raises(TypeError, match="AdaptiveGaitEnv cannot be copied or pickled"):
            copied(env)


def test_specifications_can_be_pickled() -> None:
    for config in ({"terrain": "rough"}, EnvironmentConfig.parse("terrain: rough")):
        env = gymnasium.make(GAIT, config=config, dtype="float32", policy_dt=0.02)
        assert env.spec is not None
        spec = pickle.loads(pickle.dumps(env.spec))
        assert spec == env.spec
        again = gymnasium.make(spec)
        assert again.unwrapped.config == env.unwrapped.config
        assert again.reset(seed=1)[0].tobytes() == env.reset(seed=1)[0].tobytes()


def test_specifications_are_json() -> None:
    spec = gymnasium.make(GAIT, config={"terrain": "rough"}).spec
    assert spec is not None
    again = gymnasium.envs.registration.EnvSpec.from_json(spec.to_json())
    assert gymnasium.make(again).unwrapped.config.terrain == "rough"


@pytest.mark.parametrize("env_id", IDS)
def test_wrappers_work(env_id: str, engine: str) -> None:
    env: gymnasium.Env[Any, Any] = gymnasium.make(env_id, engine=engine, policy_dt=0.02)
    env = RecordEpisodeStatistics(NormalizeObservation(ClipAction(TimeLimit(env, 20))))
    observation, _ = env.reset(seed=0)
    total = 0.0
    for action in 3 * random_actions(env, 20):
        observation, reward, terminated, truncated, info = env.step(action)
        total += float(reward)
        assert not terminated
    assert truncated
    assert info["episode"]["l"] == 20
    assert info["episode"]["r"] == pytest.approx(total)
    assert np.abs(observation).max() < 10  # normalised: some standard deviations


@pytest.mark.parametrize(
    ("keyword", "meant"), [("dtyp", "dtype"), ("widht", "width"), ("worker", "workers"), ("n_envs", "num_envs")]
)
def test_keywords_of_environments_say_what_was_meant(keyword: str, meant: str) -> None:
    make = gymnasium.make_vec if meant in ("workers", "num_envs") else gymnasium.make
    with pytest.raises(TypeError, match=f"no keyword '{keyword}': did you mean '{meant}'"):
        make("Crossgait/JointControl-v0", **{keyword: 3})
    with pytest.raises(crossgait.ConfigError, match="did you mean friction"):
        make("Crossgait/JointControl-v0", frction=0.5)


def test_environments_say_what_they_are() -> None:
    from crossgait.sb3 import CrossgaitVecEnv

    said = "serial_quadruped in mujoco, policy steps of 20 ms>"
    keys: Any = {"engine": "mujoco", "robot": "serial_quadruped", "policy_dt": 0.02}
    env = gymnasium.make("Crossgait/JointControl-v0", **keys)
    assert repr(env.unwrapped) == f"<JointControlEnv: {said}"
    assert f"<JointControlEnv: {said}>" in str(env)  # what wrappers say holds it
    assert (
        repr(gymnasium.make_vec("Crossgait/JointControl-v0", num_envs=3, **keys))
        == f"<JointControlVectorEnv: 3 x {said}"
    )
    assert repr(CrossgaitVecEnv("Crossgait/JointControl-v0", 2, **keys)) == f"<CrossgaitVecEnv: 2 x {said}"


@pytest.mark.parametrize("shared", [crossgait.envs.QuadrupedEnv, crossgait.envs.QuadrupedVectorEnv])
def test_what_environments_share_is_none(shared):
    with pytest.raises(TypeError, match="make an AdaptiveGait or a JointControl environment"):
        shared(*([2] if "Vector" in shared.__name__ else []))


@pytest.mark.parametrize("mode", [AutoresetMode.SAME_STEP, AutoresetMode.NEXT_STEP])
def test_an_episode_that_is_ended_between_steps_is_told_once(mode: AutoresetMode) -> None:
    vector = gymnasium.make_vec(
        "Crossgait/JointControl-v0", num_envs=2, config={"robot": "serial_quadruped"}, autoreset_mode=mode
    )
    vector.reset(seed=0)
    still = np.zeros((2, 12))
    vector.step(still)
    vector.unwrapped.batch.end_episodes([True, False], [False, False])
    told = [vector.step(still) for _ in range(4)]
    assert [step[2].tolist() for step in told] == [[True, False], [False, False], [False, False], [False, False]]
    assert told[0][1][0] == 0
    vector.close()


@pytest.mark.parametrize("action", ["x", {}, [10**5000] * 12, [[1], [1, 2]], np.zeros(12, object), np.zeros(12) * 1j])
def test_actions_are_real_numbers(action: Any) -> None:
    environment = gymnasium.make("Crossgait/JointControl-v0", config={"robot": "serial_quadruped"}).unwrapped
    environment.reset(seed=0)
    with pytest.raises(ConfigError, match="action: expected an array of real numbers"):
        environment.step(action)
    environment.step(np.zeros(12, int))


def test_what_steps_a_closed_vector_says_so() -> None:
    closed = CrossgaitVecEnv(num_envs=2)
    closed.reset()
    closed.close()
    with pytest.raises(gymnasium.error.ClosedEnvironmentError):
        closed.step(np.zeros((2, 16)))
