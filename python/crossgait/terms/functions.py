"""Terms that the field trains with and the configuration's tables do not have.

Names are Isaac Lab's and mjlab's where they have the term. What the tables do have (`action_rate_l2`, `joint_acc_l2`,
`joint_torques_l2`, `foot_slip`, ...) is there, in docs/environment.md.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from crossgait._core import Batch

FloatArray = npt.NDArray[np.float64]
Flags = npt.NDArray[np.bool_]
Indices = npt.NDArray[np.intp]

_MOVING = 0.1  #: m/s and rad/s; commands below it ask for standing


def _bodies(env: Batch, names: str | Sequence[str]) -> list[int]:
    return [env.body_index(name) for name in ([names] if isinstance(names, str) else names)]


def feet_air_time(env: Batch, threshold: float = 0.5) -> FloatArray:
    """Sum over feet that landed in this step of their swing's time beyond `threshold`, s; 0 where none is to move.

    Isaac Lab's, whose robots are larger: a quadruped of 0.3 m swings its feet for 0.2 s to 0.3 s.
    """
    late = (env.last_foot_air_time - threshold) * env.foot_landed
    moving = np.hypot(env.commands[:, 0], env.commands[:, 1]) + np.abs(env.commands[:, 2]) > _MOVING
    return np.asarray(late.sum(axis=1) * moving)


def foot_clearance(env: Batch, height: float) -> FloatArray:
    """Sum over feet of (height over the lowest foot - `height`)^2 times horizontal speed, m^3/s: MuJoCo Playground's.

    `height` is of the swinging feet over the lowest foot, m, which stands for the ground.
    """
    z = env.foot_positions[:, :, 2]
    above = z - z.min(axis=1, keepdims=True)
    speed = np.linalg.norm(env.foot_velocities[:, :, :2], axis=2)
    return np.asarray(((above - height) ** 2 * speed).sum(axis=1))


def undesired_contacts(env: Batch, bodies: str | Sequence[str], threshold: float = 1.0) -> FloatArray:
    """How many of `bodies` the ground carries with more than `threshold`, N."""
    force = np.linalg.norm(env.body_contact_forces[:, _bodies(env, bodies)], axis=2)
    return np.asarray((force > threshold).sum(axis=1), np.float64)


def illegal_contact(env: Batch, bodies: str | Sequence[str], threshold: float = 1.0) -> Flags:
    """Whether the ground carries any of `bodies` with more than `threshold`, N: a termination."""
    return np.asarray(undesired_contacts(env, bodies, threshold) > 0)


def base_height_below(env: Batch, height: float) -> Flags:
    """Whether the base's origin is lower than `height` over the ground below it, m: a termination."""
    return np.asarray(env.base_height < height)


def joint_pos_limits(env: Batch, soft: float = 0.9) -> FloatArray:
    """Sum over joints of how far they are beyond the middle `soft` of their range, rad."""
    lower, upper = env.joint_limits.T
    middle, half = (lower + upper) / 2, soft * (upper - lower) / 2
    return np.asarray(np.maximum(np.abs(env.joint_positions - middle) - half, 0).sum(axis=1))


def joint_vel_limits(env: Batch, limit: float) -> FloatArray:
    """Sum over joints of how far their speed is beyond `limit`, rad/s."""
    return np.asarray(np.maximum(np.abs(env.joint_velocities) - limit, 0).sum(axis=1))


def torque_limits(env: Batch, limit: float) -> FloatArray:
    """Sum over joints of how far their torque in the last physics step is beyond `limit`, N m."""
    return np.asarray(np.maximum(np.abs(env.joint_torques) - limit, 0).sum(axis=1))


def push_by_setting_velocity(env: Batch, indices: Indices, speed: float) -> None:
    """Add a velocity to the base: horizontal, uniform in +-`speed` along each axis, m/s. An event."""
    qvel = env.qvel[indices]
    qvel[:, :2] += env.random.uniform(-speed, speed, (len(indices), 2))
    env.set_state(qvel=qvel, indices=indices.tolist())


def reset_joints_by_offset(env: Batch, indices: Indices, offset: float) -> None:
    """Turn every servo by an angle uniform in +-`offset`, rad, within the joints' limits. An event of mode reset.

    Robots with closed loops pull themselves together again as their engine's loops do.
    """
    servos = np.asarray(env.servo_indices)
    qpos = env.qpos[indices]
    angles = qpos[:, 7 + servos] + env.random.uniform(-offset, offset, (len(indices), len(servos)))
    lower, upper = env.joint_limits[servos].T
    qpos[:, 7 + servos] = angles.clip(lower, upper)
    env.set_state(qpos=qpos, indices=indices.tolist())


def set_parameters_uniform(env: Batch, indices: Indices, **ranges: tuple[float, float]) -> None:
    """Draw parameters uniformly: `friction=(0.4, 0.8)`, `mass=(10, 14)`. An event; worlds are built anew."""
    drawn: dict[str, Any] = {name: env.random.uniform(*ends, len(indices)) for name, ends in ranges.items()}
    env.set_parameters(drawn, indices.tolist())
