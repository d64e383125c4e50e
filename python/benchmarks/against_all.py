"""Whole environments of Crossgait beside what a user would write instead: one robot, one motion, all in one run.

    python python/benchmarks/against_all.py [--engine mujoco@4.0.0] [--rounds 30] [--only REGEX] [--json FILE]

`small_quadruped.py` has the robot, which both sides read from one MJCF (PyBullet from the same numbers as URDF), and
the targets that all servos follow, 2 ms a physics step and ten of them a policy step. `numpy_envs.py` has 48
observations, a reward, ends and beginnings in NumPy around `mujoco.batch`, a loop over `mj_step`, and PyBullet. Fails
if MuJoCo's robots do not move alike on both sides, or any touches the ground less or more often.

All take turns, every second round the other way round so that a machine that gets slower favours nobody. Printed is a
Markdown table: physics steps per core-second, medians (quartiles) over rounds, and what Crossgait's environments of as
many and as many threads make over it in the same round, the median (the interval that holds it with 95 %). Core-seconds
are CPU time of all processes of a contender; against processes of Stable-Baselines3 the time on the wall decides.
Without `pybullet` its line is missing; the C++ program is build/release's.
"""

from __future__ import annotations

import argparse
import functools
import importlib.util
import json
import os
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import psutil
from numpy_envs import BatchEnvs, BulletEnvs, MujocoEnvs, MujocoGymEnv, NumpyEnvs
from small_quadruped import EPISODE, HOME, SCALE, SUBSTEPS, actions_of, crossgait_config, mjcf
from stable_baselines3.common.vec_env import SubprocVecEnv

from crossgait import EnvironmentConfig
from crossgait.envs import JointControlEnv, JointControlVectorEnv

PROGRAM = Path(__file__).parents[2] / "build/release/benchmarks/programs/vector_env_steps"
SHAPES = {"one environment": (1, 1), "64, one thread": (64, 1), "64, two threads": (64, 2)}
OURS, SINGLE = "Crossgait, vector environment", "Crossgait, single environment"
BATCH = "`mujoco.batch` and NumPy"
ALONE = 25  #: policy steps of the comparison of motions


@dataclass(frozen=True)
class Turn:
    """What a turn took."""

    physics_steps: int
    cpu: float  # s
    wall: float


@dataclass(frozen=True)
class Contender:
    """Who steps environments."""

    name: str
    shape: str  #: of `SHAPES`, which it is compared in
    count: int  #: of environments
    run: Callable[[int, int], tuple[float, float]]  #: first row of actions, policy steps: s of CPU and on the wall
    clock: str = "cpu"
    pace: float = 1.0  #: of the steps that others make in a turn

    def turn(self, index: int, steps: int) -> Turn:
        """Make the steps of a round, all environments together about `steps`."""
        own = max(1, round(steps * self.pace / self.count))
        return Turn(own * self.count * SUBSTEPS, *self.run(index * own, own))


def children_seconds() -> float:
    """CPU time of this process' children, which psutil tells in 10 ms, s. To ask takes milliseconds itself."""
    times = [p.cpu_times() for p in psutil.Process().children(recursive=True)]
    return sum(t.user + t.system for t in times)


def stepped(step: Callable[[np.ndarray], object], count: int, processes: bool = False) -> Callable[..., Any]:
    """Of what steps here, or in processes that this one has started."""
    actions = actions_of(count)

    def run(first: int, steps: int) -> tuple[float, float]:
        children = children_seconds() if processes else 0.0
        cpu, wall = time.process_time(), time.perf_counter()
        for i in range(first, first + steps):
            step(actions[i % EPISODE])
        cpu, wall = time.process_time() - cpu, time.perf_counter() - wall
        return cpu + (children_seconds() - children if processes else 0.0), wall

    return run


class Program:
    """The vector environment in C++, in a process of its own."""

    def __init__(self, config: Path, count: int, threads: int) -> None:
        """Start it."""
        actions = config.parent / f"actions-{count}.f64"
        actions_of(count).tofile(actions)
        command = [str(PROGRAM), str(config), str(count), str(threads), str(actions)]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def __call__(self, first: int, steps: int) -> tuple[float, float]:
        """Make steps."""
        assert self._process.stdin
        assert self._process.stdout
        self._process.stdin.write(f"{first} {steps}\n")
        self._process.stdin.flush()
        cpu, wall = map(float, self._process.stdout.readline().split())
        return cpu, wall


def alone(envs: BatchEnvs | MujocoEnvs) -> Callable[[np.ndarray], object]:
    """The physics without the NumPy around it."""
    return lambda action: envs.advance(HOME + SCALE * action)


def contenders(model: mujoco.MjModel, config: dict[str, Any], folder: Path) -> list[Contender]:
    """All of them, those of one shape together."""
    found: list[Contender] = []
    for shape, (count, threads) in SHAPES.items():
        vector = JointControlVectorEnv(count, config, workers=threads)
        vector.reset(seed=1)
        batch, physics = BatchEnvs(model, count, threads), BatchEnvs(model, count, threads)
        found += [
            Contender(OURS, shape, count, stepped(vector.step, count)),
            Contender("Crossgait, `VectorEnv` in C++", shape, count, Program(folder / "config.yaml", count, threads)),
            Contender(BATCH, shape, count, stepped(batch.step, count)),
            Contender("`mujoco.batch`, physics alone", shape, count, stepped(alone(physics), count)),
        ]
    one, single = "one environment", JointControlEnv(config)
    single.reset(seed=1)

    def step(action: np.ndarray) -> None:
        _, _, terminated, truncated, _ = single.step(action[0])
        if terminated or truncated:
            single.reset()

    found += [
        Contender(SINGLE, one, 1, stepped(step, 1)),
        Contender("`mj_step` in a loop, and NumPy", one, 1, stepped(MujocoEnvs(model).step, 1)),
        Contender("`mj_step` in a loop, physics alone", one, 1, stepped(alone(MujocoEnvs(model)), 1)),
    ]
    if importlib.util.find_spec("pybullet"):
        found.append(Contender("PyBullet and NumPy", one, 1, stepped(BulletEnvs().step, 1), pace=0.25))
    envs = SubprocVecEnv([functools.partial(MujocoGymEnv, mjcf())] * 2)
    envs.reset()
    run = stepped(envs.step, 2, processes=True)
    found.append(Contender("`SubprocVecEnv` of two such loops", "64, two threads", 2, run, clock="wall"))
    return found


def alike(model: mujoco.MjModel, config: dict[str, Any]) -> dict[str, dict[str, float]]:
    """After half a second from one state: how far each is from `mujoco.batch`, m and rad, and its contacts."""
    count = 8
    ours, theirs = JointControlVectorEnv(count, config, workers=1), BatchEnvs(model, count, 1)
    others: dict[str, NumpyEnvs] = {"mj_step": MujocoEnvs(model)}
    if importlib.util.find_spec("pybullet"):
        others["PyBullet"] = BulletEnvs()
    ours.reset(seed=1)
    for i in range(count):
        ours.batch.set_state(qpos=theirs.qpos[i], qvel=np.zeros(model.nv), indices=[i])
    names = ("mujoco.batch", "Crossgait", *others)
    said = {name: {"apart": 0.0, "contacts": 0.0} for name in names}
    for action in actions_of(count, ALONE):
        ours.step(action)
        theirs.step(action)
        said["mujoco.batch"]["contacts"] += float(theirs.contacts().mean()) / ALONE
        said["Crossgait"]["contacts"] += float(ours.batch.foot_contacts.sum(1).mean()) / ALONE
        said["Crossgait"]["apart"] = max(said["Crossgait"]["apart"], float(np.abs(ours.batch.qpos - theirs.qpos).max()))
        for name, other in others.items():  # the first of the eight
            other.step(action[:1])
            said[name]["contacts"] += float(other.contacts()[0]) / ALONE
            said[name]["apart"] = max(said[name]["apart"], float(np.abs(other.qpos - theirs.qpos[:1]).max()))
    return said


def what_differs(said: dict[str, dict[str, float]]) -> list[str]:
    """Who does not do the same work."""
    touched = said["mujoco.batch"]["contacts"]
    wrong = [
        # Of a foot that touches without a force only MuJoCo tells; another engine's contacts come and go otherwise.
        name
        for name, of in said.items()
        if abs(of["contacts"] - touched) > (0.2 if name != "PyBullet" else 0.5)
    ]
    # Rounding: the same engine in the same order, but for what Crossgait writes down in other units.
    return wrong + [name for name in ("Crossgait", "mj_step") if said[name]["apart"] > 1e-9]


def median_interval(values: np.ndarray) -> tuple[float, float]:
    """Order statistics about the median of what the values are drawn from: 95 %, the binomial by a normal."""
    ordered = np.sort(values)
    reach = 0.98 * np.sqrt(len(values))
    low = max(0, int(np.floor(len(values) / 2 - reach)))
    return float(ordered[low]), float(ordered[len(values) - 1 - low])


def measure(options: argparse.Namespace, found: list[Contender]) -> list[dict[str, Any]]:
    """A row for each contender: rates, and ratios of Crossgait's to its own."""
    turns: dict[tuple[str, str], list[Turn]] = {(c.name, c.shape): [] for c in found}
    for i in range(options.rounds + 1):
        for c in found if i % 2 else reversed(found):
            turns[c.name, c.shape].append(c.turn(i, options.steps))
        if sys.stderr.isatty():
            print(f"\rround {i} of {options.rounds}", end="", file=sys.stderr, flush=True)
    rates = {  # the first round warms up
        clock: {key: np.array([t.physics_steps / getattr(t, clock) for t in of[1:]]) for key, of in turns.items()}
        for clock in ("cpu", "wall")
    }
    rows = []
    for c in found:
        row: dict[str, Any] = {"name": c.name, "shape": c.shape, "clock": c.clock, "ratios": {}}
        row["rate"] = np.percentile(rates["cpu"][c.name, c.shape], (25, 50, 75)).tolist()
        row["on_the_wall"] = np.percentile(rates["wall"][c.name, c.shape], (25, 50, 75)).tolist()
        for ours in (OURS, SINGLE):
            if (ours, c.shape) in turns and ours != c.name:
                ratios = rates[c.clock][ours, c.shape] / rates[c.clock][c.name, c.shape]
                quartiles, interval = np.percentile(ratios, (25, 50, 75)).tolist(), median_interval(ratios)
                row["ratios"][ours] = {"quartiles": quartiles, "median_95": interval}
        rows.append(row)
    return rows


def table(rows: list[dict[str, Any]]) -> str:
    """As docs/python-speed.md has it."""
    lines = [
        "| | | physics steps per core-second | vector environment over it | single over it |",
        "|---|---|---|---|---|",
    ]
    for shape in dict.fromkeys(row["shape"] for row in rows):
        title = shape
        for row in (row for row in rows if row["shape"] == shape):
            low, middle, high = (f"{rate:,.0f}" for rate in row["rate"])
            cells = [title, row["name"], f"{middle} ({low} to {high})"]
            for ours in (OURS, SINGLE):
                of = row["ratios"].get(ours)
                least, most = of["median_95"] if of else (0.0, 0.0)
                wall = ", on the wall" if row["clock"] == "wall" else ""
                cells.append(f"{of['quartiles'][1]:.2f} ({least:.2f} to {most:.2f}){wall}" if of else "")
            lines.append(f"| {' | '.join(cells)} |")
            title = ""
    return "\n".join(lines)


def arguments() -> argparse.Namespace:
    """Of the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--engine", default="mujoco@4.0.0")
    parser.add_argument("--rounds", type=int, default=30)
    parser.add_argument("--steps", type=int, default=1600, help="policy steps of a turn, of all environments together")
    parser.add_argument("--only", metavar="REGEX", default="", help="contenders whose names it is found in, and ours")
    parser.add_argument(
        "--least", type=float, default=0, help="fail where the ratio to mujoco.batch with NumPy is below"
    )
    parser.add_argument("--json", metavar="FILE", help="write the figures there")
    return parser.parse_args()


def main() -> int:
    """Check that all do the same, and measure."""
    options = arguments()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        robot = folder / "robot.xml"
        robot.write_text(mjcf())
        model = mujoco.MjModel.from_xml_path(str(robot))
        config = crossgait_config(robot, options.engine)
        (folder / "config.yaml").write_text(EnvironmentConfig.from_dict(config).to_yaml())
        same = alike(model, config)
        for who, of in same.items():
            print(f"{who}: {of['apart']:.1g} apart after half a second, {of['contacts']:.2f} contacts")
        if wrong := what_differs(same):
            print(f"FAILED: not the same work: {', '.join(wrong)}")
            return 1
        everyone = contenders(model, config, folder)
        chosen = [c for c in everyone if c.name in (OURS, SINGLE) or re.search(options.only, c.name)]
        load = os.getloadavg()
        rows = measure(options, chosen)
    said = f"{options.engine}, mujoco {mujoco.__version__}, {options.rounds} rounds of {options.steps} policy steps"
    print(f"{said}, load {load[0]:.1f} at the beginning and {os.getloadavg()[0]:.1f} at the end\n{table(rows)}")
    if options.json:
        told = {"engine": options.engine, "mujoco": mujoco.__version__, "load": load, "same": same, "rows": rows}
        Path(options.json).write_text(json.dumps(told, indent=1) + "\n")
    slow = [r["shape"] for r in rows if r["name"] == BATCH and r["ratios"][OURS]["quartiles"][1] < options.least]
    if slow:
        print(f"FAILED: below {options.least} of mujoco.batch with NumPy: {', '.join(slow)}")
    return 1 if slow else 0


if __name__ == "__main__":
    sys.exit(main())
