"""Traces in the formats of viewers, read back with the formats' own readers."""

from __future__ import annotations

import base64
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.reader import make_reader
from rerun.chunk import RrdReader

import crossgait
from crossgait.traces import mcap as trace_mcap
from crossgait.traces import rerun as trace_rerun
from crossgait.traces import scene as trace_scene

ROBOT = "scara_quadruped"


@pytest.fixture(scope="module")
def trace() -> crossgait.Trace:
    walked = crossgait.walk("trot", robot=ROBOT, seconds=1, trace=True).trace
    assert walked is not None
    return walked


@pytest.fixture(scope="module")
def poses(trace: crossgait.Trace) -> Any:
    """Of all bodies, by the core's kinematics, rows x bodies x 4 x 4."""
    robot, state, rows = crossgait.Robot.load(ROBOT), crossgait.State(), []
    for row in range(len(trace)):
        state.p_WB = np.array([trace[f"p_WB.{axis}"][row] for axis in "xyz"])
        state.q_WB = np.array([trace[f"q_WB.{axis}"][row] for axis in "wxyz"])
        state.q = np.array([trace[f"q.{joint}"][row] for joint in robot.joints])
        rows.append(crossgait.body_poses(robot, state))
    return np.array(rows)


def rotation(x: float, y: float, z: float, w: float) -> Any:
    """The matrix of a unit quaternion, by Rodrigues' formula."""
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + 2 * w * cross + 2 * cross @ cross


def messages(path: Path) -> dict[str, list[tuple[int, Any]]]:
    """By topic, in the order of the file: (log time in ns, message)."""
    topics: dict[str, list[tuple[int, Any]]] = {}
    with open(path, "rb") as file:
        for schema, channel, message in make_reader(file, validate_crcs=True).iter_messages():
            assert schema is not None
            assert (schema.encoding, channel.message_encoding) == ("jsonschema", "json")
            properties = json.loads(schema.data)["properties"]
            content = json.loads(message.data)
            assert content.keys() == properties.keys()
            topics.setdefault(channel.topic, []).append((message.log_time, content))
    return topics


def chunks(path: Path) -> dict[str, list[Any]]:
    """By entity, as tables of Arrow; static ones among them."""
    entities: dict[str, list[Any]] = {}
    for chunk in RrdReader(path).stream():
        entities.setdefault(chunk.entity_path, []).append(chunk.to_record_batch())
    return entities


def column(entities: dict[str, list[Any]], entity: str, name: str) -> tuple[Any, Any]:
    """Times in ns and values of a component in time."""
    tables = [table for table in entities[entity] if name in table.schema.names and "time" in table.schema.names]
    times = np.concatenate([np.asarray(table.column("time").cast("int64")) for table in tables])
    values = [value for table in tables for value in table.column(name).to_pylist()]
    order = np.argsort(times, kind="stable")
    return times[order], [values[i] for i in order]


@pytest.fixture(scope="module")
def mcap(trace: crossgait.Trace, tmp_path_factory: pytest.TempPathFactory) -> dict[str, list[tuple[int, Any]]]:
    path = tmp_path_factory.mktemp("mcap") / "walk.mcap"
    trace.to_mcap(path, robot=ROBOT)
    return messages(path)


@pytest.fixture(scope="module")
def rrd(trace: crossgait.Trace, tmp_path_factory: pytest.TempPathFactory) -> dict[str, list[Any]]:
    path = tmp_path_factory.mktemp("rerun") / "walk.rrd"
    trace.to_rerun(path, robot=crossgait.Robot.load(ROBOT))
    return chunks(path)


def test_mcap_has_every_column_to_the_last_bit(trace: crossgait.Trace, mcap: Any) -> None:
    for name in trace.names[1:]:
        group, _, key = name.partition(".")
        times, values = zip(*mcap[f"/{group}"], strict=True)
        assert np.array_equal(times, np.rint(trace.time * 1e9))
        assert np.array_equal([value[key] for value in values], trace[name])


def test_mcap_has_the_pose_of_every_body(poses: Any, mcap: Any) -> None:
    bodies = crossgait.Robot.load(ROBOT).bodies
    assert len(mcap["/tf"]) == len(poses)
    for row in range(0, len(poses), 50):
        time, message = mcap["/tf"][row]
        assert [t["child_frame_id"] for t in message["transforms"]] == bodies
        for transform, pose in zip(message["transforms"], poses[row], strict=True):
            assert transform["parent_frame_id"] == "world"
            assert transform["timestamp"] == {"sec": time // 10**9, "nsec": time % 10**9}
            assert np.array_equal(list(transform["translation"].values()), pose[:3, 3])
            # Quaternions are found to rounding.
            assert np.allclose(rotation(**transform["rotation"]), pose[:3, :3], rtol=0, atol=1e-14)


def test_mcap_has_the_shapes_of_every_body(mcap: Any) -> None:
    robot = crossgait.Robot.load(ROBOT)
    [(_, scene)] = mcap["/robot"]
    assert [entity["frame_id"] for entity in scene["entities"]] == robot.bodies
    boxes = [visual for visual in robot.visuals if visual["type"] == "box" and visual["body"] == 0]
    cubes = scene["entities"][0]["cubes"]
    assert len(cubes) == len(boxes) > 0
    for cube, box in zip(cubes, boxes, strict=True):
        assert np.allclose(list(cube["size"].values()), 2 * box["size"], rtol=1e-15)
        assert np.array_equal(list(cube["pose"]["position"].values()), box["pose"][:3, 3])
        assert np.array_equal(list(cube["color"].values()), box["rgba"])


def test_feet_come_down_on_flat_ground(trace: crossgait.Trace, mcap: Any, rrd: Any) -> None:
    feet = {
        body["body"]: body["size"][0] for body in crossgait.Robot.load(ROBOT).collisions if body["type"] == "sphere"
    }
    radius = list(feet.values())[-1]
    footfalls = [(time, entity) for time, message in mcap["/footfalls"] for entity in message["entities"]]
    for leg in ("FL", "FR", "RL", "RR"):
        touching = trace[f"contact.{leg}"]
        expected = np.flatnonzero(np.diff(touching, prepend=0) > 0)
        assert len(expected) >= 3
        mine = [(t, e["spheres"][0]["pose"]["position"]) for t, e in footfalls if e["id"].startswith(leg)]
        assert np.array_equal([t for t, _ in mine], np.rint(trace.time[expected] * 1e9))
        # The ground gives way by a millimetre or two under a foot that has just met it.
        assert np.allclose([p["z"] for _, p in mine], radius, rtol=0, atol=2.5e-3)
        times, points = column(rrd, f"/world/footfalls/{leg}", "Points3D:positions")
        assert np.array_equal(times, [t for t, _ in mine])
        assert [len(so_far) for so_far in points] == list(range(1, len(mine) + 1))
        # Rerun keeps positions in single precision.
        assert np.allclose(points[-1], [list(p.values()) for _, p in mine], rtol=0, atol=1e-7)


def test_the_ground_is_where_the_walk_met_it(trace: crossgait.Trace, tmp_path: Path) -> None:
    terrain = crossgait.Terrain("rough", seed=3)
    ground = trace_scene.ground(terrain, trace)
    assert ground is not None
    x, y, z = ground.vertices.T
    # Samples of the field are in single precision.
    assert np.allclose(terrain.height(x, y), z, rtol=0, atol=1e-7)
    for name, values in (("x", x), ("y", y)):
        way = trace[f"p_WB.{name}"]
        spacing = np.diff(np.unique(values)).max()
        assert way.min() - values.min() == pytest.approx(trace_scene.MARGIN, abs=spacing)
        assert values.max() - way.max() == pytest.approx(trace_scene.MARGIN, abs=spacing)
    a, b, c = (ground.vertices[ground.triangles[:, i]] for i in range(3))
    upwards = np.cross(b - a, c - a)[:, 2] / 2
    # Seen from above they cover the rectangle once.
    assert np.all(upwards > 0)
    assert np.sum(upwards) == pytest.approx(np.ptp(x) * np.ptp(y))

    trace.to_mcap(tmp_path / "walk.mcap", ROBOT, terrain)
    [(_, scene)] = messages(tmp_path / "walk.mcap")["/ground"]
    [surface] = scene["entities"][0]["triangles"]
    assert np.array_equal([list(point.values()) for point in surface["points"]], ground.vertices)
    assert surface["indices"] == ground.triangles.ravel().tolist()
    trace.to_rerun(tmp_path / "walk.rrd", ROBOT, terrain)
    [mesh] = chunks(tmp_path / "walk.rrd")["/world/ground"]
    positions = mesh.column("Mesh3D:vertex_positions").to_pylist()[0]
    # Rerun keeps them in single precision; they lie within 2 m of the origin.
    assert np.allclose(positions, ground.vertices, rtol=0, atol=2e-7)
    assert trace_scene.ground(crossgait.Terrain("flat"), trace) is None


def test_rerun_has_every_column_to_the_last_bit(trace: crossgait.Trace, rrd: Any) -> None:
    for name in trace.names[1:]:
        group, _, key = name.partition(".")
        times, values = column(rrd, f"/trace/{group}/{key or 'value'}", "Scalars:scalars")
        assert np.array_equal(times, np.rint(trace.time * 1e9))
        assert np.array_equal(np.ravel(values), trace[name])


def test_rerun_has_the_pose_and_the_shapes_of_every_body(poses: Any, rrd: Any) -> None:
    robot = crossgait.Robot.load(ROBOT)
    for i, body in enumerate(robot.bodies):
        _, translations = column(rrd, f"/world/robot/{body}", "Transform3D:translation")
        _, quaternions = column(rrd, f"/world/robot/{body}", "Transform3D:quaternion")
        # Rerun keeps them in single precision; the walk stays within a metre of the origin.
        assert np.allclose(np.reshape(translations, (-1, 3)), poses[:, i, :3, 3], rtol=0, atol=1e-7)
        for row in range(0, len(poses), 50):
            assert np.allclose(rotation(*np.ravel(quaternions[row])), poses[row, i, :3, :3], rtol=0, atol=1e-6)
    for number, visual in enumerate(robot.visuals):
        shape = rrd[f"/world/robot/{robot.bodies[visual['body']]}/shape_{number}"]
        found = {name: table.column(name).to_pylist()[0] for table in shape for name in table.schema.names}
        assert np.allclose(found["Transform3D:translation"][0], visual["pose"][:3, 3], rtol=0, atol=1e-7)
        if visual["type"] == "box":
            assert np.allclose(found["Boxes3D:half_sizes"][0], visual["size"], rtol=1e-6)


def test_quaternions_of_half_turns_and_no_turn() -> None:
    # Where formulae that divide by a component break down.
    for quaternion in ([1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1], [0.6, 0.8, 0, 0], [0.5, 0.5, 0.5, 0.5]):
        found = trace_scene.quaternions(rotation(*quaternion))
        assert abs(abs(found @ quaternion) - 1) < 1e-15


def test_a_hull_is_closed_by_its_triangles() -> None:
    corners = np.array([[0, 0, 0], [2, 0, 0], [0, 3, 0], [0, 0, 4]], dtype=float)
    hull = trace_scene.Shape(0, "hull", np.zeros(3), np.eye(4), np.ones(4), None, np.ones(3), corners)
    a, b, c = (corners[hull.triangles()[:, i]] for i in range(3))
    # The divergence theorem: faces that look outwards enclose the tetrahedron's volume.
    assert len(a) == 4
    assert np.sum(a * np.cross(b, c)) / 6 == pytest.approx(4, rel=1e-14)


def test_meshes_are_carried_and_capsules_have_round_ends(tmp_path: Path) -> None:
    mesh = tmp_path / "part.stl"
    mesh.write_bytes(b"solid part\nendsolid part\n")
    size, pose, rgba = np.array([0.1, 0.3, 0]), np.eye(4), np.ones(4)
    pose[:3, 3] = [1, 2, 3]
    part = trace_scene.Shape(0, "mesh", np.zeros(3), pose, rgba, mesh, np.full(3, 2.0), np.empty((0, 3)))
    [(kind, model)] = trace_mcap._primitives(part)
    assert (kind, model["media_type"], model["scale"]) == ("models", "model/stl", {"x": 2, "y": 2, "z": 2})
    assert base64.b64decode(model["data"]) == mesh.read_bytes()
    capsule = trace_scene.Shape(0, "capsule", size, pose, rgba, None, np.ones(3), np.empty((0, 3)))
    primitives = trace_mcap._primitives(capsule)
    assert [kind for kind, _ in primitives] == ["cylinders", "spheres", "spheres"]
    assert primitives[0][1]["size"] == {"x": 0.2, "y": 0.2, "z": 0.6}
    assert [ball["pose"]["position"]["z"] for _, ball in primitives[1:]] == pytest.approx([2.7, 3.3])
    for shape in (part, capsule):
        trace_rerun._archetype(shape)


@pytest.mark.parametrize("export", ["to_mcap", "to_rerun"])
def test_another_robot_is_refused_and_leaves_nothing(trace: crossgait.Trace, export: str, tmp_path: Path) -> None:
    with pytest.raises(crossgait.ConfigError, match="the robot that walked, with joints FL_tilt"):
        getattr(trace, export)(tmp_path / "walk", robot="serial_quadruped")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(("column", "number"), [("q_WB.w", 0.0), ("q_WB.w", 1e300), ("time", 1e300)])
def test_attitudes_and_times_that_are_none_are_refused(
    trace: crossgait.Trace, column: str, number: float, tmp_path: Path
) -> None:
    wrong = crossgait.Trace(trace.names, trace.values.copy())
    wrong[column][-1] = number
    with pytest.raises(crossgait.ConfigError, match=r"unit quaternions|time: expected 0 to 9e\+09 s"):
        wrong.to_mcap(tmp_path / "walk.mcap", ROBOT)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("export", ["to_mcap", "to_rerun", "to_csv"])
def test_what_goes_wrong_keeps_the_file_that_was_there(
    trace: crossgait.Trace, export: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "walk"
    path.write_text("before")
    values = trace.values
    broken = crossgait.Trace([*trace.names, "odd"], np.column_stack([values, values[:, 0]]))
    monkeypatch.setattr(broken, "names", [*trace.names, "no such column"])
    monkeypatch.setattr(broken, "values", None if export == "to_csv" else broken.values)
    with pytest.raises((crossgait.ConfigError, TypeError)):
        getattr(broken, export)(path, **({} if export == "to_csv" else {"robot": ROBOT}))
    assert path.read_text() == "before"
    assert list(tmp_path.iterdir()) == [path]
