"""Newton's solver Steel on the processor: a tree in reduced coordinates, rows by projected Gauss-Seidel, in float32.

`pip install 'crossgait[newton]'`.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from crossgait.engines._newton_world import NewtonWorld, newton, serve_solver
from crossgait.serving import MOST_CONTACTS, Array, rotated


class Steel(NewtonWorld):
    """A world that Steel steps."""

    def _register(self, builder: Any) -> None:
        newton.solvers.SolverSteel.register_custom_attributes(builder)

    def _make_solver(self) -> Any:
        self._model.steel.rigid_body_angular_damping.fill_(0.0)  # 0.05 1/s, unless one says so
        robot = self._world.robot
        rows = 3 * (MOST_CONTACTS + len(robot["loops"])) + len(robot["couplings"]) + 2 * self._world.joint_count
        return newton.solvers.SolverSteel(
            self._model,
            enable_joint_limits=True,
            articulation_constraint_max=rows,
            friction_anchor_beta=0.0,  # nothing is carried from step to step
            contact_shared_anchor=True,
            contact_friction_shared_anchor=True,
        )

    def mass_matrix(self) -> Array:
        """Return the joint-space inertia of [v_WB, w_WB, qd], without the base where it is fixed."""
        now, joints = self._now, self._world.joint_count
        newton.eval_fk(self._model, now.joint_q, now.joint_qd, now)
        M: Array = newton.eval_mass_matrix(self._model, now).numpy()[0].astype(float)
        first = len(M) - joints
        ours = np.eye(len(M))  # Newton's velocities per unit of ours: of the base's centre of mass, w x arm faster
        if first:
            arm = rotated(now.body_q.numpy()[0].astype(float)[[6, 3, 4, 5]], self._centre)
            ours[:3, 3:6] = np.cross(np.eye(3), arm).T
        whole: Array = ours.T @ M @ ours
        return whole


if __name__ == "__main__":
    serve_solver(Steel, "Steel: hard contact, projected Gauss-Seidel, in float32", "steel/sweeps", ["couplings"])
