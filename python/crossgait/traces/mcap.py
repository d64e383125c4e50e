"""Traces for Foxglove: MCAP files (`crossgait[mcap]`) with Foxglove's JSON schemas.

`/tf` has the poses of all bodies, `/robot` their shapes, `/ground` the ground, `/footfalls` where feet came down, and
each group of columns is a topic of its own: the plot of joint angle FL_tilt is `/q.FL_tilt`.
"""

from __future__ import annotations

import base64
import json
import os
from typing import Any

import numpy as np

try:
    from mcap.writer import Writer
except ImportError as error:
    raise ImportError("Trace.to_mcap needs mcap: pip install crossgait[mcap]") from error

from crossgait import _core
from crossgait.errors import ConfigError
from crossgait.files import read_bytes, written_whole
from crossgait.traces import scene
from crossgait.traces.scene import MEDIA_TYPES, Ground, Shape
from crossgait.traces.table import Numbers, TraceTable

Json = dict[str, Any]

_FOOTFALL_RADIUS = 0.006  # m
MOST_MESH = 32 << 20  #: bytes of a file, as the core reads
_FOOTFALL_COLOUR = np.array([0.9, 0.35, 0.1, 1.0])


def _object(**properties: Json) -> Json:
    return {"type": "object", "properties": properties}


def _array(items: Json) -> Json:
    return {"type": "array", "items": items}


# Those parts that are written of what Foxglove defines (docs.foxglove.dev, "Message schemas").
_NUMBER, _STRING = {"type": "number"}, {"type": "string"}
_TIME = _object(sec={"type": "integer"}, nsec={"type": "integer"})
_VECTOR = _object(x=_NUMBER, y=_NUMBER, z=_NUMBER)
_QUATERNION = _object(x=_NUMBER, y=_NUMBER, z=_NUMBER, w=_NUMBER)
_COLOUR = _object(r=_NUMBER, g=_NUMBER, b=_NUMBER, a=_NUMBER)
_POSE = _object(position=_VECTOR, orientation=_QUATERNION)
_SCHEMAS = {
    "foxglove.FrameTransforms": _object(
        transforms=_array(
            _object(
                timestamp=_TIME,
                parent_frame_id=_STRING,
                child_frame_id=_STRING,
                translation=_VECTOR,
                rotation=_QUATERNION,
            )
        )
    ),
    "foxglove.SceneUpdate": _object(
        deletions=_array(_object(timestamp=_TIME, type={"type": "integer"}, id=_STRING)),
        entities=_array(
            _object(
                timestamp=_TIME,
                frame_id=_STRING,
                id=_STRING,
                lifetime=_TIME,
                frame_locked={"type": "boolean"},
                metadata=_array(_object(key=_STRING, value=_STRING)),
                arrows=_array(_object()),
                lines=_array(_object()),
                texts=_array(_object()),
                cubes=_array(_object(pose=_POSE, size=_VECTOR, color=_COLOUR)),
                spheres=_array(_object(pose=_POSE, size=_VECTOR, color=_COLOUR)),
                cylinders=_array(
                    _object(pose=_POSE, size=_VECTOR, bottom_scale=_NUMBER, top_scale=_NUMBER, color=_COLOUR)
                ),
                triangles=_array(
                    _object(
                        pose=_POSE,
                        points=_array(_VECTOR),
                        color=_COLOUR,
                        colors=_array(_COLOUR),
                        indices=_array({"type": "integer"}),
                    )
                ),
                models=_array(
                    _object(
                        pose=_POSE,
                        scale=_VECTOR,
                        color=_COLOUR,
                        override_color={"type": "boolean"},
                        media_type=_STRING,
                        data={"type": "string", "contentEncoding": "base64"},
                    )
                ),
            )
        ),
    ),
}


_LONGEST = 9e9  #: s, of nanoseconds in 64 bits


def write(
    trace: TraceTable, path: str | os.PathLike[str], robot: _core.Robot, terrain: _core.Terrain | None = None
) -> None:
    """Write `trace`, of `robot`. The file appears whole or not at all."""
    if len(trace) and not 0 <= trace.time.min() <= trace.time.max() < _LONGEST:
        raise ConfigError(trace.name or "trace", "time", f"0 to {_LONGEST:g} s", f"up to {trace.time.max():g}")
    times = np.rint(trace.time * 1e9).astype(np.int64).tolist()  # ns
    poses = scene.poses(trace, robot)
    with written_whole(path) as beside, open(beside, "wb") as stream:
        file = _File(stream)
        _write_transforms(file.topic("/tf", "foxglove.FrameTransforms"), times, robot.bodies, poses)
        _write_shapes(file.topic("/robot", "foxglove.SceneUpdate"), times, robot)
        ground = scene.ground(terrain, trace)
        if ground is not None:
            _write_ground(file.topic("/ground", "foxglove.SceneUpdate"), times, ground)
        footfalls = scene.footfalls(trace, robot, poses)
        _write_footfalls(file.topic("/footfalls", "foxglove.SceneUpdate"), times, footfalls)
        for group, columns in scene.columns(trace).items():
            topic = file.topic(f"/{group}", f"crossgait.{group}", _object(**dict.fromkeys(columns, _NUMBER)))
            rows = np.stack(list(columns.values()), axis=1).tolist()
            for time, row in zip(times, rows, strict=True):
                topic.add(time, dict(zip(columns, row, strict=True)))
        file.writer.finish()  # type: ignore[no-untyped-call]


class _File:
    def __init__(self, stream: Any) -> None:
        self.writer = Writer(stream)
        self.writer.start(profile="", library="crossgait")
        self._schemas: dict[str, int] = {}

    def topic(self, name: str, schema: str, definition: Json | None = None) -> _Topic:
        if schema not in self._schemas:
            text = json.dumps({"title": schema, **(definition or _SCHEMAS[schema])})
            self._schemas[schema] = self.writer.register_schema(schema, "jsonschema", text.encode())
        return _Topic(self.writer, self.writer.register_channel(name, "json", self._schemas[schema]))


class _Topic:
    def __init__(self, writer: Writer, channel: int) -> None:
        self._writer, self._channel = writer, channel

    def add(self, time: int, message: Json) -> None:
        """At `time`, ns."""
        self._writer.add_message(self._channel, time, json.dumps(message).encode(), time)


def _write_transforms(topic: _Topic, times: list[int], bodies: list[str], poses: Numbers) -> None:
    translations = poses[..., :3, 3].tolist()
    rotations = scene.quaternions(poses[..., :3, :3]).tolist()
    for time, translation, rotation in zip(times, translations, rotations, strict=True):
        transforms = [
            {
                "timestamp": _time(time),
                "parent_frame_id": "world",
                "child_frame_id": body,
                "translation": dict(zip("xyz", p, strict=True)),
                "rotation": dict(zip("xyzw", q, strict=True)),
            }
            for body, p, q in zip(bodies, translation, rotation, strict=True)
        ]
        topic.add(time, {"transforms": transforms})


def _write_shapes(topic: _Topic, times: list[int], robot: _core.Robot) -> None:
    if not times:
        return
    entities = [_entity(times[0], body, body) for body in robot.bodies]
    for shape in scene.shapes(robot):
        for kind, primitive in _primitives(shape):
            entities[shape.body][kind].append(primitive)
    topic.add(times[0], {"deletions": [], "entities": entities})


def _write_ground(topic: _Topic, times: list[int], ground: Ground) -> None:
    entity = _entity(times[0], "world", "ground")
    surface = {
        "pose": _pose(np.eye(4)),
        "points": [_vector(vertex) for vertex in ground.vertices],
        "colors": [_colour(rgba) for rgba in ground.rgba],
        "indices": ground.triangles.ravel().tolist(),
    }
    entity["triangles"].append(surface)
    topic.add(times[0], {"deletions": [], "entities": [entity]})


def _write_footfalls(topic: _Topic, times: list[int], footfalls: dict[str, tuple[Any, Numbers]]) -> None:
    found = [
        (times[row], f"{leg} {number}", position)
        for leg, (rows, positions) in footfalls.items()
        for number, (row, position) in enumerate(zip(rows, positions, strict=True))
    ]
    for time, name, position in sorted(found, key=lambda footfall: footfall[0]):
        entity = _entity(time, "world", name)
        pose = np.eye(4)
        pose[:3, 3] = position
        size = np.full(3, 2 * _FOOTFALL_RADIUS)
        entity["spheres"].append({"pose": _pose(pose), "size": _vector(size), "color": _colour(_FOOTFALL_COLOUR)})
        topic.add(time, {"deletions": [], "entities": [entity]})


def _entity(time: int, frame: str, name: str) -> Json:
    kinds = ("metadata", "arrows", "lines", "texts", "cubes", "spheres", "cylinders", "triangles", "models")
    return {
        "timestamp": _time(time),
        "frame_id": frame,
        "id": name,
        "lifetime": _time(0),
        "frame_locked": True,
        **{kind: [] for kind in kinds},
    }


def _primitives(shape: Shape) -> list[tuple[str, Json]]:
    """Of Foxglove's kinds, whose sizes are whole ones. A capsule is a cylinder between two spheres."""
    common = {"pose": _pose(shape.pose), "color": _colour(shape.rgba)}
    radius, half_length = shape.size[0], shape.size[1]
    ball = {**common, "size": _vector(np.full(3, 2 * radius))}
    tube = {**common, "size": _vector(2 * np.array([radius, radius, half_length])), "bottom_scale": 1, "top_scale": 1}
    match shape.type:
        case "box":
            return [("cubes", {**common, "size": _vector(2 * shape.size)})]
        case "sphere":
            return [("spheres", ball)]
        case "cylinder":
            return [("cylinders", tube)]
        case "capsule":
            ends = [shape.pose.copy(), shape.pose.copy()]
            for end, side in zip(ends, (-1, 1), strict=True):
                end[:3, 3] += side * half_length * shape.pose[:3, 2]
            return [("cylinders", tube), *(("spheres", {**ball, "pose": _pose(end)}) for end in ends)]
        case "hull":
            points = [_vector(vertex) for vertex in shape.vertices]
            return [("triangles", {**common, "points": points, "indices": shape.triangles().ravel().tolist()})]
        case "mesh":
            assert shape.mesh is not None  # by its type
            model = {
                "scale": _vector(shape.scale),
                "override_color": False,
                "media_type": MEDIA_TYPES[shape.mesh.suffix.lower()],
                "data": base64.b64encode(read_bytes(shape.mesh, MOST_MESH)).decode(),
            }
            return [("models", {**common, **model})]
        case other:
            raise AssertionError(f"a shape of type {other}")


def _time(nanoseconds: int) -> Json:
    return {"sec": nanoseconds // 10**9, "nsec": nanoseconds % 10**9}


def _vector(values: Numbers) -> Json:
    return dict(zip("xyz", values.tolist(), strict=True))


def _colour(rgba: Numbers) -> Json:
    return dict(zip("rgba", rgba.tolist(), strict=True))


def _pose(pose: Numbers) -> Json:
    rotation = scene.quaternions(pose[:3, :3]).tolist()
    return {"position": _vector(pose[:3, 3]), "orientation": dict(zip("xyzw", rotation, strict=True))}
