"""Simulated seconds per core-second of environments, against C++ alone and against what a user would write instead.

    python python/benchmarks/against_others.py --program build/release/benchmarks/programs/vector_env_steps
           [--robot FILE.urdf] [--policy-dt .02 --policy-dt .002] [--rounds 15] [--only REGEX] [--json FILE]

All in turns, every second round the other way round so that a machine that gets slower favours nobody; medians
(quartiles) over rounds, ratios within a round, with the interval that holds their median with 95 %. Core-seconds are
CPU time of all processes of a contender; where several cores work at once the time on the wall decides.
`numpy_quadruped.py` holds the environments over the mujoco package and PyBullet (`pip install pybullet==3.2.7`; without
it its line is missing).
"""

from __future__ import annotations

import argparse
import functools
import importlib.util
import json
import re
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import gymnasium
import numpy as np
import psutil
from numpy_quadruped import CONTROL_DT, MujocoNumpyEnv, NumpyQuadrupedEnv, PybulletNumpyEnv
from stable_baselines3.common.vec_env import SubprocVecEnv

import crossgait.envs

ID = "Crossgait/AdaptiveGait-v0"
ROOT = Path(__file__).parents[2]


class Turn(NamedTuple):
    """What a turn took."""

    simulated: float  # s, of all environments together
    cpu: float
    wall: float


Contender = Callable[[float], Turn]  # takes the simulated seconds to make at least


def children_seconds() -> float:
    """CPU time of this process' children, which psutil tells in 10 ms, s. To ask takes milliseconds itself."""
    times = [p.cpu_times() for p in psutil.Process().children(recursive=True)]
    return sum(t.user + t.system for t in times)


def timed(simulated: float, work: Callable[[], object]) -> Turn:
    """A turn of this process and its children."""
    children = children_seconds()
    own, wall = time.process_time(), time.perf_counter()
    work()
    own, wall = time.process_time() - own, time.perf_counter() - wall
    return Turn(simulated, own + children_seconds() - children, wall)


def gymnasium_turns(env: Any, policy_dt: float, count: int) -> Contender:
    """Of an environment, or a batch of them, with zero actions; an episode that ends begins anew."""
    action = np.zeros(env.action_space.shape, np.float32)

    def turn(seconds: float) -> Turn:
        steps = max(1, round(seconds / (count * policy_dt)))
        env.reset(seed=1)

        def work() -> None:
            for _ in range(steps):
                _, _, terminated, truncated, _ = env.step(action)
                if count == 1 and (terminated or truncated):
                    env.reset()

        return timed(steps * count * policy_dt, work)

    return turn


def subprocess_turns(envs: SubprocVecEnv, policy_dt: float) -> Contender:
    """Of Stable-Baselines3's environments in processes."""
    actions = np.zeros((envs.num_envs, 16), np.float32)

    def turn(seconds: float) -> Turn:
        steps = max(1, round(seconds / (envs.num_envs * policy_dt)))
        envs.reset()
        return timed(steps * envs.num_envs * policy_dt, lambda: [envs.step(actions) for _ in range(steps)])

    return turn


class Program:
    """The vector environment in C++, in processes of its own that go at the same time."""

    def __init__(self, path: str, engine: str, environments: int, policy_dt: float, processes: int = 1) -> None:
        """Start them."""
        command = [path, engine, str(environments), str(policy_dt), "1"]
        self._running = [
            subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
            for _ in range(processes)
        ]
        self._simulated_per_step = environments * processes * policy_dt

    def __call__(self, seconds: float) -> Turn:
        """A turn."""
        steps = max(1, round(seconds / self._simulated_per_step))
        for process in self._running:
            assert process.stdin
            process.stdin.write(f"{steps}\n")
            process.stdin.flush()
        times = [[float(t) for t in process.stdout.readline().split()] for process in self._running if process.stdout]
        cpu, wall = zip(*times, strict=True)
        return Turn(steps * self._simulated_per_step, sum(cpu), max(wall))


def engine_turns(engine: str) -> Contender:
    """Crossgait's engine alone, on the servo targets of a walk, from Python."""
    walked = crossgait.walk("trot", engine=engine, seconds=10, trace=True)
    frame = walked.trace.to_frame()
    targets = frame[[name for name in frame.columns if name.startswith("target.")]].to_numpy()
    world = crossgait.World(crossgait.Robot.load("scara_quadruped"), engine=engine)
    start = world.save()

    def turn(seconds: float) -> Turn:
        world.restore(start)
        rows = targets[: round(seconds / CONTROL_DT)]
        return timed(len(rows) * CONTROL_DT, lambda: [world.step(row, 2) for row in rows])

    return turn


def mujoco_turns(env: MujocoNumpyEnv) -> Contender:
    """The mujoco package alone, on the controls of the NumPy environment's walk."""
    import mujoco

    controls: list[np.ndarray] = []
    advance = env.advance

    def recording(targets: np.ndarray) -> None:
        controls.append(targets.copy())
        advance(targets)

    env.reset_engine()
    env.advance = recording  # type: ignore[method-assign]
    env.reset(seed=1)
    del controls[:]
    for _ in range(round(10 / CONTROL_DT)):
        env.step(np.zeros(16, np.float32))
    del env.advance
    env.reset(seed=1)
    state = (env.data.qpos.copy(), env.data.qvel.copy())

    def turn(seconds: float) -> Turn:
        env.data.qpos[:], env.data.qvel[:] = state
        rows = controls[: round(seconds / CONTROL_DT)]

        def work() -> None:
            for row in rows:
                env.data.ctrl[:] = row
                mujoco.mj_step(env.model, env.data, nstep=2)

        return timed(len(rows) * CONTROL_DT, work)

    return turn


def contenders(options: argparse.Namespace, policy_dt: float) -> dict[str, Contender]:
    """By name; what is compared to C++ stands next to it."""
    settings = {"config": {"engine": options.engine, "policy_dt": policy_dt, "episode_seconds": 1000}}
    found: dict[str, Contender] = {}
    for count in (4, 64):
        found[f"C++, {count}"] = Program(options.program, options.engine, count, policy_dt)
        envs = gymnasium.make_vec(ID, num_envs=count, workers=1, **settings)
        found[f"make_vec, {count}"] = gymnasium_turns(envs, policy_dt, count)
    found["C++, 2 processes of 32"] = Program(options.program, options.engine, 32, policy_dt, processes=2)
    two = gymnasium.make_vec(ID, num_envs=64, workers=2, **settings)
    found["make_vec, 64, 2 workers"] = gymnasium_turns(two, policy_dt, 64)
    found["gymnasium.make"] = gymnasium_turns(gymnasium.make(ID, **settings), policy_dt, 1)
    found["engine alone"] = engine_turns(options.engine)
    made = functools.partial(MujocoNumpyEnv, options.robot, policy_dt=policy_dt, episode_seconds=1000)
    found["mujoco + NumPy"] = gymnasium_turns(made(), policy_dt, 1)
    found["mujoco + NumPy, 2 processes"] = subprocess_turns(SubprocVecEnv([made, made]), policy_dt)
    found["mujoco package alone"] = mujoco_turns(MujocoNumpyEnv(options.robot))
    if importlib.util.find_spec("pybullet"):
        bullet = PybulletNumpyEnv(options.robot, policy_dt=policy_dt, episode_seconds=1000)
        found["PyBullet + NumPy"] = gymnasium_turns(bullet, policy_dt, 1)
    return found


# Ratios in one round: (what, to what, by which clock).
RATIOS = (
    ("make_vec, 4", "C++, 4", "cpu"),
    ("make_vec, 64", "C++, 64", "cpu"),
    ("make_vec, 64, 2 workers", "C++, 2 processes of 32", "wall"),
    ("make_vec, 64, 2 workers", "make_vec, 64", "wall"),
    ("make_vec, 64", "engine alone", "cpu"),
    ("gymnasium.make", "engine alone", "cpu"),
    ("mujoco + NumPy", "mujoco package alone", "cpu"),
    ("gymnasium.make", "mujoco + NumPy", "cpu"),
    ("make_vec, 64", "mujoco + NumPy", "cpu"),
    ("make_vec, 64, 2 workers", "mujoco + NumPy, 2 processes", "wall"),
    ("gymnasium.make", "PyBullet + NumPy", "cpu"),
    ("mujoco package alone", "engine alone", "cpu"),
)


def walked_speed(env: NumpyQuadrupedEnv) -> float:
    """Over five seconds, m/s: what is timed has to walk."""
    start, _ = env.reset(seed=1)
    for _ in range(250):
        end, *_ = env.step(np.zeros(16, np.float32))
    return float(end[0] - start[0]) / 5


def median_interval(values: np.ndarray) -> tuple[float, float]:
    """Order statistics about the median of what the values are drawn from: 95 %, the binomial by a normal."""
    ordered = np.sort(values)
    reach = 0.98 * np.sqrt(len(values))
    low = max(0, int(np.floor(len(values) / 2 - reach)))
    return float(ordered[low]), float(ordered[len(values) - 1 - low])


def measure(options: argparse.Namespace, policy_dt: float) -> dict[str, Any]:
    """Print and return: rates of all, and the ratios."""
    found = {name: turn for name, turn in contenders(options, policy_dt).items() if re.search(options.only, name)}
    turns: dict[str, list[Turn]] = {name: [] for name in found}
    for i in range(options.rounds + 1):
        for name, turn in list(found.items()) if i % 2 else reversed(found.items()):
            slow = "NumPy" in name
            turns[name].append(turn(options.seconds / 10 if slow else options.seconds))
        if sys.stderr.isatty():
            print(f"\r{policy_dt:g} s: round {i} of {options.rounds}", end="", file=sys.stderr, flush=True)
    rates = {  # the first round warms up
        clock: {name: np.array([t.simulated / getattr(t, clock) for t in rows[1:]]) for name, rows in turns.items()}
        for clock in ("cpu", "wall")
    }
    result: dict[str, Any] = {"rates": {}, "ratios": []}
    print(f"\nPolicy steps of {1e3 * policy_dt:g} ms: simulated s per core-second, per second; median (quartiles)")
    for name in found:
        row = {clock: np.percentile(rates[clock][name], (25, 50, 75)).tolist() for clock in rates}
        result["rates"][name] = row
        print(f"  {name:28}" + "".join(f" {b:8.2f} ({a:.2f} to {c:.2f})" for a, b, c in row.values()))
    for a, b, clock in RATIOS:
        if a in found and b in found:
            ratios = rates[clock][a] / rates[clock][b]
            low, middle, high = np.percentile(ratios, (25, 50, 75))
            median = median_interval(ratios)
            result["ratios"].append(
                {"of": a, "to": b, "clock": clock, "quartiles": [low, middle, high], "median_95": median}
            )
            within = f"({low:.3f} to {high:.3f}), median within {median[0]:.3f} to {median[1]:.3f}"
            print(f"  {a} / {b}, {clock}: {middle:.3f} {within}")
    return result


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=str(ROOT / "build/release/benchmarks/programs/vector_env_steps"))
    parser.add_argument("--robot", default=str(ROOT / "models/robots/scara_quadruped/robot.urdf"))
    parser.add_argument("--engine", default="mujoco")
    parser.add_argument("--policy-dt", type=float, action="append", help="s; .02 and .002 if none is given")
    parser.add_argument("--rounds", type=int, default=15)
    parser.add_argument("--seconds", type=float, default=10, help="simulated in a turn; a tenth of it by what is slow")
    parser.add_argument("--only", metavar="REGEX", default="", help="contenders whose names it is found in")
    parser.add_argument("--json", metavar="FILE", help="write the figures there")
    options = parser.parse_args()
    speeds = {"mujoco + NumPy": walked_speed(MujocoNumpyEnv(options.robot, policy_dt=0.02))}
    if importlib.util.find_spec("pybullet"):
        speeds["PyBullet + NumPy"] = walked_speed(PybulletNumpyEnv(options.robot, policy_dt=0.02))
    print("walked at, m/s:", ", ".join(f"{name} {speed:.3f}" for name, speed in speeds.items()))
    figures = {str(dt): measure(options, dt) for dt in options.policy_dt or (0.02, 0.002)}
    if options.json:
        Path(options.json).write_text(json.dumps({"walked": speeds, "policy_dt": figures}, indent=1) + "\n")


if __name__ == "__main__":
    main()
