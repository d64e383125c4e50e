"""What a viewer shows of a trace: the robot's shapes, where its bodies were and where its feet came down.

SI units, world frame W with z up; of no viewer in particular.
"""

from __future__ import annotations

import itertools
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from crossgait import _core
from crossgait.errors import ConfigError
from crossgait.inputs import RobotLike, as_robot
from crossgait.traces.table import Numbers, TraceTable

Indices = npt.NDArray[np.int64]

#: Of the files of meshes that viewers read.
MEDIA_TYPES = {
    ".dae": "model/vnd.collada+xml",
    ".glb": "model/gltf-binary",
    ".gltf": "model/gltf+json",
    ".obj": "model/obj",
    ".stl": "model/stl",
}
_PLAIN = np.array([0.75, 0.75, 0.78, 1.0])
#: How far beyond the base's way the ground is shown, m.
MARGIN = 1.0
# Colours of the ground, of its lowest and its highest point.
_LOWEST, _HIGHEST = np.array([0.23, 0.32, 0.29, 1.0]), np.array([0.89, 0.84, 0.70, 1.0])


@dataclass(frozen=True, eq=False)
class Shape:
    """A shape of a body, in a colour."""

    body: int  #: index into `Robot.bodies`
    type: str  #: box, sphere, cylinder, capsule, mesh or hull
    size: Numbers  #: half extents; radius; radius and half length along z
    pose: Numbers  #: in the body's frame, 4 x 4
    rgba: Numbers  #: 0 to 1
    mesh: Path | None  #: the file of a mesh
    scale: Numbers  #: of a mesh, along x, y and z
    vertices: Numbers  #: of a hull, N x 3

    def triangles(self) -> Indices:
        """Faces of a hull, T x 3 indices of vertices, counter-clockwise seen from outside; flat faces may overlap."""
        middle, tolerance = self.vertices.mean(axis=0), 1e-9 * np.ptp(self.vertices)
        faces = []
        for face in itertools.combinations(range(len(self.vertices)), 3):
            a, b, c = self.vertices[list(face)]
            normal = np.cross(b - a, c - a)
            outwards = 1 if normal @ (a - middle) > 0 else -1
            # All vertices on one side of the plane: a face of the hull. The cross product of a needle is no normal.
            if np.linalg.norm(normal) > 0 and np.all(outwards * (self.vertices - a) @ normal <= tolerance):
                faces.append(face[::outwards])
        return np.array(faces, dtype=np.int64).reshape(-1, 3)


def shapes(robot: _core.Robot) -> list[Shape]:
    """Visual shapes, and the collision shapes of bodies that have none, or one that cannot be shown."""
    found, seen, dropped = [], set(), set()
    for visual in robot.visuals:
        mesh = Path(visual["mesh"]) if visual["type"] == "mesh" else None
        if mesh is not None and not (mesh.suffix.lower() in MEDIA_TYPES and mesh.is_file()):
            dropped.add(visual["body"])
            if visual["mesh"]:  # of one without a file the robot's own warnings tell
                warnings.warn(f"{mesh}: no viewer reads it; collision shapes are shown instead", stacklevel=3)
            continue
        rgba = _PLAIN if visual["rgba"] is None else visual["rgba"]
        found.append(_shape(visual, rgba, mesh, visual["scale"], np.empty((0, 3))))
        seen.add(visual["body"])
    for collision in robot.collisions:
        if collision["body"] not in seen or collision["body"] in dropped:
            found.append(_shape(collision, _PLAIN, None, np.ones(3), collision["vertices"]))
    return found


def _shape(shape: dict[str, Any], rgba: Numbers, mesh: Path | None, scale: Numbers, vertices: Numbers) -> Shape:
    return Shape(shape["body"], shape["type"], shape["size"], shape["pose"], rgba, mesh, scale, vertices)


_ROUNDING = 1e-3  #: of quaternions that were written with few digits


def the_robot(trace: TraceTable, robot: RobotLike) -> _core.Robot:
    """Load it, if it is a name or file. Raises ConfigError if the trace is not of this robot."""
    robot = as_robot(robot)
    missing = [joint for joint in robot.joints if f"q.{joint}" not in trace]
    if missing:
        joints = ", ".join(list(trace.group("q"))[:4])
        raise ConfigError("trace", "robot", f"the robot that walked, with joints {joints}, ...", robot.name)
    with np.errstate(over="ignore"):
        lengths = np.linalg.norm(np.stack([trace[f"q_WB.{axis}"] for axis in "wxyz"]), axis=0)
    if (wrong := np.flatnonzero(~(np.abs(lengths - 1) < _ROUNDING))).size:
        found = f"one of length {lengths[wrong[0]]:g} in row {wrong[0] + 1}"
        raise ConfigError(trace.name or "trace", "q_WB", "unit quaternions", found)
    return robot


def poses(trace: TraceTable, robot: _core.Robot) -> Numbers:
    """Poses of all bodies in W at every row, rows x bodies x 4 x 4."""
    state = _core.State()
    position = np.stack([trace[f"p_WB.{axis}"] for axis in "xyz"], axis=1)
    orientation = np.stack([trace[f"q_WB.{axis}"] for axis in "wxyz"], axis=1)
    joints = np.stack([trace[f"q.{joint}"] for joint in robot.joints], axis=1)
    result = np.empty((len(trace), len(robot.bodies), 4, 4))
    for row, values in enumerate(zip(position, orientation, joints, strict=True)):
        state.p_WB, state.q_WB, state.q = values
        result[row] = _core.body_poses(robot, state)
    return result


def quaternions(rotations: Numbers) -> Numbers:
    """Unit quaternions x, y, z, w of rotation matrices: ... x 3 x 3 to ... x 4.

    The eigenvector of the largest eigenvalue of Bar-Itzhack's K, "New method for extracting the quaternion from a
    rotation matrix", J. Guidance, Control, and Dynamics 23(6), 2000: exact to rounding for every rotation.
    """
    r = rotations
    k = np.empty((*r.shape[:-2], 4, 4))
    k[..., :3, :3] = r + np.swapaxes(r, -1, -2)
    trace = np.trace(r, axis1=-2, axis2=-1)
    k[..., range(3), range(3)] -= trace[..., None]
    vector = np.stack([r[..., 2, 1] - r[..., 1, 2], r[..., 0, 2] - r[..., 2, 0], r[..., 1, 0] - r[..., 0, 1]], axis=-1)
    k[..., :3, 3] = k[..., 3, :3] = vector
    k[..., 3, 3] = trace
    largest: Numbers = np.linalg.eigh(k)[1][..., -1]
    return largest * np.where(largest[..., 3:] < 0, -1.0, 1.0)


def footfalls(trace: TraceTable, robot: _core.Robot, poses: Numbers) -> dict[str, tuple[Indices, Numbers]]:
    """By leg, the rows at which its foot comes down (the first if it stands) and the foot's centre in W, N x 3."""
    result = {}
    for name, leg in _core.legs(robot).items():
        touching = trace[f"contact.{name}"] > 0
        rows = np.flatnonzero(touching & ~np.concatenate([[False], touching[:-1]]))
        angles = np.stack([trace[f"q.{robot.joints[i]}"] for i in leg.servo_indices], axis=1)[rows]
        p_BF = leg.origin + leg.forward(angles)  # the leg's frame has the base's axes
        X_WB = poses[rows, 0]
        result[name] = rows, X_WB[:, :3, 3] + np.einsum("nij,nj->ni", X_WB[:, :3, :3], p_BF)
    return result


@dataclass(frozen=True, eq=False)
class Ground:
    """A surface in W."""

    vertices: Numbers  #: N x 3, m
    triangles: Indices  #: T x 3 indices of vertices, counter-clockwise seen from above
    rgba: Numbers  #: of the vertices, N x 4, 0 to 1: by height


def ground(terrain: _core.Terrain | None, trace: TraceTable) -> Ground | None:
    """A height field as far as `MARGIN` from where the base went; None of a plane, for which viewers have a grid."""
    if terrain is None or terrain.heights is None or terrain.size is None or len(trace) == 0:
        return None
    heights = terrain.heights.astype(np.float64)
    y, x = (np.linspace(-size / 2, size / 2, n) for size, n in zip(terrain.size[::-1], heights.shape, strict=True))
    row, column = _near(y, trace["p_WB.y"]), _near(x, trace["p_WB.x"])
    x, y, z = x[column], y[row], heights[row, column]
    vertices = np.stack([*np.meshgrid(x, y), z], axis=-1).reshape(-1, 3)
    a = (np.arange(len(y) - 1)[:, None] * len(x) + np.arange(len(x) - 1)).ravel()
    b, c, d = a + 1, a + len(x) + 1, a + len(x)
    triangles = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    share = (vertices[:, 2:] - heights.min()) / max(float(np.ptp(heights)), 1e-9)
    return Ground(vertices, triangles, _LOWEST + share * (_HIGHEST - _LOWEST))


def _near(samples: Numbers, way: Numbers) -> slice:
    """Those within the margin of the way, and two at least."""
    begin = int(np.searchsorted(samples, way.min() - MARGIN))
    end = int(np.searchsorted(samples, way.max() + MARGIN))
    begin = min(begin, len(samples) - 2)
    return slice(begin, max(end, begin + 2))


def columns(trace: TraceTable) -> dict[str, dict[str, Numbers]]:
    """All columns but the time, by what stands before the first dot: {"q": {"FL_tilt": ...}, ...}."""
    groups: dict[str, dict[str, Numbers]] = {}
    for name in trace.names:
        if name != "time":
            group, _, rest = name.partition(".")
            groups.setdefault(group, {})[rest or "value"] = trace[name]
    return groups
