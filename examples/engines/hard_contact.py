"""An engine in sixty lines: hard contact with Coulomb friction, in NumPy, on Crossgait's equations of motion.

Run it by `crossgait walk --engine python:examples/engines/hard_contact.py --gait trot`.
"""

import numpy as np

import crossgait
from crossgait.serving import ContactPoint, ServedWorld, TreeEngine

ERROR_REDUCTION = 0.2  # share of a penetration that a step takes away


class HardContact(TreeEngine):
    """Impulses by projected Gauss-Seidel sweeps over the points, each with its own cone."""

    def __init__(self, world: ServedWorld) -> None:
        super().__init__(world)
        self.friction = float(world.contact["friction"])

    def solve(self, A: np.ndarray, b: np.ndarray, points: list[ContactPoint]) -> np.ndarray:
        """Return impulses with which no point comes nearer than it may, and friction opposes the slip."""
        h = self.world.physics_dt
        axes = np.array([axes_of(point.normal) for point in points])  # rows: normal, two across
        J = np.concatenate([R @ point.jacobian for R, point in zip(axes, points, strict=True)])
        W = J @ np.linalg.solve(A, J.T)  # how the points' velocities respond to impulses
        free = J @ np.linalg.solve(A, b)
        wanted = [-p.distance / h * (ERROR_REDUCTION if p.distance < 0 else 1) for p in points]
        impulses = np.zeros(len(free))
        for _ in range(int(self.world.solver["iterations"])):
            before = impulses.copy()
            for i, speed in enumerate(wanted):
                self.sweep(slice(3 * i, 3 * i + 3), speed, W, free, impulses)
            change, size = np.abs(impulses - before).max(), np.abs(impulses).max()
            if change <= self.world.solver["tolerance"] * size:
                break
        return np.einsum("ikl,ik->il", axes, impulses.reshape(-1, 3))

    def sweep(self, rows: slice, wanted: float, W: np.ndarray, free: np.ndarray, impulses: np.ndarray) -> None:
        """Solve one point with the others as they are: its normal, then its friction."""
        own, y = W[rows, rows], impulses[rows]
        if not own[0, 0] > 0:
            return  # of a body that cannot move
        velocity = free[rows] + W[rows] @ impulses
        normal = max(0.0, y[0] + (wanted - velocity[0]) / own[0, 0])
        velocity = velocity + own[:, 0] * (normal - y[0])
        across = y[1:] - velocity[1:] / max(own[1, 1], own[2, 2])  # one step size, or it would not oppose the slip
        size, most = np.hypot(*across), self.friction * normal
        impulses[rows] = normal, *(across if size <= most else across * (most / size))


def axes_of(normal: np.ndarray) -> np.ndarray:
    """Return a right-handed frame whose first row is the normal."""
    across = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
    across /= np.linalg.norm(across)
    return np.array([normal, across, np.cross(normal, across)])


crossgait.serve_engine(
    HardContact,
    library="NumPy",
    version=np.__version__,
    mode="hard contact, projected Gauss-Seidel, in NumPy",
    laws={"contact": "hard/numpy", "loops": "mujoco", "couplings": "mujoco", "contact_family": "rigid"},
    capabilities={"sweeps": True, "exact_field_query": True},
    contact_margin=1e-3,
)
