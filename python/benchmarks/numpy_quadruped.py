"""The bundled quadruped in Gymnasium without Crossgait: what a user would write with NumPy over `mujoco` or PyBullet.

The same robot file, the trot of the same parameters, inverse kinematics, 16 actions, 69 observations and six reward
terms; nothing of the crossgait package runs. What Crossgait's environment does beyond it is left out: servo
compensation, heading hold, the growing first stride, infos. The benchmark `against_others.py` times both.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np

LEGS = ("FL", "FR", "RL", "RR")
SERVOS = tuple(f"{leg}_{joint}" for leg in LEGS for joint in ("tilt", "shoulder_left", "shoulder_right"))
SIDE = np.array([1.0, -1.0, 1.0, -1.0])
OFFSET = np.array([0.0, 0.5, 0.5, 0.0])  # phases of a trot
UPPER, LOWER, SHOULDER_X, AXIS_OUT, AXIS_DOWN = 0.045, 0.060, 0.010, 0.024, 0.010  # m
HOME = np.tile([0.0, 0.8606149458496, -0.8606149458496], 4)
HOME_ELBOWS = {"elbow_left": -1.6867970467349, "elbow_right": 1.6867970467349}
KP, ARMATURE, TORQUE, FRICTION, START_HEIGHT = 1.0, 2e-4, 1.0, 0.6, 0.0685
PHYSICS_DT, CONTROL_DT = 0.001, 0.002
# Step height, step length, cycle time, body height: where the trot begins, its range, how far one step changes it.
PARAMETERS = np.array([0.04, 0.04, 0.24, 0.062])
LOW, HIGH = np.array([0.01, 0.0, 0.15, 0.04]), np.array([0.05, 0.08, 0.8, 0.08])
DELTA = np.array([0.005, 0.005, 0.05, 0.003])
DUTY, SWING_SHAPE, RESIDUAL = 0.6, 0.3, 0.01


@dataclass
class State:
    """What an engine says."""

    position: np.ndarray
    quaternion: np.ndarray  # w, x, y, z
    velocity: np.ndarray
    rate: np.ndarray
    q: np.ndarray  # of the servos
    qd: np.ndarray
    feet: np.ndarray  # 4 x 3
    feet_velocity: np.ndarray
    contacts: np.ndarray


def trot(parameters: np.ndarray, phase: float, residuals: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Feet (4 x 3, in the legs' frames) and which of them swing."""
    height, length, _, body = parameters
    phases = (phase + OFFSET) % 1
    swing = phases >= DUTY
    u = np.where(swing, (phases - DUTY) / (1 - DUTY), phases / DUTY)
    hump = u * (1 - u)
    along = np.where(swing, (2 * u - 1) * (1 + (3 * SWING_SHAPE - 1) * hump), 1 - 2 * u)
    feet = np.zeros((4, 3))
    feet[:, 0] = along * length / 2
    feet[:, 2] = np.where(swing, 3 * hump * height, 0) - body
    return feet + residuals, swing


def inverse_kinematics(feet: np.ndarray) -> np.ndarray:
    """Servo angles (12) of these feet: a five-bar on a tilt joint, its knees outward."""
    out, down = SIDE * feet[:, 1] + AXIS_OUT, AXIS_DOWN - feet[:, 2]
    depth = np.sqrt(np.maximum(out**2 + down**2 - AXIS_OUT**2, 1e-8))
    tilt = SIDE * (np.arctan2(out, down) - np.arctan2(AXIS_OUT, depth))
    z = depth - AXIS_DOWN
    angles = np.empty((4, 3))
    angles[:, 0] = tilt
    for column, (shoulder, knee) in enumerate(((-SHOULDER_X, 1), (SHOULDER_X, -1)), start=1):
        x = feet[:, 0] - shoulder
        reach = np.clip(np.hypot(x, z), LOWER - UPPER + 1e-6, LOWER + UPPER - 1e-6)
        bend = np.arccos((UPPER**2 + reach**2 - LOWER**2) / (2 * UPPER * reach))
        angles[:, column] = knee * bend - np.arctan2(x, z)
    return np.clip(angles, (-1, -2.6, -2.6), (1, 2.6, 2.6)).ravel()


def roll_pitch_yaw(q: np.ndarray) -> np.ndarray:
    """Of a quaternion, degrees."""
    w, x, y, z = q
    return np.degrees(
        [
            np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)),
            np.arcsin(np.clip(2 * (w * y - z * x), -1, 1)),
            np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)),
        ]
    )


class NumpyQuadrupedEnv(gymnasium.Env[np.ndarray, np.ndarray], ABC):
    """A trot whose parameters and feet the action changes."""

    def __init__(self, policy_dt: float = CONTROL_DT, episode_seconds: float = 20) -> None:
        """Begin standing. `policy_dt` is a multiple of 2 ms."""
        self.action_space = gymnasium.spaces.Box(-1, 1, (16,), np.float32)
        self.observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (69,), np.float64)
        self._control_steps = round(policy_dt / CONTROL_DT)
        self._limit = round(episode_seconds / policy_dt)

    @abstractmethod
    def reset_engine(self) -> None:
        """Stand in the home posture."""

    @abstractmethod
    def advance(self, targets: np.ndarray) -> None:
        """Servos go to `targets` for CONTROL_DT."""

    @abstractmethod
    def state(self) -> State:
        """What is measured."""

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[np.ndarray, dict]:
        """Begin an episode."""
        super().reset(seed=seed)
        self.reset_engine()
        for _ in range(250):
            self.advance(HOME)
        self._parameters, self._phase, self._steps = PARAMETERS.copy(), 0.0, 0
        self._last_qd = self.state().qd
        return self._observe(self.state()), {}

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict]:
        """One action."""
        before = self._parameters
        self._parameters = np.clip(before + DELTA * action[:4], LOW, HIGH)
        residuals = RESIDUAL * action[4:].reshape(4, 3)
        for _ in range(self._control_steps):
            self._phase = (self._phase + CONTROL_DT / self._parameters[2]) % 1
            feet, swing = trot(self._parameters, self._phase, residuals)
            self.advance(inverse_kinematics(feet))
        state = self.state()
        self._steps += 1
        angles = roll_pitch_yaw(state.quaternion)
        acceleration = (state.qd - self._last_qd) / (self._control_steps * CONTROL_DT)
        self._last_qd = state.qd
        reward = (
            2000 * state.velocity[0]
            - 2 * abs(state.velocity[1])
            + np.where(state.contacts != swing, 0.2, -0.5).sum()
            - 2 * (angles**2).sum()
            - 0.1 * (acceleration**2).sum()
            - 5 * ((self._parameters - before) ** 2).sum()
        )
        fell = bool(np.abs(angles[:2]).max() > 60 or state.position[2] < START_HEIGHT / 2)
        return self._observe(state), float(reward), fell, self._steps >= self._limit, {}

    def _observe(self, s: State) -> np.ndarray:
        scaled = 2 * (self._parameters - LOW) / (HIGH - LOW) - 1
        parts = (s.position, s.quaternion, s.velocity, s.rate, s.q, s.qd, s.feet.ravel(), s.feet_velocity.ravel())
        return np.concatenate((*parts, s.contacts, scaled))


class MujocoNumpyEnv(NumpyQuadrupedEnv):
    """Over the `mujoco` package."""

    def __init__(self, urdf: str | Path, **options: Any) -> None:
        """Make the model of the robot's URDF."""
        import mujoco

        super().__init__(**options)
        self._mj = mujoco
        spec = mujoco.MjSpec.from_file(str(urdf))
        spec.compiler.fusestatic = False
        spec.option.timestep = PHYSICS_DT
        spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
        spec.body("trunk").add_freejoint()
        for joint in spec.joints:
            if joint.type == mujoco.mjtJoint.mjJNT_HINGE:
                joint.armature = ARMATURE
        for geom in spec.geoms:
            geom.contype, geom.conaffinity, geom.friction = 2, 1, [FRICTION, 0, 0]
        floor = spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0, 0, 1])
        floor.contype, floor.conaffinity, floor.friction = 1, 2, [FRICTION, 0, 0]
        for leg in LEGS:
            loop = spec.add_equality(type=mujoco.mjtEq.mjEQ_CONNECT, objtype=mujoco.mjtObj.mjOBJ_BODY)
            loop.name1, loop.name2 = f"{leg}_lower_left", f"{leg}_lower_right"
            loop.data[:3] = (0, 0, -LOWER)
            loop.solref = (0.005, 1)
        for name in SERVOS:
            servo = spec.add_actuator(name=name, trntype=mujoco.mjtTrn.mjTRN_JOINT, target=name)
            servo.set_to_position(kp=KP)
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)
        joints = [self.model.joint(name) for name in SERVOS]
        self._q = np.array([joint.qposadr[0] for joint in joints])
        self._qd = np.array([joint.dofadr[0] for joint in joints])
        self._feet = np.array([self.model.body(f"{leg}_foot").id for leg in LEGS])
        self._leg_of_geom = np.full(self.model.ngeom, -1)
        for i, body in enumerate(self._feet):
            self._leg_of_geom[self.model.geom_bodyid == body] = i

    def reset_engine(self) -> None:
        """Stand in the home posture."""
        self._mj.mj_resetData(self.model, self.data)
        self.data.qpos[:7] = (0, 0, START_HEIGHT, 1, 0, 0, 0)
        self.data.qpos[self._q] = HOME
        for leg in LEGS:
            for name, angle in HOME_ELBOWS.items():
                self.data.joint(f"{leg}_{name}").qpos = angle

    def advance(self, targets: np.ndarray) -> None:
        """Servos go to `targets` for CONTROL_DT."""
        self.data.ctrl[:] = targets
        self._mj.mj_step(self.model, self.data, nstep=round(CONTROL_DT / PHYSICS_DT))

    def state(self) -> State:
        """What is measured."""
        d = self.data
        velocity = np.empty((4, 6))
        for i, body in enumerate(self._feet):
            self._mj.mj_objectVelocity(self.model, d, self._mj.mjtObj.mjOBJ_BODY, body, velocity[i], 0)
        legs = self._leg_of_geom[d.contact.geom[: d.ncon]].max(axis=1) if d.ncon else np.empty(0, int)
        contacts = np.zeros(4)
        contacts[legs[legs >= 0]] = 1
        q, v = d.qpos, d.qvel
        rate = d.xmat[1].reshape(3, 3) @ v[3:6]
        feet = d.xpos[self._feet]
        return State(
            q[:3].copy(), q[3:7].copy(), v[:3].copy(), rate, q[self._q], v[self._qd], feet, velocity[:, 3:], contacts
        )


class PybulletNumpyEnv(NumpyQuadrupedEnv):
    """Over PyBullet, with its own position control: without armature, which it lacks, our servos are unstable."""

    def __init__(self, urdf: str | Path, **options: Any) -> None:
        """Load the robot's URDF."""
        import pybullet

        super().__init__(**options)
        self._p, self._client = pybullet, pybullet.connect(pybullet.DIRECT)
        p, client = pybullet, {"physicsClientId": self._client}
        p.setTimeStep(PHYSICS_DT, **client)
        p.setGravity(0, 0, -9.81, **client)
        plane = p.createMultiBody(0, p.createCollisionShape(p.GEOM_PLANE, **client), **client)
        p.changeDynamics(plane, -1, lateralFriction=1, **client)
        self._robot = p.loadURDF(str(urdf), [0, 0, START_HEIGHT], **client)
        infos = [p.getJointInfo(self._robot, i, **client) for i in range(p.getNumJoints(self._robot, **client))]
        joints = {info[1].decode(): info[0] for info in infos}
        links = {info[12].decode(): info[0] for info in infos}
        self._servos = [joints[name] for name in SERVOS]
        self._feet = [links[f"{leg}_foot"] for leg in LEGS]
        self._elbows = {joints[f"{leg}_{name}"]: angle for leg in LEGS for name, angle in HOME_ELBOWS.items()}
        moving = [*self._servos, *self._elbows]
        p.setJointMotorControlArray(self._robot, moving, p.VELOCITY_CONTROL, forces=[0.0] * len(moving), **client)
        for link in range(-1, len(infos)):
            p.changeDynamics(self._robot, link, lateralFriction=FRICTION, **client)
            p.setCollisionFilterGroupMask(self._robot, link, 2, 1, **client)
        for foot in self._feet:  # which the URDF gives no mass: PyBullet makes it 1 kg
            p.changeDynamics(self._robot, foot, mass=1e-3, localInertiaDiagonal=[1e-7] * 3, **client)
        p.setCollisionFilterGroupMask(plane, -1, 1, 2, **client)
        for leg in LEGS:
            a, b = links[f"{leg}_lower_left"], links[f"{leg}_lower_right"]
            # From the links' centres of mass, half way down.
            tip = [0, 0, -LOWER / 2]
            axis = [0, 0, 0]
            p.createConstraint(self._robot, a, self._robot, b, p.JOINT_POINT2POINT, axis, tip, tip, **client)

    def close(self) -> None:
        """Free the engine."""
        self._p.disconnect(self._client)

    def reset_engine(self) -> None:
        """Stand in the home posture."""
        p, client = self._p, {"physicsClientId": self._client}
        p.resetBasePositionAndOrientation(self._robot, [0, 0, START_HEIGHT], [0, 0, 0, 1], **client)
        p.resetBaseVelocity(self._robot, [0, 0, 0], [0, 0, 0], **client)
        for joint, angle in [*zip(self._servos, HOME, strict=True), *self._elbows.items()]:
            p.resetJointState(self._robot, joint, angle, **client)

    def advance(self, targets: np.ndarray) -> None:
        """Servos go to `targets` for CONTROL_DT."""
        p, client = self._p, {"physicsClientId": self._client}
        limits = [TORQUE] * len(self._servos)
        p.setJointMotorControlArray(
            self._robot, self._servos, p.POSITION_CONTROL, targetPositions=targets, forces=limits, **client
        )
        for _ in range(round(CONTROL_DT / PHYSICS_DT)):
            p.stepSimulation(**client)

    def state(self) -> State:
        """What is measured."""
        p, client = self._p, {"physicsClientId": self._client}
        position, (x, y, z, w) = p.getBasePositionAndOrientation(self._robot, **client)
        velocity, rate = p.getBaseVelocity(self._robot, **client)
        joints = p.getJointStates(self._robot, self._servos, **client)
        feet = p.getLinkStates(self._robot, self._feet, computeLinkVelocity=1, **client)
        contacts = np.zeros(4)
        touching = {contact[3] for contact in p.getContactPoints(self._robot, **client)}
        contacts[[i for i, foot in enumerate(self._feet) if foot in touching]] = 1
        return State(
            np.array(position),
            np.array([w, x, y, z]),
            np.array(velocity),
            np.array(rate),
            np.array([s[0] for s in joints]),
            np.array([s[1] for s in joints]),
            np.array([s[0] for s in feet]),
            np.array([s[6] for s in feet]),
            contacts,
        )
