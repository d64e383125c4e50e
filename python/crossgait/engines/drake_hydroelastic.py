"""Drake's hydroelastic contact by its solver SAP, on plane and height field.

Shapes of a compliant material touch rigid ground over a surface with a pressure, and not at points. One that lies below
the ground as a whole touches nothing. A contact is the surface between one shape and the ground: its place is the
surface's centroid and half of the depth below, its force the whole of what the pressure comes to.
`pip install 'crossgait[drake]'`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from crossgait.engines._drake_world import CONSTRAINTS, DrakeWorld, serve_drake
from crossgait.extras import needed_for
from crossgait.serving import Array, EngineContact, ServedWorld

with needed_for("worlds in Drake", "drake"):
    from pydrake.common import MemoryFile
    from pydrake.geometry import (
        AddCompliantHydroelasticProperties,
        AddRigidHydroelasticProperties,
        Box,
        Capsule,
        Convex,
        Cylinder,
        HalfSpace,
        InMemoryMesh,
        Mesh,
        Sphere,
    )
    from pydrake.math import RigidTransform

MODULUS = 1e7  #: of hydroelastic pressure, Pa: what Drake's own default properties have
#: Length of the edges that shapes are divided into, of their least half size. Feet sink 4 % deeper than round ones.
EDGES = 1 / 6


class Touching(NamedTuple):
    """A shape that may touch the ground."""

    body: int
    leg: int
    X_BG: RigidTransform
    kind: str
    size: Array  #: m
    vertices: Array  #: of a hull, in the shape's frame, m


class DrakeHydroelastic(DrakeWorld):
    """A world of one robot whose shapes touch the ground by surfaces."""

    contact_model = "hydroelastic"

    def __init__(self, world: ServedWorld) -> None:
        self._shapes: dict[Any, Touching] = {}
        super().__init__(world)

    def _add_shape(self, index: int, name: str, shape: Mapping[str, Any]) -> None:
        pose, size, vertices = (np.array(shape[key]) for key in ("X_BG", "size", "vertices"))
        kind = shape["type"]
        own = Touching(index, self._leg_of(index, kind, pose[:3, 3]), self._in_body(index, pose), kind, size, vertices)
        made = {
            "sphere": lambda: Sphere(size[0]),
            "capsule": lambda: Capsule(size[0], 2 * size[1]),
            "cylinder": lambda: Cylinder(size[0], 2 * size[1]),
            "box": lambda: Box(*(2 * size)),
            "hull": lambda: Convex(vertices.T, name),
        }[kind]()
        properties = self._properties()
        AddCompliantHydroelasticProperties(EDGES * _least_size(own), MODULUS, properties)
        self._shapes[self._register(index, name, pose, made, properties)] = own

    def _add_ground(self) -> None:
        properties = self._properties()
        AddRigidHydroelasticProperties(properties)
        terrain = self._world.terrain
        ground = _mesh_of(self._world.heights, terrain) if terrain["columns"] else HalfSpace()
        self._register_ground(ground, properties)

    def _contacts_of_this_step(self) -> list[EngineContact]:
        results = self._plant.get_contact_results_output_port().Eval(self._of_plant)
        found = (results.hydroelastic_contact_info(i) for i in range(results.num_hydroelastic_contacts()))
        # Where a shape just touches, Drake has a surface without an area.
        return [self._contact(info) for info in found if info.contact_surface().total_area() > 0]

    def _contact(self, info: Any) -> EngineContact:
        surface = info.contact_surface()
        # Normals of Drake go from N to M, forces act on M's body.
        ours_is_M = surface.id_M() in self._shapes
        geometry, sign = (surface.id_M(), 1.0) if ours_is_M else (surface.id_N(), -1.0)
        shape = self._shapes[geometry]
        areas = np.array([surface.area(face) for face in range(surface.num_faces())])
        normal = sign * areas @ [surface.face_normal(face) for face in range(len(areas))]
        normal /= np.linalg.norm(normal)
        place = surface.centroid()
        X_WG = self._plant.EvalBodyPoseInWorld(self._of_plant, self._bodies[shape.body]) @ shape.X_BG
        deepest = X_WG @ _farthest(shape, -(X_WG.rotation().inverse() @ normal))
        distance = float((deepest - place) @ normal)
        return EngineContact(
            shape.body,
            shape.leg,
            place + 0.5 * distance * normal,
            normal,
            distance,
            sign * info.F_Ac_W().translational(),
            self._slip_at(shape.body, place, normal),
        )


def _least_size(shape: Touching) -> float:
    """Return the least half width of a shape, m."""
    if shape.kind == "hull":
        return float(np.ptp(shape.vertices, axis=0).min()) / 2
    counts = {"sphere": 1, "capsule": 1, "cylinder": 2, "box": 3}
    return float(min(shape.size[: counts[shape.kind]]))


def _farthest(shape: Touching, along: Array) -> Array:
    """Return the point of a shape that is farthest along a unit vector, both in the shape's own frame, m."""
    point: Array = shape.size[0] * along
    if shape.kind == "hull":
        point = shape.vertices[np.argmax(shape.vertices @ along)]
    elif shape.kind == "box":
        point = np.copysign(shape.size, along)
    elif shape.kind == "cylinder":
        away: Array = np.array([along[0], along[1], 0])
        point = shape.size[0] / max(float(np.linalg.norm(away)), 1e-300) * away
    if shape.kind in ("capsule", "cylinder"):
        point = point + np.array([0, 0, np.copysign(shape.size[1], along[2])])
    return point


def _mesh_of(heights: Array, terrain: Mapping[str, Any]) -> Mesh:
    """Return a field's triangles, each cell cut from its least corner to its greatest, as in Crossgait's sampler."""
    rows, columns = heights.shape
    x, y = (np.linspace(-0.5, 0.5, n) * terrain[size] for n, size in ((columns, "size_x"), (rows, "size_y")))
    lines = [f"v {float(x[c])!r} {float(y[r])!r} {float(heights[r, c])!r}" for r in range(rows) for c in range(columns)]
    for r in range(rows - 1):
        for c in range(columns - 1):
            a = r * columns + c + 1  # of OBJ, which counts from one
            b, e, f = a + 1, a + columns, a + columns + 1
            lines += [f"f {a} {b} {f}", f"f {a} {f} {e}"]
    return Mesh(InMemoryMesh(mesh_file=MemoryFile("\n".join(lines) + "\n", ".obj", "ground")))


if __name__ == "__main__":
    serve_drake(DrakeHydroelastic, "hydroelastic contact, SAP", "drake_hydroelastic/sap", **CONSTRAINTS)
