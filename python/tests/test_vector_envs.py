from __future__ import annotations

import copy
import itertools
import pickle
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import data_equivalence
from gymnasium.vector import AutoresetMode, SyncVectorEnv, VectorEnv
from gymnasium.wrappers.vector import DictInfoToList, NormalizeObservation, RecordEpisodeStatistics

import crossgait.envs
from crossgait import ConfigError, _core

GAIT, JOINTS = "Crossgait/AdaptiveGait-v0", "Crossgait/JointControl-v0"
# Episodes of 8 policy steps, each another; some fall before.
SHORT = {
    "policy_dt": 0.02,
    "episode_seconds": 0.16,
    "settle_seconds": 0.02,
    "tilt_limit_deg": 6,
    "residual_scale": 0.03,
    "randomisation": {"start_yaw": [-1, 1]},
}


def make_native(num_envs: int, env_id: str = GAIT, **settings: Any) -> crossgait.envs.QuadrupedVectorEnv:
    envs = gymnasium.make_vec(env_id, num_envs=num_envs, vectorization_mode="vector_entry_point", **settings)
    assert isinstance(envs, crossgait.envs.QuadrupedVectorEnv)
    return envs


def random_actions(envs: VectorEnv[Any, Any, Any], count: int) -> np.ndarray:
    return np.random.default_rng(0).uniform(-1, 1, (count, *envs.action_space.shape))


class WithSeedsOf(gymnasium.Wrapper[Any, Any, Any, Any]):
    """Begins its k-th episode with derived_seed(seed, k), as environments of the core's vector do."""

    def __init__(self, env: gymnasium.Env[Any, Any], seed: int) -> None:
        super().__init__(env)
        self.seeds = (_core.derived_seed(seed, k) for k in itertools.count())

    def reset(self, **_: Any) -> tuple[Any, dict[str, Any]]:
        return self.env.reset(seed=next(self.seeds))


@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
def test_all_is_what_gymnasium_makes_of_single_environments(mode: AutoresetMode, engine: str) -> None:
    """Observations, rewards, flags, infos, final ones too, over several episodes: equal to the last bit."""
    count, seed = 3, 11
    native = make_native(count, engine=engine, autoreset_mode=mode, workers=2, **SHORT)
    singles = [
        lambda i=i: WithSeedsOf(
            gymnasium.make(GAIT, engine=engine, disable_env_checker=True, **SHORT), _core.derived_seed(seed, i)
        )
        for i in range(count)
    ]
    sync = SyncVectorEnv(singles, autoreset_mode=mode)
    assert native.metadata["autoreset_mode"] == sync.metadata["autoreset_mode"] == mode
    assert native.observation_space == sync.observation_space
    assert native.action_space == sync.action_space
    assert data_equivalence(native.reset(seed=seed), sync.reset(), exact=True)
    terminated = truncated = 0
    for actions in random_actions(native, 60):
        a, b = native.step(actions), sync.step(actions)
        assert data_equivalence(a, b, exact=True)
        terminated, truncated = terminated + int(a[2].sum()), truncated + int(a[3].sum())
        assert ("final_obs" in a[4]) == (mode == AutoresetMode.SAME_STEP and bool((a[2] | a[3]).any()))
    assert min(terminated, truncated) > 0
    assert terminated + truncated > 3 * count


def test_workers_change_nothing() -> None:
    runs = []
    for workers in (1, 2, 5):
        envs = make_native(5, JOINTS, workers=workers, terrain="rough", episode_seconds=0.1)
        assert envs.core.workers == workers
        seen = [envs.reset(seed=2)[0].tobytes()]
        for actions in random_actions(envs, 12):
            observations, rewards, *_ = envs.step(actions)
            seen += [observations.tobytes(), rewards.tobytes()]
        runs.append(seen)
    assert runs[0] == runs[1] == runs[2]
    assert len(set(runs[0])) > 20


def test_its_bits_are_the_cores() -> None:
    envs = make_native(3, terrain="rough")
    core = _core.VectorEnvironment(envs.config, 3)
    assert envs.reset(seed=4)[0].tobytes() == core.reset(4).tobytes()
    for actions in random_actions(envs, 50):
        for a, b in zip(envs.step(actions)[:4], core.step(actions)[:4], strict=True):
            assert a.tobytes() == b.tobytes()


def test_every_episode_can_be_had_again_alone() -> None:
    envs = make_native(3, autoreset_mode="SameStep", **SHORT)
    single = gymnasium.make(GAIT, **SHORT).unwrapped
    observations, _ = envs.reset(seed=8)
    for actions in [None, *random_actions(envs, 9)]:
        if actions is not None:
            observations, _, terminated, truncated, _ = envs.step(actions)
            begun = np.flatnonzero(terminated | truncated)
        else:
            begun = np.arange(3)
        for i in begun:
            assert single.reset(seed=int(envs.episode_seeds[i]))[0].tobytes() == observations[i].tobytes()


def test_further_resets_follow_from_the_seed() -> None:
    one, other = make_native(2, **SHORT), make_native(2, **SHORT)
    seen = [[envs.reset(seed=s)[0].tobytes() for s in (1, None, None)] for envs in (one, other)]
    assert seen[0] == seen[1]
    assert len(set(seen[0])) == 3


@pytest.mark.parametrize("engine", ["mujoco", "bullet"])
def test_without_resets_of_its_own_it_is_what_gymnasium_makes(engine: str) -> None:
    """Episodes are begun by masks, with seeds of each: equal to the last bit."""
    count = 3
    native = make_native(count, engine=engine, autoreset_mode=AutoresetMode.DISABLED, workers=2, **SHORT)
    singles = [lambda: gymnasium.make(GAIT, engine=engine, disable_env_checker=True, **SHORT)] * count
    sync = SyncVectorEnv(singles, autoreset_mode=AutoresetMode.DISABLED)
    assert native.metadata["autoreset_mode"] == AutoresetMode.DISABLED
    assert data_equivalence(native.reset(seed=[5, 6, 7]), sync.reset(seed=[5, 6, 7]), exact=True)
    begun = 0
    for step, actions in enumerate(random_actions(native, 40)):
        a, b = native.step(actions), sync.step(actions)
        assert data_equivalence(a, b, exact=True)
        ended = a[2] | a[3]
        if ended.any():
            seeds: list[int | None] = [100 * step + i for i in range(count)]
            a[0][:] = np.nan  # the caller's to do with as they like
            again = native.reset(seed=seeds, options={"reset_mask": ended})
            observations, _ = sync.reset(seed=seeds, options={"reset_mask": ended.copy()})
            assert again[0].tobytes() == observations.tobytes()
            assert again[1]["_time"].tolist() == ended.tolist()
            begun += int(ended.sum())
    assert begun > 2 * count


def test_the_next_episodes_of_a_mask_are_those_that_would_have_followed() -> None:
    masked = make_native(2, autoreset_mode="Disabled", **SHORT)
    same_step = make_native(2, autoreset_mode="SameStep", **SHORT)
    assert masked.reset(seed=3)[0].tobytes() == same_step.reset(seed=3)[0].tobytes()
    begun = 0
    for actions in random_actions(masked, 20):
        _, rewards, terminated, truncated, _ = masked.step(actions)
        observations, as_told, *flags, _ = same_step.step(actions)
        assert rewards.tobytes() == as_told.tobytes()
        assert [flag.tolist() for flag in flags] == [terminated.tolist(), truncated.tolist()]
        if (ended := terminated | truncated).any():
            assert masked.reset(options={"reset_mask": ended})[0][ended].tobytes() == observations[ended].tobytes()
            assert masked.episode_seeds.tolist() == same_step.episode_seeds.tolist()
            begun += 1
    assert begun > 1


def test_a_seed_beside_a_mask_begins_what_it_begins_everywhere() -> None:
    every, some = (make_native(3, **SHORT) for _ in range(2))
    expected, _ = every.reset(seed=9)
    first, _ = some.reset(seed=1)
    mask = np.array([True, False, True])
    seen, _ = some.reset(seed=9, options={"reset_mask": mask})
    assert seen[mask].tobytes() == expected[mask].tobytes()
    assert seen[1].tobytes() == first[1].tobytes()
    kept = seen.copy()
    seen[:] = 0  # the caller's to do with as they like
    assert some.reset(options={"reset_mask": mask})[0][1].tobytes() == kept[1].tobytes()
    assert some.reset(seed=np.array(9))[0].tobytes() == expected.tobytes()  # type: ignore[arg-type]


def test_seeds_of_each_are_those_of_single_environments() -> None:
    envs = make_native(3, **SHORT)
    seeds = [4, 2**64 - 1, None]
    observations, _ = envs.reset(seed=seeds)
    assert envs.episode_seeds[:2].tolist() == seeds[:2]
    single = gymnasium.make(GAIT, **SHORT).unwrapped
    for i, seed in enumerate(envs.episode_seeds):
        assert single.reset(seed=int(seed))[0].tobytes() == observations[i].tobytes()
    assert envs.reset(seed=np.array([1, 2, 3]))[0].tobytes() == envs.reset(seed=[1, 2, 3])[0].tobytes()


@pytest.mark.parametrize(
    ("asked", "words"),
    [
        ({"seed": [1, 2]}, "seed: expected an integer, or 3 of them, found 2"),
        ({"seed": [1, -2, 3]}, "seed: expected integers of 0 to 2.64 - 1, or None, found -2"),
        ({"seed": [1, 2.5, 3]}, "found 2.5"),
        ({"seed": [True, 2, 3]}, "found True"),
        ({"seed": b"abc"}, "seed: expected an integer, or 3 of them, found b'abc'"),
        ({"options": "x"}, "options: expected a mapping, found 'x'"),
        ({"options": {"reset_mask": [True, False, False]}}, "a NumPy array of bool of shape .3,., at least one"),
        ({"options": {"reset_mask": np.zeros(3, np.bool_)}}, "at least one of them True"),
        ({"options": {"reset_mask": np.ones(2, np.bool_)}}, "of shape .3,."),
        ({"options": {"mask": np.ones(3, np.bool_)}}, "options: expected reset_mask alone, found mask"),
    ],
)
def test_wrong_seeds_and_masks_are_refused(asked: dict[str, Any], words: str) -> None:
    envs = make_native(3, **SHORT)
    with pytest.raises(ConfigError, match="reset_mask: expected a reset of all before it"):
        envs.reset(options={"reset_mask": np.ones(3, np.bool_)})
    envs.reset(seed=0)
    with pytest.raises(ConfigError, match=words):
        envs.reset(**asked)


def test_without_resets_of_its_own_nothing_is_stepped_beyond_an_end() -> None:
    envs = make_native(2, autoreset_mode=AutoresetMode.DISABLED, **SHORT)
    envs.reset(seed=0)
    ended = np.zeros(2, np.bool_)
    while not ended.any():
        _, _, terminated, truncated, _ = envs.step(np.zeros(envs.action_space.shape))
        ended = terminated | truncated
    with pytest.raises(ConfigError, match=f"of those whose episode has ended, found {ended.sum()} that have"):
        envs.step(np.zeros(envs.action_space.shape))
    envs.reset(options={"reset_mask": ended})
    envs.step(np.zeros(envs.action_space.shape))


def test_asynchronous_ones_of_gymnasium_are_synchronous_ones() -> None:
    settings = {"terrain": "rough", "policy_dt": 0.02, "episode_seconds": 0.1}
    sync = gymnasium.make_vec(GAIT, 2, "sync", **settings)
    processes = gymnasium.make_vec(GAIT, 2, "async", {"context": "spawn"}, **settings)
    try:
        assert data_equivalence(processes.reset(seed=1), sync.reset(seed=1), exact=True)
        for actions in random_actions(sync, 8):
            assert data_equivalence(processes.step(actions), sync.step(actions), exact=True)
    finally:
        processes.close()


def test_arrays_that_were_returned_stay_as_they_were() -> None:
    envs = make_native(2, autoreset_mode="SameStep", **SHORT)
    kept, copies = [], []
    envs.reset(seed=0)
    for actions in random_actions(envs, 20):
        kept.append(envs.step(actions))
        copies.append(copy.deepcopy(kept[-1]))
    assert data_equivalence(tuple(kept), tuple(copies), exact=True)


def test_settings() -> None:
    envs = make_native(4, JOINTS, dtype=np.float32, max_episode_steps=3, terrain="rough")
    assert envs.single_observation_space.dtype == np.float32
    assert envs.reset(seed=0)[0].dtype == np.float32
    ends = [bool(envs.step(np.zeros((4, 12)))[3].all()) for _ in range(4)]
    assert ends == [False, False, True, False]
    assert envs.metadata["render_fps"] == 50
    assert envs.layout.observation.index("command.vx") == 45
    assert pickle.loads(pickle.dumps(envs.spec)).kwargs["num_envs"] == 4
    envs.close()
    envs.close()


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"autoreset_mode": "never"}, "NextStep, SameStep or Disabled"),
        ({"num_envs": 0}, "num_envs: expected an integer of at least 1, found 0"),
        ({"num_envs": "a"}, "num_envs: expected an integer of at least 1, found 'a'"),
        ({"max_episode_steps": 1.5}, "max_episode_steps: expected an integer of at least 1, found 1.5"),
        ({"width": 0}, "width: expected an integer of at least 1, found 0"),
        ({"dtype": ">f4"}, "dtype: expected float64 or float32, found '>f4'"),
        ({"dtype": "zzz"}, "dtype: expected float64 or float32, found 'zzz'"),
        ({"workers": 0}, "workers"),
        ({"terrain": "moon"}, "moon"),
        ({"render_mode": "human"}, "render_mode"),
    ],
)
def test_what_is_wrong_is_said(settings: dict[str, Any], words: str) -> None:
    with pytest.raises(ConfigError, match=words):
        crossgait.envs.AdaptiveGaitVectorEnv(**{"num_envs": 2} | settings)


def test_commands_are_one_for_all_or_one_each() -> None:
    envs = make_native(3, JOINTS, observation=["command"])
    envs.reset(seed=0)
    envs.set_command([0.1, 0.2, 0.3], yaw_rate=0.5)
    expected = [[0.1, 0, 0.5], [0.2, 0, 0.5], [0.3, 0, 0.5]]
    assert envs.step(np.zeros((3, 12)))[0].tolist() == expected


def test_numbers_out_of_bounds_are_named_for_each() -> None:
    envs = make_native(3, JOINTS, observation=["command"], autoreset_mode="SameStep", episode_seconds=0.04)
    envs.reset(seed=0)
    envs.core.environment(1).set_command(1e3)
    infos = envs.step(np.zeros((3, 12)))[4]
    assert infos["out_of_bounds"].tolist() == [(), ("command.vx",), ()]
    infos = envs.step(np.zeros((3, 12)))[4]
    assert infos["final_info"]["out_of_bounds"].tolist() == [(), ("command.vx",), ()]
    assert infos["out_of_bounds"].tolist() == [(), (), ()]


def test_one_of_them_can_be_looked_at() -> None:
    envs = make_native(2)
    with pytest.raises(ConfigError, match="a reset before it"):
        _ = envs.episode_seeds
    envs.reset(seed=0)
    view = envs.core.environment(1)
    del envs  # it keeps what it looks at
    assert view.state.time == pytest.approx(0.5)  # settle_seconds
    assert view.summary()["outcome"] == "walked"
    with pytest.raises(IndexError):
        make_native(2).core.environment(2)


def test_environments_refuse_copies() -> None:
    envs = make_native(2)
    for copied in (copy.copy, copy.deepcopy, pickle.dumps):
        with pytest.raises(TypeError, match="AdaptiveGaitVectorEnv cannot be copied or pickled"):
            copied(envs)


def test_wrappers_work() -> None:
    envs = NormalizeObservation(RecordEpisodeStatistics(make_native(2, **SHORT)))
    envs.reset(seed=0)
    lengths = []
    for actions in random_actions(envs, 30):
        _, _, terminated, truncated, infos = envs.step(actions)
        if (terminated | truncated).any():
            lengths += infos["episode"]["l"][infos["_episode"]].tolist()
    assert lengths
    assert max(lengths) == 8
    listed = DictInfoToList(make_native(2, **SHORT))
    _, infos = listed.reset(seed=0)
    assert [info["time"] for info in infos] == [0, 0]
