"""Whole environments beside `mujoco.batch`: the same robot, contacts, solver and servos on both sides.

    python python/benchmarks/against_batch.py [--engine mujoco@4.0.0] [--rounds 15] [--json FILE]

A robot of a Go2's size, written below as MJCF, is read by both. Each steps it with the same targets, 2 ms a physics
step and ten of them a policy step; both sides make 48 observations, a reward and ended episodes begin anew. Fails if
the two sides' robots do not move alike or touch the ground as often. Prints physics steps per core-second, medians
(quartiles) over rounds that take all in turns, and ratios within a round.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from against_others import median_interval
from mujoco.batch import Batch

from crossgait.envs import JointControlEnv, JointControlVectorEnv

PHYSICS_DT, SUBSTEPS, EPISODE = 0.002, 10, 400  # s; physics steps in a policy step; policy steps
KP, KD, EFFORT, SCALE = 25.0, 0.5, 23.7, 0.25
HOME = np.tile([0.0, 0.8, -1.5], 4)
HEIGHT = 0.32  # m, of the base at the start
LEGS = ("FL", "FR", "RL", "RR")
WEIGHTS = {"forward": 1.0, "turn": 0.5, "upright": -1.0, "change": -0.01, "height": -1.0}


def leg(name: str) -> str:
    """A leg as MJCF: hip, thigh, calf, and a sphere that touches."""
    front, left = (1 if name[0] == "F" else -1), (1 if name[1] == "L" else -1)

    def joint(what: str, axis: str, low: float, high: float) -> str:
        return f'<joint name="{name}_{what}" axis="{axis}" range="{low} {high}"/>'

    return f"""
    <body name="{name}_hip" pos="{front * 0.1934} {left * 0.0465} 0">
      {joint("hip", "1 0 0", -1.05, 1.05)}
      <inertial pos="0 0 0" mass="0.68" diaginertia="0.0005 0.0009 0.0006"/>
      <body name="{name}_thigh" pos="0 {left * 0.0955} 0">
        {joint("thigh", "0 1 0", -1.5, 3.4)}
        <inertial pos="0 {left * -0.02} -0.03" mass="1.15" diaginertia="0.006 0.0056 0.0012"/>
        <body name="{name}_calf" pos="0 0 -0.213">
          {joint("calf", "0 1 0", -2.72, -0.84)}
          <inertial pos="0.005 0 -0.14" mass="0.24" diaginertia="0.0030 0.0030 0.00004"/>
          <geom name="{name}" type="sphere" size="0.022" pos="0 0 -0.213" class="foot"/>
        </body>
      </body>
    </body>"""


def model_text() -> str:
    """The robot and the ground as MJCF."""
    servos = "".join(
        f'<position joint="{name}_{joint}" kp="{KP}" kv="{KD}" forcerange="{-EFFORT} {EFFORT}"/>'
        for name in LEGS
        for joint in ("hip", "thigh", "calf")
    )
    return f"""<mujoco model="batch_quadruped">
  <compiler angle="radian"/>
  <option timestep="{PHYSICS_DT}" cone="elliptic" solver="Newton" integrator="Euler" impratio="10" jacobian="dense"
   tolerance="1e-16"/>
  <default>
    <joint armature="0.01" frictionloss="0.2" solreffriction="0.005 1" solimpfriction="0.95 0.99 0.001 0.5 2"/>
    <default class="foot">
      <geom contype="1" conaffinity="0" condim="3" friction="0.8 0 0" solref="0.02 1" solimp="0.9 0.95 0.001 0.5 2"/>
    </default>
  </default>
  <worldbody>
    <geom name="floor" type="plane" size="0 0 1" contype="0" conaffinity="1" condim="3" friction="0.8 0 0"
     solref="0.02 1" solimp="0.9 0.95 0.001 0.5 2"/>
    <body name="trunk" pos="0 0 {HEIGHT}">
      <freejoint/>
      <inertial pos="0 0 0" mass="6.9" diaginertia="0.025 0.098 0.107"/>
      {"".join(leg(name) for name in LEGS)}
    </body>
  </worldbody>
  <actuator>{servos}</actuator>
  <keyframe><key name="home" qpos="0 0 {HEIGHT} 1 0 0 0 {" ".join(map(str, HOME))}"/></keyframe>
</mujoco>
"""


def actions_of(count: int, steps: int = EPISODE) -> np.ndarray:
    """Targets that lift feet in pairs, each environment at its own time: steps x environments x 12, in [-1, 1]."""
    time_of = np.arange(steps)[:, None] * PHYSICS_DT * SUBSTEPS
    phase = 2 * np.pi * (2 * time_of + np.linspace(0, 1, count, endpoint=False)[None])
    lift = np.stack([np.maximum(0, np.sin(phase + offset)) for offset in (0, np.pi, np.pi, 0)], axis=-1)
    actions = np.zeros((steps, count, 12))
    actions[..., 1::3], actions[..., 2::3] = 0.8 * lift, -1.6 * lift
    return np.clip(actions, -1, 1)


class BatchEnvs:
    """What a user writes around `mujoco.batch`: observations, reward, ends and beginnings in NumPy."""

    def __init__(self, model: mujoco.MjModel, count: int, threads: int) -> None:
        """Make the environments, at home."""
        self.batch = Batch(model, count, threads)
        self.qpos, self.qvel, self.ctrl = (self.batch.bind(name) for name in ("qpos", "qvel", "ctrl"))
        self.command = np.tile([0.5, 0.0, 0.0], (count, 1))
        self.last = np.zeros((count, 12))
        self.steps = np.zeros(count, int)
        self.reset(np.arange(count))

    def reset(self, which: np.ndarray) -> None:
        """Begin episodes anew."""
        self.batch.reset(which, keyframe=0, stage=mujoco.mjtStage.mjSTAGE_NONE)
        self.last[which] = 0
        self.steps[which] = 0

    def local(self, vectors: np.ndarray) -> np.ndarray:
        """World to base, by the base's quaternion."""
        w, u = self.qpos[:, 3:4], -self.qpos[:, 4:7]
        cross = np.cross(u, vectors)
        return vectors + 2 * (w * cross + np.cross(u, cross))

    def step(self, action: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Make a policy step."""
        self.ctrl[:] = HOME + SCALE * action
        self.batch.step(nstep=SUBSTEPS)
        velocity, gravity = self.local(self.qvel[:, :3]), self.local(np.tile([0.0, 0.0, -1.0], (len(action), 1)))
        rate = self.qvel[:, 3:6]
        seen = [velocity, rate, gravity, self.qpos[:, 7:] - HOME, self.qvel[:, 6:], action, self.command]
        observation = np.concatenate(seen, axis=1)
        reward = (
            WEIGHTS["forward"] * np.exp(-4 * ((velocity[:, :2] - self.command[:, :2]) ** 2).sum(1))
            + WEIGHTS["turn"] * np.exp(-4 * (rate[:, 2] - self.command[:, 2]) ** 2)
            + WEIGHTS["upright"] * (gravity[:, :2] ** 2).sum(1)
            + WEIGHTS["change"] * ((action - self.last) ** 2).sum(1)
            + WEIGHTS["height"] * (self.qpos[:, 2] - 0.3) ** 2
        )
        self.last = action
        self.steps += 1
        terminated = (gravity[:, 2] > -0.5) | (self.qpos[:, 2] < 0.1)
        truncated = self.steps >= EPISODE
        if (ended := np.flatnonzero(terminated | truncated)).size:
            self.reset(ended)
        return observation, reward, terminated, truncated


def crossgait_config(robot: Path, engine: str) -> dict[str, Any]:
    """The same in Crossgait's words."""
    return {
        "robot": str(robot),
        "engine": engine,
        "physics_dt": PHYSICS_DT,
        "control_dt": PHYSICS_DT,
        "policy_dt": PHYSICS_DT * SUBSTEPS,
        "episode_seconds": EPISODE * PHYSICS_DT * SUBSTEPS,
        "settle_seconds": 0.0,
        "joints": {"scale": SCALE, "limit": 1},
        "command": {"vx": 0.5},
        "observation": [
            *("base_linear_velocity_local", "base_angular_velocity_local", "gravity", "joint_offsets"),
            *("joint_velocities", "last_action", "command"),
        ],
        "reward": {
            **{"velocity_tracking": 1, "yaw_rate_tracking": 0.5, "flat_orientation_l2": -1},
            **{"action_rate_l2": -0.01},
        },
    }


Step = Callable[[np.ndarray], object]


def alike(model: mujoco.MjModel, config: dict[str, Any]) -> dict[str, float]:
    """How far apart both sides' robots are after half a second from one state, m and rad, and contacts of each."""
    count, steps = 8, 25
    ours, theirs = JointControlVectorEnv(count, config, workers=1), BatchEnvs(model, count, 1)
    ours.reset(seed=1)
    for i in range(count):
        ours.batch.set_state(qpos=theirs.qpos[i], qvel=np.zeros(model.nv), indices=[i])
    touching = theirs.batch.bind("ncon")
    mine, others, apart = 0.0, 0.0, 0.0
    for action in actions_of(count, steps):
        ours.step(action)
        theirs.step(action)
        apart = max(apart, float(np.abs(ours.batch.qpos - theirs.qpos).max()))
        mine += float(ours.batch.foot_contacts.sum(1).mean()) / steps
        others += float(touching.mean()) / steps
    return {"apart": apart, "contacts": mine, "contacts_batch": others}


def contenders(model: mujoco.MjModel, config: dict[str, Any]) -> dict[str, tuple[int, Step]]:
    """By name: environments, and what makes a policy step in each of them."""
    found: dict[str, tuple[int, Step]] = {}
    for count, threads in ((1, 1), (64, 1), (64, 2)):
        name = f"{count}, {threads} thread{'s' if threads > 1 else ''}"
        batch = BatchEnvs(model, count, threads)
        found[f"batch + NumPy, {name}"] = (count, batch.step)
        physics = BatchEnvs(model, count, threads)

        def advance(action: np.ndarray, envs: BatchEnvs = physics) -> None:
            envs.ctrl[:] = HOME + SCALE * action
            envs.batch.step(nstep=SUBSTEPS)

        found[f"batch, physics alone, {name}"] = (count, advance)
        vector = JointControlVectorEnv(count, config, workers=threads)
        vector.reset(seed=1)
        found[f"Crossgait, {name}"] = (count, vector.step)
    single = JointControlEnv(config)
    single.reset(seed=1)

    def one(action: np.ndarray) -> None:
        _, _, terminated, truncated, _ = single.step(action[0])
        if terminated or truncated:
            single.reset()

    found["Crossgait, single environment"] = (1, one)
    return found


RATIOS = (
    ("Crossgait, single environment", "batch + NumPy, 1, 1 thread"),
    ("Crossgait, 1, 1 thread", "batch + NumPy, 1, 1 thread"),
    ("Crossgait, 64, 1 thread", "batch + NumPy, 64, 1 thread"),
    ("Crossgait, 64, 2 threads", "batch + NumPy, 64, 2 threads"),
    ("Crossgait, 64, 1 thread", "batch, physics alone, 64, 1 thread"),
    ("Crossgait, 64, 1 thread", "Crossgait, 1, 1 thread"),
    ("batch + NumPy, 64, 1 thread", "batch + NumPy, 1, 1 thread"),
)


def measure(options: argparse.Namespace, found: dict[str, tuple[int, Step]]) -> dict[str, Any]:
    """Print and return: physics steps per core-second of all, and ratios."""
    rates: dict[str, list[float]] = {name: [] for name in found}
    actions = {count: actions_of(count) for count, _ in found.values()}
    for i in range(options.rounds + 1):
        for name, (count, step) in list(found.items()) if i % 2 else reversed(found.items()):
            steps = max(1, round(options.steps / count))
            begin = time.process_time()
            for k in range(steps):
                step(actions[count][(i * steps + k) % EPISODE])
            rates[name].append(steps * count * SUBSTEPS / (time.process_time() - begin))
        if sys.stderr.isatty():
            print(f"\rround {i} of {options.rounds}", end="", file=sys.stderr, flush=True)
    made = {name: np.array(values[1:]) for name, values in rates.items()}  # the first round warms up
    result: dict[str, Any] = {"steps_per_core_second": {}, "ratios": []}
    for name, values in made.items():
        low, middle, high = result["steps_per_core_second"][name] = np.percentile(values, (25, 50, 75)).tolist()
        print(f"  {name:34} {middle:8.0f} ({low:.0f} to {high:.0f})")
    for a, b in RATIOS:
        ratios = made[a] / made[b]
        low, middle, high = np.percentile(ratios, (25, 50, 75))
        within = median_interval(ratios)
        result["ratios"].append({"of": a, "to": b, "quartiles": [low, middle, high], "median_95": within})
        print(f"  {a} / {b}: {middle:.3f} ({low:.3f} to {high:.3f}), median within {within[0]:.3f} to {within[1]:.3f}")
    return result


def main() -> int:
    """Check that both sides do the same, and measure."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--engine", default="mujoco@4.0.0")
    parser.add_argument("--rounds", type=int, default=15)
    parser.add_argument("--steps", type=int, default=1600, help="policy steps of a turn, of all environments together")
    parser.add_argument("--least", type=float, default=0, help="fail where the ratio with 64 environments is below")
    parser.add_argument("--json", metavar="FILE", help="write the figures there")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        robot = Path(folder) / "robot.xml"
        robot.write_text(model_text())
        model = mujoco.MjModel.from_xml_path(str(robot))
        config = crossgait_config(robot, options.engine)
        same = alike(model, config)
        print(
            f"{options.engine} and mujoco.batch {mujoco.__version__}: {same['apart']:.1g} apart after half a second, "
            f"{same['contacts']:.2f} and {same['contacts_batch']:.2f} contacts"
        )
        # Of a foot that touches without a force only mujoco.batch tells.
        if same["apart"] > 1e-9 or abs(same["contacts"] - same["contacts_batch"]) > 0.2:
            print("FAILED: not the same work")
            return 1
        figures = same | measure(options, contenders(model, config))
    if options.json:
        Path(options.json).write_text(json.dumps(figures, indent=1) + "\n")
    slow = [row["of"] for row in figures["ratios"] if "NumPy" in row["to"] and row["quartiles"][1] < options.least]
    if slow:
        print(f"FAILED: below {options.least} of mujoco.batch: {', '.join(slow)}")
    return 1 if slow else 0


if __name__ == "__main__":
    sys.exit(main())
