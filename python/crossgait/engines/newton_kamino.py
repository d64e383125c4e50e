"""Newton's solver Kamino on the processor: maximal coordinates, joints and loops alike as constraints, in float32.

`pip install 'crossgait[newton]'`.
"""

from __future__ import annotations

from typing import Any

from crossgait.engines._newton_world import NewtonWorld, newton, serve_solver
from crossgait.serving import Array


class Kamino(NewtonWorld):
    """A world that Kamino steps."""

    holds_friction = True
    fixed_is_kinematic = True

    def _make_solver(self) -> Any:
        if self._world.robot["couplings"]:
            raise ValueError("Kamino has no coupled joints")
        config = newton.solvers.SolverKamino.Config()
        config.padmm.warmstart_mode = "none"  # a state goes on to the same bits, whatever was before it
        return newton.solvers.SolverKamino(self._model, config=config)

    def _forget(self) -> None:
        self._solver.reset(self._now, config=newton.solvers.SolverKamino.ResetConfig.preserve())

    def joint_friction(self) -> Array:
        """Return the dry friction that Newton holds, N m."""
        friction: Array = self._model.joint_friction.numpy()[self._v].astype(float)
        return friction


if __name__ == "__main__":
    serve_solver(Kamino, "Kamino: hard contact, proximal ADMM, in float32", "kamino/admm", ["joint_friction"])
