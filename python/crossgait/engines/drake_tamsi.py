"""Drake's compliant point contact by its solver TAMSI, on the plane.

Friction grows with the speed of sliding, so that what stands creeps. TAMSI solves contact alone: robots with loops or
coupled joints are refused. `pip install 'crossgait[drake]'`.
"""

from __future__ import annotations

from crossgait.engines._drake_world import serve_drake
from crossgait.engines.drake import DrakePoints
from crossgait.serving import ServedWorld


class DrakeTamsi(DrakePoints):
    """A world of one robot on the plane, by TAMSI."""

    approximation = "tamsi"

    def __init__(self, world: ServedWorld) -> None:
        if world.robot["loops"] or world.robot["couplings"]:
            raise ValueError("Drake's TAMSI has no loops and no coupled joints; its SAP has (python:drake)")
        super().__init__(world)


if __name__ == "__main__":
    serve_drake(DrakeTamsi, "compliant point contact, TAMSI", "drake_point/tamsi")
