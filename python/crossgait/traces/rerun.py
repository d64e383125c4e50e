"""Traces for Rerun: .rrd files (`crossgait[rerun]`).

`world/robot/BODY` has the pose of each body and its shapes, `world/ground` the ground, `world/footfalls/LEG` where its
foot came down so far, and each column is a plot of its own: joint angle FL_tilt is `trace/q/FL_tilt`. The timeline is
`time`, simulated seconds.
"""

from __future__ import annotations

import os
from typing import Any

import numpy as np

try:
    import rerun as rr
except ImportError as error:
    raise ImportError("Trace.to_rerun needs rerun-sdk: pip install crossgait[rerun]") from error

from crossgait import _core
from crossgait.files import written_whole
from crossgait.traces import scene
from crossgait.traces.scene import MEDIA_TYPES, Ground, Shape
from crossgait.traces.table import TraceTable

_FOOTFALL_RADIUS = 0.006  # m
_FOOTFALL_COLOUR = (230, 90, 25)


def write(
    trace: TraceTable, path: str | os.PathLike[str], robot: _core.Robot, terrain: _core.Terrain | None = None
) -> None:
    """Write `trace`, of `robot`. The file appears whole or not at all."""
    times = np.rint(trace.time * 1e9).astype("timedelta64[ns]")
    poses = scene.poses(trace, robot)
    with written_whole(path) as beside:
        recording = rr.RecordingStream("crossgait")
        recording.save(beside)
        recording.send_recording_name(f"{robot.name} {trace.name}".strip())
        recording.log("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
        bodies = [rr.new_entity_path(["world", "robot", body]) for body in robot.bodies]
        for i, body in enumerate(bodies):
            rotation = scene.quaternions(poses[:, i, :3, :3])
            columns = rr.Transform3D.columns(translation=poses[:, i, :3, 3], quaternion=rotation)
            recording.send_columns(body, [_timeline(times)], columns)
        for i, shape in enumerate(scene.shapes(robot)):
            _log_shape(recording, f"{bodies[shape.body]}/shape_{i}", shape)
        ground = scene.ground(terrain, trace)
        if ground is not None:
            recording.log("world/ground", _mesh(ground), static=True)
        for leg, (rows, positions) in scene.footfalls(trace, robot, poses).items():
            _send_footfalls(recording, rr.new_entity_path(["world", "footfalls", leg]), times[rows], positions)
        for group, numbers in scene.columns(trace).items():
            for name, values in numbers.items():
                entity = rr.new_entity_path(["trace", group, name])
                recording.send_columns(entity, [_timeline(times)], rr.Scalars.columns(scalars=values))
        recording.disconnect()


def _timeline(times: Any) -> rr.TimeColumn:
    return rr.TimeColumn("time", duration=times)


def _send_footfalls(recording: rr.RecordingStream, entity: str, times: Any, positions: Any) -> None:
    """At every touch-down all so far, since an entity shows what it was sent last."""
    recording.log(entity, rr.Points3D.from_fields(radii=[_FOOTFALL_RADIUS], colors=[_FOOTFALL_COLOUR]), static=True)
    if len(times) == 0:
        return
    counts = range(1, len(times) + 1)
    so_far = np.concatenate([positions[:count] for count in counts])
    recording.send_columns(entity, [_timeline(times)], rr.Points3D.columns(positions=so_far).partition(counts))


def _mesh(ground: Ground) -> rr.Mesh3D:
    colours = np.rint(255 * ground.rgba).astype(np.uint8)
    return rr.Mesh3D(vertex_positions=ground.vertices, triangle_indices=ground.triangles, vertex_colors=colours)


def _log_shape(recording: rr.RecordingStream, entity: str, shape: Shape) -> None:
    rotation = rr.Quaternion(xyzw=scene.quaternions(shape.pose[:3, :3]))
    scale = shape.scale if shape.type == "mesh" else None
    transform = rr.Transform3D(translation=shape.pose[:3, 3], quaternion=rotation, scale=scale)
    recording.log(entity, transform, static=True)
    recording.log(entity, _archetype(shape), static=True)


def _archetype(shape: Shape) -> rr.AsComponents:
    """The shape about its own frame."""
    colours = [np.rint(255 * shape.rgba).astype(np.uint8)]
    solid = rr.components.FillMode.Solid
    radius, half_length = shape.size[0], shape.size[1]
    match shape.type:
        case "box":
            return rr.Boxes3D(half_sizes=[shape.size], colors=colours, fill_mode=solid)
        case "sphere":
            return rr.Ellipsoids3D(radii=[radius], colors=colours, fill_mode=solid)
        case "cylinder":
            return rr.Cylinders3D(lengths=[2 * half_length], radii=[radius], colors=colours, fill_mode=solid)
        case "capsule":
            # Rerun's begins at its frame's origin.
            begin = [[0, 0, -half_length]]
            return rr.Capsules3D(
                lengths=[2 * half_length], radii=[radius], translations=begin, colors=colours, fill_mode=solid
            )
        case "hull":
            return rr.Mesh3D(
                vertex_positions=shape.vertices, triangle_indices=shape.triangles(), albedo_factor=colours[0]
            )
        case "mesh":
            assert shape.mesh is not None  # by its type
            return rr.Asset3D(path=shape.mesh, media_type=MEDIA_TYPES[shape.mesh.suffix.lower()])
        case other:
            raise AssertionError(f"a shape of type {other}")
