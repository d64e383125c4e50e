"""Terms in Python: alone, in vectors, in rollouts and verdicts."""

from __future__ import annotations

import functools
import pickle
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
import training

import crossgait
import crossgait.envs
from crossgait import ConfigError, EnvironmentConfig, _core, terms
from crossgait.envs.termed_vector import TermedVectorEnvironment
from crossgait.train import Plan
from crossgait.train.trainer import Trainer

Env = crossgait.Batch
CONFIG = EnvironmentConfig(
    action="joints", robot="serial_quadruped", settle_seconds=0.1, episode_seconds=0.2, command={"vx": 0.4}
)


def forward(env: Env) -> np.ndarray:
    return env.base_linear_velocity_b[:, 0]


def height(env: Env) -> np.ndarray:
    return env.base_position[:, 2]


def nothing(env: Env) -> np.ndarray:
    return np.zeros(env.num_envs)


def lift(env: Env, indices: np.ndarray, way: float) -> None:
    qpos = env.qpos[indices]
    qpos[:, 2] += way
    env.set_state(qpos=qpos, indices=indices.tolist())


def slow(env: Env, speed: float) -> np.ndarray:
    return np.asarray((env.time > 0.09) & (np.abs(env.base_linear_velocity[:, 0]) < speed))


EVERY = terms.Terms(
    rewards={"forward": terms.RewardTerm(forward, weight=2.0), "air": terms.RewardTerm(terms.feet_air_time)},
    observations={
        "policy": {
            "height": terms.ObservationTerm(height, scale=2.0),
            "feet": terms.ObservationTerm(lambda e: e.foot_contacts),
        },
        "critic": {"forces": terms.ObservationTerm(lambda e: e.foot_forces.reshape(e.num_envs, -1))},
    },
    terminations={"slow": terms.TerminationTerm(slow, {"speed": 0.2})},
    events={
        "lift": terms.EventTerm(lift, params={"way": 0.05}),
        "push": terms.EventTerm(terms.push_by_setting_velocity, "interval", (0.04, 0.08), {"speed": 0.3}),
    },
)


def make(number: int, mine: terms.Terms | None, **keys: Any) -> crossgait.envs.JointControlVectorEnv:
    return crossgait.envs.JointControlVectorEnv(number, CONFIG, terms=mine, **keys)


def drawn(envs: crossgait.envs.JointControlVectorEnv, step: int) -> np.ndarray:
    shape = (envs.num_envs, len(envs.layout.action))
    return np.random.default_rng(step).uniform(-1, 1, shape)


@pytest.mark.parametrize("mode", ["NextStep", "SameStep", "Disabled"])
def test_terms_that_say_nothing_change_no_bit(mode: str) -> None:
    silent = terms.Terms(rewards={"nothing": terms.RewardTerm(nothing)})
    plain, termed = (make(3, own, autoreset_mode=mode, max_episode_steps=7) for own in (None, silent))
    assert np.array_equal(plain.reset(seed=3)[0], termed.reset(seed=3)[0])
    ends = 0
    for step in range(25):
        results = plain.step(drawn(plain, step)), termed.step(drawn(termed, step))
        for a, b in zip(results[0][:4], results[1][:4], strict=True):
            assert np.array_equal(a, b), step
        ended = results[0][2] | results[0][3]
        ends += int(ended.any())
        if mode == "Disabled" and ended.any():
            a, b = (envs.reset(options={"reset_mask": ended})[0] for envs in (plain, termed))
            assert np.array_equal(a, b), step
    assert ends > 2


def test_a_mask_begins_episodes_of_terms_and_leaves_the_others() -> None:
    """Curricula are told of those alone, events act on them, and rows of others stay as they were."""
    told: list[list[int]] = []
    lifted: list[list[int]] = []

    def levels(env: Any, ended: np.ndarray) -> None:
        told.append(ended.tolist())

    def lift(env: Any, begun: np.ndarray) -> None:
        lifted.append(begun.tolist())

    mine = terms.Terms(
        rewards={"forward": terms.RewardTerm(forward)},
        events={"lift": terms.EventTerm(lift, mode="reset")},
        curriculum={"levels": terms.CurriculumTerm(levels)},
    )
    envs = make(3, mine, autoreset_mode="Disabled")
    envs.reset(seed=1)
    seen, *_ = envs.step(drawn(envs, 0))
    mask = np.array([False, True, False])
    again, infos = envs.reset(options={"reset_mask": mask})
    assert told == [[1]]
    assert lifted == [[0, 1, 2], [1]]
    assert again[[0, 2]].tobytes() == seen[[0, 2]].tobytes()
    assert not np.array_equal(again[1], seen[1])
    assert infos["reward_terms"]["forward"].tolist()[1] == 0
    assert infos["_time"].tolist() == mask.tolist()


def test_one_environment_and_a_vector_of_one_are_the_same() -> None:
    envs = make(1, EVERY)
    seen, _ = envs.reset(seed=5)
    env = gymnasium.make("Crossgait/JointControl-v0", config=CONFIG, terms=EVERY)
    alone = env.unwrapped
    assert isinstance(alone, crossgait.envs.QuadrupedEnv)
    assert alone.layout == envs.layout
    assert alone.layout.observation.names[-5:] == ("height", "feet[0]", "feet[1]", "feet[2]", "feet[3]")
    first, _ = env.reset(seed=int(envs.episode_seeds[0]))
    # Events of the vector draw from its own seed, those of one environment from the episode's; lifting draws none.
    assert np.array_equal(first, seen[0])
    result, alone_result = envs.step(drawn(envs, 0)), env.step(drawn(envs, 0)[0])
    assert np.array_equal(result[0][0], alone_result[0])
    assert result[1][0] == alone_result[1]
    rewards = alone_result[4]["reward_terms"]
    assert rewards["forward"] == pytest.approx(2 * forward(alone.batch)[0], abs=1e-12)
    assert result[4]["reward_terms"]["forward"][0] == rewards["forward"]
    assert alone.layout.hash != crossgait.envs.JointControlEnv(CONFIG).layout.hash


def test_rewards_terminations_and_observations_are_what_the_functions_say() -> None:
    envs = make(4, EVERY, autoreset_mode="SameStep")
    plain = make(4, None, autoreset_mode="SameStep")
    envs.reset(seed=1)
    plain.reset(seed=1)
    ended = False
    for step in range(12):
        observations, rewards, terminated, _, infos = envs.step(drawn(envs, step))
        assert np.array_equal(observations[:, -5], 2 * envs.batch.base_position[:, 2])
        shown = infos["final_info"] if terminated.any() else infos
        of_terms = shown["reward_terms"]
        assert np.isfinite(rewards).all()
        if terminated.any():
            ended = True
            assert infos["final_obs"][np.flatnonzero(terminated)[0]].shape == observations[0].shape
            assert np.array_equal(of_terms["_forward"], terminated)
    assert ended  # random actions are slow
    assert envs.core.group("critic").shape == (4, 12)


def test_events_of_mode_step_come_after_each_where_episodes_go_on() -> None:
    called: list[list[int]] = []

    def remember(env: crossgait.Batch, indices: np.ndarray) -> None:
        called.append(indices.tolist())
        env.apply_wrench("trunk", force=(0, 0, 5), indices=indices)  # and it may act

    envs = make(2, terms.Terms(events={"every": terms.EventTerm(remember, "step")}), max_episode_steps=3)
    envs.reset(seed=1)
    for step in range(4):
        envs.step(drawn(envs, step))
    assert called == [[0, 1], [0, 1]]  # the third ends all episodes, the fourth begins others
    with pytest.raises(ConfigError, match="startup, reset, step, interval"):
        terms.Terms(events={"every": terms.EventTerm(remember, "substep")})


def test_rewards_of_terms_count_in_rollouts() -> None:
    config = crossgait.with_terms(CONFIG, EVERY)
    rolled = crossgait.rollout("zero", config, episodes=2, workers=2)
    plain = crossgait.rollout("zero", CONFIG, episodes=2)
    means = [r.to_frame()["total_reward"].mean() for r in (rolled, plain)]
    assert means[0] != means[1]


def test_episodes_of_a_rollout_do_not_hang_on_those_before_them() -> None:
    """Neither a curriculum, nor what was drawn as environments were made, nor parameters pass from one to the next."""
    levels = Levels()
    drawing = terms.EventTerm(terms.set_parameters_uniform, "startup", params={"mass": (10.0, 20.0)})
    mine = of_levels(levels)
    mass = terms.RewardTerm(lambda env: np.array([one["mass"] for one in env.parameters]))
    mine = terms.Terms({**mine.rewards, "mass": mass}, events={"start": drawing}, curriculum=mine.curriculum)
    config = crossgait.with_terms(CONFIG.updated(reward={}), mine)
    totals = [
        crossgait.rollout("zero", config, episodes=4, workers=workers).to_frame()["total_reward"].tolist()
        for workers in (1, 2, 3)
    ]
    assert totals[0] == totals[1] == totals[2]
    assert len(set(totals[0])) == 4  # each episode has drawn its own
    assert all(100 < total < 200 for total in totals[0])  # ten steps, and nothing of levels


def test_a_verdict_judges_a_policy_that_sees_terms() -> None:
    sizes: list[int] = []

    def policy() -> Any:
        def act(observation: np.ndarray) -> np.ndarray:
            sizes.append(len(observation))
            return np.full(12, 0.1 * observation[-5])

        return act

    config = crossgait.with_terms(CONFIG, terms.Terms(observations=EVERY.observations))
    judged = crossgait.verdict(
        crossgait.FunctionPolicy(policy),
        environment=config,
        engines=crossgait.available_engines()[:2],
        starts=4,
        workers=2,
    )
    assert judged.word
    assert set(sizes) == {48 + 5}


def test_what_cannot_carry_terms_says_so(tmp_path: Any) -> None:
    config = crossgait.with_terms(CONFIG, EVERY)
    assert config.updated(friction=0.5).terms is EVERY
    with pytest.raises(ConfigError, match="functions of the program"):
        pickle.loads(pickle.dumps(config))
    with pytest.raises(ConfigError, match="functions of the program"):
        EnvironmentConfig.parse(config.to_yaml())
    assert "rewards.forward" in config.to_yaml()


@pytest.mark.parametrize(
    ("function", "found"),
    [
        (lambda env: np.full(env.num_envs, np.nan), "nan in environment 0"),
        (lambda env: env.foot_forces, "shape (2, 4, 3)"),
        (lambda env: 1.0, "shape ()"),
        (lambda env: None, "None: is a return missing?"),
    ],
)
def test_a_term_that_is_wrong_is_named(function: Any, found: str) -> None:
    bad = terms.Terms(rewards={"mine": terms.RewardTerm(function)})
    envs = make(2, bad)
    envs.reset(seed=0)
    with pytest.raises(ConfigError, match=r"rewards\.mine") as error:
        envs.step(drawn(envs, 0))
    assert found in str(error.value)
    env = crossgait.envs.JointControlEnv(CONFIG, terms=bad)
    env.reset(seed=0)
    with pytest.raises(ConfigError, match=r"rewards\.mine"):
        env.step(drawn(envs, 0)[0])


def test_an_episode_that_a_term_terminates_is_no_walk() -> None:
    late = terms.Terms(terminations={"late": terms.TerminationTerm(lambda env: env.time > 0.05)})
    config = crossgait.with_terms({"action": "joints", "episode_seconds": 1}, late)
    rollout = crossgait.rollout("zero", config, episodes=2)
    frame = rollout.to_frame()
    assert frame["outcome"].tolist() == ["terminated"] * 2
    assert (frame["simulated_seconds"] < 0.1).all()
    assert rollout.to_dict()["policies"][0]["all"]["outcomes"]["terminated"] == 2
    assert rollout.to_dict()["policies"][0]["all"]["ended_early"] == 2
    assert "2 terminated" in str(rollout)
    judged = crossgait.verdict("zero", environment=config, starts=4)
    assert judged.statistic("failures")["values"] == [1, 1]
    envs = crossgait.envs.JointControlVectorEnv(2, {"action": "joints", "episode_seconds": 1}, terms=late)
    envs.reset(seed=0)
    for _ in range(40):
        _, _, terminated, _, infos = envs.step(np.zeros((2, 12), np.float32))
        if terminated.any():
            assert infos["outcome"].tolist() == ["terminated"] * 2
            break
    else:
        raise AssertionError("it ends")
    in_time = terms.Terms(terminations={"late": terms.TerminationTerm(lambda env: env.time > 0.05, time_out=True)})
    config = crossgait.with_terms({"action": "joints", "episode_seconds": 1}, in_time)
    assert crossgait.rollout("zero", config, episodes=1).to_frame()["outcome"].tolist() != ["terminated"]


def test_declarations_are_checked() -> None:
    mine = terms.Terms(observations={"policy": {"v_B.x": terms.ObservationTerm(lambda env: env.time)}})
    with pytest.raises(ConfigError, match=r"observations\.policy\.v_B\.x: expected a name that none"):
        crossgait.with_terms({"action": "joints"}, mine)
    for value in ("x", {}, [object()]):
        mine = terms.Terms(rewards={"mine": terms.RewardTerm(lambda env, given=value: given)})
        with pytest.raises(ConfigError, match=r"terms: rewards\.mine: expected (numbers|an array)"):
            crossgait.rollout("zero", crossgait.with_terms({"action": "joints"}, mine), episodes=1)
    with pytest.raises(ConfigError, match="none of the table's"):
        terms.Terms(rewards={"alive": terms.RewardTerm(nothing)})
    with pytest.raises(ConfigError, match="a RewardTerm"):
        terms.Terms(rewards={"mine": terms.ObservationTerm(nothing)})  # type: ignore[dict-item]
    with pytest.raises(ConfigError, match="interval"):
        terms.Terms(events={"push": terms.EventTerm(lift, "interval")})
    with pytest.raises(ConfigError, match="policy, critic"):
        terms.Terms(observations={"actor": {}})


def test_saving_an_environment_saves_its_terms() -> None:
    env = crossgait.envs.JointControlEnv(CONFIG, terms=EVERY)
    env.reset(seed=2)
    action = np.zeros(12)
    env.step(action)
    saved = env.core.save()
    expected = [env.step(action)[0] for _ in range(3)]
    env.core.restore(saved)
    for observation in expected:
        assert np.array_equal(env.step(action)[0], observation)


def test_a_batch_whose_environment_is_gone_is_an_error() -> None:
    kept: list[Env] = []

    def keeping(env: Env) -> np.ndarray:
        kept.append(env)
        return nothing(env)

    env = crossgait.envs.JointControlEnv(CONFIG, terms=terms.Terms(rewards={"mine": terms.RewardTerm(keeping)}))
    env.reset(seed=0)
    env.step(np.zeros(12))
    array = kept[0].qpos
    del env
    import gc

    gc.collect()
    assert np.isfinite(array).all()  # NumPy's own
    with pytest.raises(ConfigError, match="gone"):
        _ = kept[0].qvel


def test_curricula_and_remembering_terms_hear_of_episodes() -> None:
    class Steps:
        def __init__(self) -> None:
            self.since: dict[int, int] = {}

        def reset(self, env: Env, indices: np.ndarray) -> None:
            self.since |= dict.fromkeys(indices.tolist(), 0)

        def __call__(self, env: Env) -> np.ndarray:
            self.since = {i: n + 1 for i, n in self.since.items()}
            return np.array([self.since[i] for i in range(env.num_envs)], np.float64)

    heard: list[list[int]] = []
    mine = terms.Terms(
        rewards={"steps": terms.RewardTerm(Steps())},
        curriculum={"hear": terms.CurriculumTerm(lambda env, indices: heard.append(indices.tolist()))},
    )
    envs = make(2, mine, autoreset_mode="SameStep")
    envs.reset(seed=0)
    for _ in range(10):  # of 20 ms: an episode
        infos = envs.step(np.zeros((2, 12)))[4]
    assert heard == [[0, 1]]
    assert infos["final_info"]["reward_terms"]["steps"].tolist() == [10, 10]


class Levels:
    """A curriculum whose event and reward are methods of it."""

    def __init__(self) -> None:
        self.level, self.seen = 0, list[tuple[float, float]]()

    def __call__(self, env: Env, indices: np.ndarray) -> None:
        self.level += len(indices)
        self.seen += [(float(env.time[i]), float(env.base_position[i, 0])) for i in indices]

    def command(self, env: Env, indices: np.ndarray) -> None:
        env.set_commands([0.1 * self.level, 0, 0], indices.tolist())

    def own(self, env: Env) -> np.ndarray:
        return np.full(env.num_envs, self.level)

    def state(self) -> int:
        return self.level

    def restore(self, state: int) -> None:
        self.level = state


def of_levels(levels: Levels) -> terms.Terms:
    return terms.Terms(
        rewards={"own": terms.RewardTerm(levels.own)},
        events={"command": terms.EventTerm(levels.command)},
        curriculum={"level": terms.CurriculumTerm(levels)},
    )


def test_curricula_see_the_end_of_episodes_that_made_a_step() -> None:
    seen: list[list[float]] = []

    def look(env: Env, indices: np.ndarray) -> None:
        seen.append([round(float(env.time[i]), 6) for i in indices])

    mine = terms.Terms(curriculum={"look": terms.CurriculumTerm(look)})
    envs = make(2, mine, autoreset_mode="SameStep", max_episode_steps=3)
    envs.reset(seed=1)
    envs.reset(seed=1)  # nothing was made of the first
    for step in range(4):
        envs.step(drawn(envs, step))
    envs.reset(seed=2)
    envs.reset(seed=3)
    dt = CONFIG.policy_dt
    assert seen == [[pytest.approx(3 * dt)] * 2, [pytest.approx(dt)] * 2]
    seen.clear()
    alone = crossgait.envs.JointControlEnv(CONFIG, terms=mine)
    alone.reset(seed=1)
    alone.step(np.zeros(12))
    alone.step(np.zeros(12))
    alone.reset(seed=2)
    assert seen == [[pytest.approx(2 * dt)]]


def test_terms_that_are_one_object_are_one_copy_in_each_batch() -> None:
    levels = Levels()
    first, second = (make(2, of_levels(levels), autoreset_mode="SameStep", max_episode_steps=2) for _ in range(2))
    for envs in (first, second):
        envs.reset(seed=1)
        rewards = [envs.step(drawn(envs, step))[4]["reward_terms"]["own"].tolist() for step in range(3)]
        assert rewards == [[0, 0], [0, 0], [2, 2]]  # of the step that ends them none is left
        assert envs.batch.commands[:, 0].tolist() == pytest.approx([0.2, 0.2])
    assert levels.level == 0
    assert not levels.seen


def test_what_terms_keep_goes_on_in_other_environments() -> None:
    drawing = terms.EventTerm(terms.set_parameters_uniform, "startup", params={"friction": (0.3, 0.9)})
    mine = of_levels(Levels())
    mine = terms.Terms(mine.rewards, events={**mine.events, "start": drawing}, curriculum=mine.curriculum)
    first, second = (TermedVectorEnvironment(crossgait.with_terms(CONFIG, mine), 2) for _ in range(2))
    first.reset(3)
    first.step(np.zeros((2, 12)))
    first.batch().set_parameters({"mass": "x1.5", "solref": [0.01, 1], "cone": "pyramidal"}, [1])
    first.cut_off()
    kept = first.kept()
    assert kept["states"] == {"curriculum.level": 2}
    second.keep(kept)
    # In worlds of the same parameters the same seed is the same episode, and nothing is drawn anew.
    assert np.array_equal(second.reset(4), first.reset(4))
    assert second.batch().parameters == first.batch().parameters == kept["parameters"]
    assert kept["parameters"][1] | {"friction": 0} == {
        "friction": 0,
        "mass": "x1.5",
        "solref": [0.01, 1],
        "cone": "pyramidal",
    }
    for step in range(4):
        actions = np.random.default_rng(step).uniform(-1, 1, (2, 12))
        for a, b in zip(first.step(actions)[:4], second.step(actions)[:4], strict=True):
            assert np.array_equal(a, b)
    fresh = TermedVectorEnvironment(crossgait.with_terms(CONFIG, mine), 2)
    assert not np.array_equal(fresh.reset(4), first.reset(4))
    with pytest.raises(ConfigError, match="expected 3 environments, found 2"):
        TermedVectorEnvironment(crossgait.with_terms(CONFIG, mine), 3).keep(kept)
    other = TermedVectorEnvironment(crossgait.with_terms(CONFIG, terms.Terms(rewards=EVERY.rewards)), 2)
    other.keep(kept)
    with pytest.raises(ConfigError, match=r"expected states of none, found curriculum\.level"):
        other.reset(1)


def test_ready_terms_are_what_they_say() -> None:
    core = _core.VectorEnvironment(CONFIG, 2)
    core.reset(0)
    batch = core.batch()
    core.step(np.zeros((2, 12)))
    middle = batch.joint_limits.mean(axis=1)
    qpos = np.concatenate([[0, 0, 1, 1, 0, 0, 0], middle])
    batch.set_state(qpos, np.zeros(18))
    assert not terms.joint_pos_limits(batch).any()
    qpos[7] = batch.joint_limits[0, 1]
    batch.set_state(qpos)
    half = np.diff(batch.joint_limits[0])[0] / 2
    assert terms.joint_pos_limits(batch, soft=0.9) == pytest.approx([0.1 * half] * 2, abs=1e-9)
    assert not terms.undesired_contacts(batch, ["trunk"]).any()
    batch.set_state(np.concatenate([[0, 0, 0.05, 0, 1, 0, 0], middle]))  # on its back, in the ground
    core.step(np.zeros((2, 12)))
    assert terms.illegal_contact(batch, ["trunk"]).all()
    assert terms.base_height_below(batch, 0.5).all()


def test_a_reward_in_five_lines_is_trained_and_judged(tmp_path: Path) -> None:
    def calm(env: crossgait.Batch) -> np.ndarray:
        return np.exp(-np.square(env.base_linear_velocity_b[:, 2]) / 0.01)

    mine = terms.Terms(rewards={"calm": terms.RewardTerm(calm, weight=0.5)})
    asked = {"engines": ["mujoco"], "episodes": 1, "final_episodes": 1, "every": 160}
    plan = Plan.parse(training.small(steps=160, evaluation=asked, environments=2), "test").with_terms(mine)
    trainer = Trainer(plan, tmp_path, resume=False)
    trainer.run()
    config = trainer.plan.evaluated
    assert config.terms is mine
    judged = crossgait.verdict(
        tmp_path / "last.safetensors",
        environment=config,
        engines=crossgait.available_engines()[:2],
        starts=4,
    )
    assert judged.word
    without = crossgait.with_terms(config, terms.Terms())
    plain = crossgait.rollout(tmp_path / "last.safetensors", without, episodes=1).to_frame()
    rollout = crossgait.rollout(tmp_path / "last.safetensors", config, episodes=2)
    termed = rollout.to_frame()
    assert termed["total_reward"].iloc[0] > plain["total_reward"].iloc[0]
    of_terms = termed[[column for column in termed if column.startswith("reward_terms.")]]
    assert (termed["reward_terms.calm"] > 0).all()
    assert of_terms.sum(axis=1).to_numpy() == pytest.approx(termed["total_reward"].to_numpy())
    mean = rollout.to_dict()["policies"][0]["all"]["reward_terms"]["calm"]
    assert mean == pytest.approx(termed["reward_terms.calm"].mean())
    assert "  calm" in str(rollout)


def test_a_plan_trains_with_terms_and_evaluates_them(tmp_path: Path) -> None:
    mine = terms.Terms(
        rewards={"forward": terms.RewardTerm(forward)},
        observations={"policy": {"height": terms.ObservationTerm(height)}},
    )
    asked = {"engines": ["mujoco"], "episodes": 1, "final_episodes": 1, "every": 160}
    plan = Plan.parse(training.small(steps=160, evaluation=asked, environments=2), "test")
    trainer = Trainer(plan.with_terms(mine), tmp_path, resume=False)
    trainer.run()
    policy = crossgait.Policy.load(tmp_path / "last.safetensors", trainer.plan.evaluated)
    assert policy.layout.observation.names[-1] == "height"
    with pytest.raises(ConfigError, match=r"Plan\.with_terms"):
        Plan.parse(trainer.plan.document, "again")


def test_runs_of_terms_are_not_kept(tmp_path: Path) -> None:
    """Functions are in no file: another reward of the same name would be answered with the runs of the first."""
    own = crossgait.with_terms(
        {"action": "joints", "robot": "serial_quadruped", "episode_seconds": 0.2},
        crossgait.Terms(rewards={"height": terms.RewardTerm(lambda env: env.base_height)}),
    )
    with pytest.raises(ConfigError, match="runs: expected none: what is in no file"):
        crossgait.verdict("zero", environment=own, starts=4, runs=tmp_path / "runs.jsonl")


def test_terms_that_were_interrupted_are_made_again() -> None:
    class Kept:
        copies = 0

        def __call__(self, env: crossgait.Batch) -> Any:
            return np.zeros(env.num_envs)

        def reset(self, env: crossgait.Batch, indices: Any) -> None:
            pass

        def __deepcopy__(self, memo: dict[int, Any]) -> Kept:
            Kept.copies += 1
            if Kept.copies == 1:
                raise KeyboardInterrupt
            return self

    core = _core.Environment(crossgait.with_terms({}, crossgait.Terms(rewards={"kept": terms.RewardTerm(Kept())})))
    with pytest.raises(KeyboardInterrupt):
        core.reset(0)
    assert core.reset(0).shape == (69,)
    assert Kept.copies == 2


@pytest.mark.parametrize(
    ("declare", "words"),
    [
        (lambda: terms.RewardTerm(forward, weight=float("nan")), "RewardTerm: weight: expected a finite number"),
        (lambda: terms.ObservationTerm(forward, noise=-1), "ObservationTerm: noise: expected 0 or more, found -1"),
        (lambda: terms.ObservationTerm(forward, clip=0), "ObservationTerm: clip: expected more than 0, found 0"),
        (lambda: terms.TerminationTerm("fallen"), "TerminationTerm: function: expected a function"),
        (lambda: terms.EventTerm(lambda env, indices: None, "sometimes"), "EventTerm: mode: expected startup, reset"),
        (lambda: terms.EventTerm(lambda env, indices: None, "interval"), "EventTerm: interval: expected .min, max. s"),
        (lambda: terms.EventTerm(lambda env, indices: None, "interval", (2, 1)), "expected 0 < min <= max"),
        (lambda: terms.CurriculumTerm(lambda env: None), "CurriculumTerm: params: expected what"),
    ],
)
def test_a_term_is_checked_where_it_is_declared(declare: Any, words: str) -> None:
    with pytest.raises(ConfigError, match=words):
        declare()


def test_terms_at_work_and_what_they_show_can_be_read() -> None:
    """Of one environment and of many: a curriculum's level, a critic's numbers."""

    class Level:
        level = 0

        def __call__(self, env: Any, indices: np.ndarray) -> None:
            self.level += len(indices)

        def reset(self, env: Any, indices: np.ndarray) -> None:
            """What remembers says when."""

    given = Level()
    mine = terms.Terms(
        observations={"critic": {"height": terms.ObservationTerm(lambda env: env.base_height)}},
        curriculum={"level": terms.CurriculumTerm(given)},
    )
    one = crossgait.envs.JointControlEnv(CONFIG, terms=mine, episode_seconds=0.04)
    many = make(2, mine, max_episode_steps=2, autoreset_mode="SameStep")
    for envs in (one, many):
        with pytest.raises(ConfigError, match="group: expected terms, and a reset"):
            envs.group("critic")
        envs.reset(seed=0)
        assert envs.terms is not None
        assert envs.terms.curriculum["level"].function.level == 0
        assert np.array_equal(envs.group("critic").ravel(), envs.batch.base_height)
        with pytest.raises(ConfigError, match="one of policy, critic"):
            envs.group("crtic")
    for _ in range(4):
        many.step(np.zeros(many.action_space.shape))
    assert many.terms is not None
    assert many.terms.curriculum["level"].function.level == 4
    one.step(np.zeros(one.action_space.shape))
    one.reset(seed=1)
    assert one.terms is not None
    assert one.terms.curriculum["level"].function.level == 1
    assert given.level == 0  # each has its own
    plain = make(2, None)
    plain.reset(seed=0)
    assert plain.terms is None
    with pytest.raises(ConfigError, match="expected terms, and a reset"):
        plain.group("critic")


@pytest.mark.parametrize("mode", ["NextStep", "SameStep", "Disabled"])
@pytest.mark.parametrize("time_out", [False, True])
def test_a_failure_that_a_term_declares_costs_what_any_costs(mode: str, time_out: bool) -> None:
    """In a vector as in one environment, to the bit, and in the table's own row of infos."""
    mine = terms.Terms(
        rewards={"forward": terms.RewardTerm(forward)},
        terminations={"late": terms.TerminationTerm(lambda env: env.time > 0.03, time_out=time_out)},
    )
    keys = {"reward": {"termination": -10.0, "alive": 0.1, "action_l2": -0.3}}
    one = crossgait.envs.JointControlEnv(CONFIG, terms=mine, **keys)
    many = make(2, mine, autoreset_mode=mode, **keys)
    one.reset(seed=1)
    many.reset(seed=[1, 2])
    for step in range(2):
        actions = drawn(many, step)
        _, reward, *flags, info = one.step(actions[0])
        _, rewards, terminated, truncated, infos = many.step(actions)
        assert reward == rewards[0]
        assert flags == [terminated[0], truncated[0]]
        told = infos.get("final_info", infos)
        assert info["reward_terms"]["termination"] == told["reward_terms"]["termination"][0]
    assert flags == [not time_out, time_out]
    assert info["reward_terms"]["termination"] == (0 if time_out else -10)


def test_looking_at_a_group_changes_nothing() -> None:
    """Though noise is drawn for it, which is the same all through a step."""
    noisy = terms.ObservationTerm(lambda env: env.base_linear_velocity, noise=0.5)
    push = terms.EventTerm(terms.push_by_setting_velocity, "interval", (0.02, 0.04), {"speed": 0.5})
    mine = terms.Terms(observations={"policy": {"p": noisy}, "critic": {"v": noisy}}, events={"push": push})

    def seen(look: bool) -> tuple[list[bytes], list[np.ndarray]]:
        envs, looks, steps = make(2, mine), [], []
        envs.reset(seed=3)
        for step in range(6):
            if look:
                first, again = envs.group("critic"), envs.group("critic")
                assert first.tobytes() == again.tobytes() == np.float64(first).tobytes()
                looks.append(first)
            steps.append(envs.step(drawn(envs, step))[0].tobytes())
        return steps, looks

    steps, looks = seen(True)
    assert steps == seen(False)[0]
    assert len({look.tobytes() for look in looks}) == len(looks)


def test_seeds_repeat_what_terms_draw() -> None:
    """Of all environments together, and of a mask's: they draw from one stream."""
    offset = terms.EventTerm(terms.reset_joints_by_offset, "reset", params={"offset": 0.2})
    envs = make(2, terms.Terms(events={"offset": offset}), autoreset_mode="Disabled")
    assert envs.reset(seed=[3, 4])[0].tobytes() == envs.reset(seed=[3, 4])[0].tobytes()
    masked = [envs.reset(seed=[5, 6], options={"reset_mask": np.array([True, False])})[0] for _ in range(2)]
    assert masked[0].tobytes() == masked[1].tobytes()
    alone = make(1, terms.Terms(events={"offset": offset}))
    one = crossgait.envs.JointControlEnv(CONFIG, terms=terms.Terms(events={"offset": offset}))
    assert alone.reset(seed=[3])[0][0].tobytes() == one.reset(seed=3)[0].tobytes()


def test_wrapped_functions_take_what_their_wrapper_takes() -> None:
    @functools.wraps(forward)
    def scaled(env: Any, scale: float = 1.0) -> Any:
        return scale * forward(env)

    terms.RewardTerm(scaled, params={"scale": 2.0})
    with pytest.raises(ConfigError, match="TerminationTerm: time_out: expected True or False, found 'no'"):
        terms.TerminationTerm(forward, time_out="no")  # type: ignore[arg-type]
    with pytest.raises(ConfigError, match="RewardTerm: weight: expected a finite number"):
        terms.RewardTerm(forward, weight=10**400)
    terms.EventTerm(lambda env, indices: None, "interval", np.array([1.0, 2.0]))  # type: ignore[arg-type]
