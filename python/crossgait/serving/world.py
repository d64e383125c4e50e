"""What an engine in a process of its own is told, and what it answers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple, Protocol

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

MOST_CONTACTS = 64  #: points that Crossgait hands out at once, kMaxContacts

#: What an engine may answer beside `reset`, `step` and `state`, by the method that does it.
OPTIONAL = {
    "contacts": "contacts",
    "save": "saved",
    "mass_matrix": "mass_matrix",
    "body_pose": "body_pose",
    "body_inertia": "body_inertia",
    "terrain_height": "terrain_height",
    "joint_friction": "joint_friction",
    "joint_limits": "joint_limits",
}


class EngineState(NamedTuple):
    """Configuration and velocity of a robot; world frame W, base frame B at the base's origin."""

    p_WB: Array  #: position of the base, m
    q_WB: Array  #: its orientation, unit quaternion w, x, y, z
    v_WB: Array  #: velocity of its origin, m/s
    w_WB: Array  #: its angular velocity in W, rad/s
    q: Array  #: joint angles, rad
    qd: Array  #: joint velocities, rad/s


class EngineContact(NamedTuple):
    """One contact point of the step that was made, at the configuration that it began with."""

    body: int  #: index into `world.robot["bodies"]`
    leg: int  #: whose foot it is, or -1
    p_WP: Array  #: midway in the overlap, m
    normal: Array  #: unit, from the ground to the robot
    distance: float  #: m, negative where they overlap
    force: Array  #: on the robot, in W, mean over the step, N
    slip_speed: float  #: tangential speed of the body at the point before the step, m/s


class ContactPoint(NamedTuple):
    """A point that touches the ground, or may within the step."""

    body: int
    leg: int
    p_WP: Array  #: m
    normal: Array
    distance: float  #: m
    jacobian: Array  #: of the point's velocity in W by the equations' velocity, 3 x n


class Equations(NamedTuple):
    """M u' + bias = forces in u = [v_WC, w_WB, qd], C the base's centre of mass.

    With soft loops: (M + loop_matrix) u_next = M u + h (forces - bias) + loop_vector.
    """

    mass_matrix: Array  #: n x n, armature included; kg, kg m, kg m^2
    bias: Array  #: gravity included; N, N m
    velocity: Array  #: u
    loop_matrix: Array
    loop_vector: Array
    points: list[ContactPoint]


class ServedWorld:
    """What an engine is told of the world that it is to simulate; docs/engines-in-processes.md lists the keys."""

    def __init__(self, told: Mapping[str, Any], heights: Array, numbers: Mapping[str, Array]) -> None:
        self.robot: Mapping[str, Any] = told["robot"]
        self.terrain: Mapping[str, Any] = told["terrain"]
        self.heights = heights  #: rows x columns, m; of the plane z = 0 none
        self.physics_dt: float = told["physics_dt"]  #: s
        self.gravity = np.array(told["gravity"])  #: m/s^2
        self.fixed_base: bool = told["fixed_base"]
        self.contact: Mapping[str, Any] = told["contact"]
        self.solver: Mapping[str, Any] = told["solver"]
        self.joint_count = len(self.robot["bodies"]) - 1
        size = 6 + self.joint_count
        self._numbers = numbers
        self._matrices = {
            key: numbers[key][: size * size].reshape(size, size) for key in ("mass_matrix", "loop_matrix")
        }
        self._size = size

    def equations(self) -> Equations:
        """Of the step that begins; valid until it is made. Only of an engine that says a `contact_margin`."""
        n, of = self._size, self._numbers
        points = []
        for i in range(int(of["point_count"][0])):
            p = of["points"][9 * i : 9 * i + 9]
            jacobian = of["jacobians"][3 * n * i : 3 * n * (i + 1)].reshape(3, n)
            points.append(ContactPoint(int(p[0]), int(p[1]), p[2:5].copy(), p[5:8].copy(), float(p[8]), jacobian))
        vectors = (of[key][:n] for key in ("bias", "velocity"))
        bias, velocity = vectors
        M, A = self._matrices["mass_matrix"], self._matrices["loop_matrix"]
        return Equations(M, bias, velocity, A, of["loop_vector"][:n], points)


class ServableEngine(Protocol):
    """What an engine has to be; `OPTIONAL` names what else it may have."""

    def __init__(self, world: ServedWorld) -> None:
        """Make a world. Raise what is to be said of one that it does not simulate."""

    def reset(self, state: EngineState) -> None:
        """Put the robot into a state, and forget all that was."""

    def step(self, torques: Array, force: Array, torque: Array) -> None:
        """Make one step of `world.physics_dt`: joint torques and torque, N m; force at the base's centre of mass, N."""

    def state(self) -> EngineState:
        """Return the state as it is now."""
