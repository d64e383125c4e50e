"""Drake's compliant point contact by its solver SAP, on the plane.

Drake finds one point a shape, and takes a mesh for its convex hull: ground that is no plane is refused.
`pip install 'crossgait[drake]'`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from crossgait.engines._drake_world import CONSTRAINTS, DrakeWorld, serve_drake
from crossgait.extras import needed_for
from crossgait.serving import EngineContact, ServedWorld

with needed_for("worlds in Drake", "drake"):
    from pydrake.geometry import Cylinder, HalfSpace, Sphere

CORNER = 1e-6  #: radius of the spheres in the place of corners and vertices, m


class DrakePoints(DrakeWorld):
    """A world of one robot on the plane, whose shapes touch it by points."""

    def __init__(self, world: ServedWorld) -> None:
        if world.terrain["columns"]:
            raise ValueError(f"Drake's point contact takes the plane alone, not '{world.terrain['name']}'")
        self._legs: dict[Any, int] = {}
        super().__init__(world)

    def _add_shape(self, index: int, name: str, shape: Mapping[str, Any]) -> None:
        pose, size = np.array(shape["X_BG"]), np.array(shape["size"])
        kind = shape["type"]
        if kind == "cylinder":
            self._register(index, name, pose, Cylinder(size[0], 2 * size[1]), self._properties())
            return
        places, radius = {
            "sphere": (np.zeros((1, 3)), size[0]),
            "capsule": (np.array([[0, 0, size[1]], [0, 0, -size[1]]]), size[0]),
            "box": (size * np.array(np.meshgrid([1, -1], [1, -1], [1, -1])).reshape(3, -1).T, CORNER),
            "hull": (np.array(shape["vertices"]), CORNER),
        }[kind]
        for i, place in enumerate(places):
            at = pose.copy()
            at[:3, 3] += pose[:3, :3] @ place
            geometry = self._register(index, f"{name}.{i}", at, Sphere(radius), self._properties())
            self._legs[geometry] = self._leg_of(index, kind, pose[:3, 3])

    def _add_ground(self) -> None:
        self._register_ground(HalfSpace(), self._properties())

    def _contacts_of_this_step(self) -> list[EngineContact]:
        results = self._plant.get_contact_results_output_port().Eval(self._of_plant)
        found, up = [], np.array([0.0, 0.0, 1.0])
        for i in range(results.num_point_pair_contacts()):
            info = results.point_pair_contact_info(i)
            pair = info.point_pair()
            # The ground is one of the two; normals of Drake go from B to A, forces act on B.
            ours_is_B = info.bodyA_index() == self._plant.world_body().index()
            index = self._body_of[info.bodyB_index() if ours_is_B else info.bodyA_index()]
            leg = self._legs.get(pair.id_B if ours_is_B else pair.id_A, -1)
            force = info.contact_force() if ours_is_B else -info.contact_force()
            place = info.contact_point()
            found.append(EngineContact(index, leg, place, up, -pair.depth, force, self._slip_at(index, place, up)))
        return found


if __name__ == "__main__":
    serve_drake(DrakePoints, "compliant point contact, SAP", "drake_point/sap", **CONSTRAINTS)
