"""The environment of `against_all.py` without Crossgait: what a user would write in NumPy around an engine.

48 observations, a reward, ends and beginnings, for one robot or many at once. Underneath: `mujoco.batch`, a loop over
`mj_step` of the `mujoco` package, or PyBullet.
"""

from __future__ import annotations

import tempfile
from abc import ABC, abstractmethod
from pathlib import Path
from typing import Any

import gymnasium
import mujoco
import numpy as np
from small_quadruped import (
    COMMAND,
    EFFORT,
    EPISODE,
    FRICTION,
    HEIGHT,
    HOME,
    JOINT_FRICTION,
    KD,
    KP,
    LEGS,
    PHYSICS_DT,
    SCALE,
    SERVOS,
    SUBSTEPS,
    urdf,
)

WEIGHTS = {"forward": 1.0, "turn": 0.5, "upright": -1.0, "change": -0.01, "height": -1.0}
Step = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]


class NumpyEnvs(ABC):
    """`count` environments; of all arrays a row each. `qpos` and `qvel` are as MuJoCo has them."""

    qpos: np.ndarray
    qvel: np.ndarray

    def __init__(self, count: int) -> None:
        """Begin all, at home."""
        self.command = np.tile(COMMAND, (count, 1))
        self.last = np.zeros((count, 12))
        self.steps = np.zeros(count, int)
        self.reset(np.arange(count))

    @abstractmethod
    def begin(self, which: np.ndarray) -> None:
        """Put the robots of `which` at home."""

    @abstractmethod
    def advance(self, targets: np.ndarray) -> None:
        """Servos go to `targets` for a policy step."""

    @abstractmethod
    def contacts(self) -> np.ndarray:
        """How many feet each has on the ground."""

    def reset(self, which: np.ndarray) -> None:
        """Begin episodes anew."""
        self.begin(which)
        self.last[which] = 0
        self.steps[which] = 0

    def step(self, action: np.ndarray) -> Step:
        """Make a policy step: observations, rewards, terminated, truncated."""
        self.advance(HOME + SCALE * action)
        w, x, y, z = self.qpos[:, 3:7].T
        gravity = np.stack([2 * (w * y - x * z), -2 * (y * z + w * x), 2 * (x * x + y * y) - 1], axis=1)
        velocity = to_base(self.qpos[:, 3:7], self.qvel[:, :3])
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


def to_base(quaternions: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """World to base."""
    w, u = quaternions[:, :1], -quaternions[:, 1:]
    cross = np.cross(u, vectors)
    return np.asarray(vectors + 2 * (w * cross + np.cross(u, cross)))


class BatchEnvs(NumpyEnvs):
    """Over `mujoco.batch`."""

    def __init__(self, model: mujoco.MjModel, count: int, threads: int) -> None:
        """Make the simulations."""
        from mujoco.batch import Batch

        self.batch = Batch(model, count, threads)
        self.qpos, self.qvel, self.ctrl = (self.batch.bind(name) for name in ("qpos", "qvel", "ctrl"))
        self.touching = self.batch.bind("ncon")
        super().__init__(count)

    def begin(self, which: np.ndarray) -> None:
        """As of the keyframe."""
        self.batch.reset(which, keyframe=0, stage=mujoco.mjtStage.mjSTAGE_NONE)

    def advance(self, targets: np.ndarray) -> None:
        """Step all."""
        self.ctrl[:] = targets
        self.batch.step(nstep=SUBSTEPS)

    def contacts(self) -> np.ndarray:
        """Only feet touch anything."""
        return np.asarray(self.touching).reshape(-1)


class MujocoEnvs(NumpyEnvs):
    """Over one `MjData`: the loop of everybody's script."""

    def __init__(self, model: mujoco.MjModel) -> None:
        """Make the simulation."""
        self.model, self.data = model, mujoco.MjData(model)
        self.qpos, self.qvel = self.data.qpos[None], self.data.qvel[None]
        super().__init__(1)

    def begin(self, which: np.ndarray) -> None:
        """As of the keyframe."""
        mujoco.mj_resetDataKeyframe(self.model, self.data, 0)

    def advance(self, targets: np.ndarray) -> None:
        """Step it."""
        self.data.ctrl[:] = targets[0]
        mujoco.mj_step(self.model, self.data, nstep=SUBSTEPS)

    def contacts(self) -> np.ndarray:
        """Only feet touch anything."""
        return np.array([self.data.ncon])


class BulletEnvs(NumpyEnvs):
    """Over PyBullet, whose own position control is no spring: servos are torques, told before each physics step."""

    def __init__(self) -> None:
        """Load the robot."""
        import pybullet

        self._p, self._client = pybullet, pybullet.connect(pybullet.DIRECT)
        p, client = pybullet, {"physicsClientId": self._client}
        p.setTimeStep(PHYSICS_DT, **client)
        p.setGravity(0, 0, -9.81, **client)
        plane = p.createMultiBody(0, p.createCollisionShape(p.GEOM_PLANE, **client), **client)
        p.changeDynamics(plane, -1, lateralFriction=1, **client)
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "robot.urdf"
            file.write_text(urdf())
            flags = p.URDF_USE_INERTIA_FROM_FILE
            self._robot = p.loadURDF(str(file), [0, 0, HEIGHT], flags=flags, **client)
        infos = [p.getJointInfo(self._robot, i, **client) for i in range(p.getNumJoints(self._robot, **client))]
        joints = {info[1].decode(): info[0] for info in infos}
        self._servos = [joints[name] for name in SERVOS]
        self._feet = {joints[f"{leg}_calf"] for leg in LEGS}
        for link in range(-1, len(infos)):
            p.changeDynamics(self._robot, link, lateralFriction=FRICTION, linearDamping=0, angularDamping=0, **client)
        idle = [JOINT_FRICTION] * len(SERVOS)  # its motors hold against dry friction alone
        p.setJointMotorControlArray(self._robot, self._servos, p.VELOCITY_CONTROL, forces=idle, **client)
        self.qpos, self.qvel = np.zeros((1, 19)), np.zeros((1, 18))
        super().__init__(1)

    def close(self) -> None:
        """Free the engine."""
        self._p.disconnect(self._client)

    def begin(self, which: np.ndarray) -> None:
        """Put it at home."""
        p, client = self._p, {"physicsClientId": self._client}
        p.resetBasePositionAndOrientation(self._robot, [0, 0, HEIGHT], [0, 0, 0, 1], **client)
        p.resetBaseVelocity(self._robot, [0, 0, 0], [0, 0, 0], **client)
        for joint, angle in zip(self._servos, HOME, strict=True):
            p.resetJointState(self._robot, joint, angle, **client)
        self._read()

    def advance(self, targets: np.ndarray) -> None:
        """Step it."""
        p, client = self._p, {"physicsClientId": self._client}
        for _ in range(SUBSTEPS):
            joints = p.getJointStates(self._robot, self._servos, **client)
            angles, rates = np.array([joint[0] for joint in joints]), np.array([joint[1] for joint in joints])
            torques = np.clip(KP * (targets[0] - angles) - KD * rates, -EFFORT, EFFORT)
            p.setJointMotorControlArray(self._robot, self._servos, p.TORQUE_CONTROL, forces=torques, **client)
            p.stepSimulation(**client)
        self._read()

    def _read(self) -> None:
        p, client = self._p, {"physicsClientId": self._client}
        position, (x, y, z, w) = p.getBasePositionAndOrientation(self._robot, **client)
        velocity, rate = p.getBaseVelocity(self._robot, **client)
        joints = p.getJointStates(self._robot, self._servos, **client)
        self.qpos[0, :3], self.qpos[0, 3:7] = position, (w, x, y, z)
        self.qpos[0, 7:] = [joint[0] for joint in joints]
        self.qvel[0, :3], self.qvel[0, 6:] = velocity, [joint[1] for joint in joints]
        self.qvel[0, 3:6] = to_base(self.qpos[:, 3:7], np.array([rate]))[0]

    def contacts(self) -> np.ndarray:
        """Links that touch are shins by their feet."""
        touching = {contact[3] for contact in self._p.getContactPoints(self._robot, physicsClientId=self._client)}
        return np.array([len(touching & self._feet)])


class MujocoGymEnv(gymnasium.Env[np.ndarray, np.ndarray]):
    """One of `MujocoEnvs`, for vectors of processes."""

    def __init__(self, mjcf: str) -> None:
        """Make it."""
        self.envs = MujocoEnvs(mujoco.MjModel.from_xml_string(mjcf))
        self.action_space = gymnasium.spaces.Box(-1, 1, (12,), np.float32)
        self.observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (48,), np.float64)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[np.ndarray, dict]:
        """Begin an episode: `step` has done so already where one has ended."""
        super().reset(seed=seed)
        return np.zeros(48), {}

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict]:
        """Make a policy step."""
        seen, reward, terminated, truncated = self.envs.step(action[None])
        return seen[0], float(reward[0]), bool(terminated[0]), bool(truncated[0]), {}
