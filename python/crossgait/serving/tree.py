"""An engine that is a law of contact alone."""

from __future__ import annotations

import numpy as np

from crossgait.serving.world import Array, ContactPoint, EngineContact, EngineState, ServedWorld


class TreeEngine:
    """An engine that is a law of contact alone, on Crossgait's own equations of motion: write `solve`.

    Semi-implicit Euler, as docs/adding-an-engine.md has it: velocities first, then positions with those.
    """

    def __init__(self, world: ServedWorld) -> None:
        self.world = world
        self._centre = np.array(world.robot["bodies"][0]["inertia"]["p_BC"])
        self._first = 6 if world.fixed_base else 0  # of the velocities that move

    def solve(self, A: Array, b: Array, points: list[ContactPoint]) -> Array:
        """Return the impulses on the robot at the points, in W, N s, one row each.

        The next velocity is A^-1 (b + J^T impulses); the points' Jacobians have the columns of A.
        """
        raise NotImplementedError

    def reset(self, state: EngineState) -> None:
        """Put the robot into a state."""
        still = np.zeros(3)
        self._state = state._replace(v_WB=still, w_WB=still) if self._first else state
        self._contacts: list[EngineContact] = []

    def state(self) -> EngineState:
        """Return the state."""
        return self._state

    def contacts(self) -> list[EngineContact]:
        """Return the points that touch or carry something."""
        return self._contacts

    def step(self, torques: Array, force: Array, torque: Array) -> None:
        """Make one step."""
        h, e, first = self.world.physics_dt, self.world.equations(), self._first
        b = e.mass_matrix @ e.velocity + e.loop_vector - h * e.bias + h * np.concatenate((force, torque, torques))
        A = (e.mass_matrix + e.loop_matrix)[first:, first:]
        points = [point._replace(jacobian=point.jacobian[:, first:]) for point in e.points]
        impulses = self.solve(A, b[first:], points) if points else np.zeros((0, 3))
        right = b[first:] + sum((p.jacobian.T @ y for p, y in zip(points, impulses, strict=True)), np.zeros(len(A)))
        self._contacts = []
        for point, impulse in zip(points, impulses, strict=True):
            if point.distance > 0 and not impulse @ point.normal > 0:
                continue  # it came no nearer
            speed = point.jacobian @ e.velocity[first:]
            slip = float(np.linalg.norm(speed - (speed @ point.normal) * point.normal))
            self._contacts.append(EngineContact(*point[:5], impulse / h, slip))
        self._integrate(np.concatenate((np.zeros(first), np.linalg.solve(A, right))))

    def _integrate(self, u: Array) -> None:
        h, s = self.world.physics_dt, self._state
        q = s.q + h * u[6:]
        if self._first:
            self._state = s._replace(q=q, qd=u[6:])
            return
        v_WC, w = u[:3], u[3:6]
        p_WC = s.p_WB + rotated(s.q_WB, self._centre) + h * v_WC
        q_WB = turned(s.q_WB, h * w)
        arm = rotated(q_WB, self._centre)
        self._state = EngineState(p_WC - arm, q_WB, v_WC - np.cross(w, arm), w, q, u[6:])


def rotated(q: Array, v: Array) -> Array:
    """Return a vector turned by a unit quaternion."""
    twice: Array = 2 * np.cross(q[1:], v)
    result: Array = v + q[0] * twice + np.cross(q[1:], twice)
    return result


def turned(q: Array, way: Array) -> Array:
    """Return a quaternion turned on by a rotation vector in W (rad), exactly."""
    angle = float(np.linalg.norm(way))
    if not angle > 0:
        return q
    w, x = np.cos(angle / 2), np.sin(angle / 2) / angle * way
    after = np.concatenate(([w * q[0] - x @ q[1:]], w * q[1:] + q[0] * x + np.cross(x, q[1:])))
    unit: Array = after / np.linalg.norm(after)
    return unit
