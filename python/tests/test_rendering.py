from __future__ import annotations

import gc
import os
import re
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.wrappers import RecordVideo

import crossgait
import crossgait.envs
from crossgait import Robot, Terrain, World
from crossgait.sb3 import CrossgaitVecEnv
from crossgait.viewing.mujoco_scene import SQUARE, mujoco
from crossgait.viewing.rendering import Renderer

GAIT, JOINTS = "Crossgait/AdaptiveGait-v0", "Crossgait/JointControl-v0"
SMALL = {"width": 80, "height": 60}  # frames are drawn by the processor where tests run


def assert_same_frames(a: np.ndarray, b: np.ndarray) -> None:
    # Mesa's processor threads round a pixel now and then to the next of 256 levels.
    np.testing.assert_allclose(a.astype(int), b.astype(int), atol=2)


@pytest.mark.parametrize("env_id", [GAIT, JOINTS])
def test_gymnasium_checks_pass_with_rendering(env_id: str, monkeypatch: pytest.MonkeyPatch) -> None:
    # "human" needs a display, and has a test of its own.
    monkeypatch.setitem(crossgait.envs.QuadrupedEnv.metadata, "render_modes", ["rgb_array"])
    env = gymnasium.make(env_id, render_mode="rgb_array", terrain="rough", **SMALL)
    check_env(env.unwrapped)
    env.close()


@pytest.mark.parametrize("name", crossgait.robots())
@pytest.mark.parametrize("terrain", ["flat", "rough"])
def test_every_robot_is_seen_in_the_middle_of_its_ground(name: str, terrain: str) -> None:
    robot, ground = Robot.load(name), Terrain(terrain)
    state = World(robot, ground).state
    with Renderer(robot, ground, width=160, height=120) as renderer:
        frame = renderer.frame(state)
        assert (frame.shape, frame.dtype) == ((120, 160, 3), np.uint8)
        assert_same_frames(renderer.frame(state), frame)
        state.p_WB += [0, 0, 1]
        without = renderer.frame(state)  # the camera goes along, and the ground is out of its sight
        assert np.abs(frame.astype(int) - without).mean() > 5
        assert without[60, 80].max() < 255  # the robot, not the sky's lightest
        assert frame[:10].mean(axis=(0, 1))[2] > frame[:10].mean(axis=(0, 1))[0]  # blue sky


def test_shapes_stand_where_the_kinematics_say() -> None:
    for name in crossgait.robots():
        robot = Robot.load(name)
        state = World(robot).state
        state.p_WB = np.array([1.0, -2, 3])
        state.q_WB = np.array([0.5, 0.5, -0.5, 0.5])
        renderer = Renderer(robot)
        renderer._pose(state)
        poses = crossgait.body_poses(robot, state)
        expected = [poses[shape["body"]] @ shape["pose"] for shape in robot.visuals]
        drawn = renderer._data.geom_xpos[1:]  # after the ground
        assert len(drawn) == len(expected)
        for pose in expected:  # MuJoCo orders geoms by bodies; quaternions round
            assert np.abs(drawn - pose[:3, 3]).max(axis=1).min() < 1e-12


def test_heights_are_coloured_where_they_are() -> None:
    """A hill in one quarter, seen from above: light there alone; x to the right, y up."""
    heights = np.zeros((41, 61), np.float32)
    heights[25:, 35:] = 0.05
    robot = Robot.load("scara_quadruped")
    state = World(robot).state
    state.p_WB = np.array([0, 0, 0.2])
    with Renderer(
        robot, Terrain.from_heights(heights, size_x=3, size_y=2), width=120, height=120, azimuth=90, elevation=-89.9
    ) as renderer:
        frame = renderer.frame(state).astype(float).mean(axis=2)
    corner = 25
    top_left, top_right = frame[:corner, :corner].mean(), frame[:corner, -corner:].mean()
    bottom_left, bottom_right = frame[-corner:, :corner].mean(), frame[-corner:, -corner:].mean()
    assert top_right > 1.3 * max(top_left, bottom_left, bottom_right)


def test_a_terrain_has_lines_every_square() -> None:
    from crossgait.viewing.mujoco_scene import _is_line

    lines = _is_line(2.0, 4001)  # half a millimetre a pixel
    middles = np.flatnonzero(np.diff(lines.astype(int)) == 1)[1:] + np.flatnonzero(np.diff(lines.astype(int)) == -1)[1:]
    assert np.diff(middles / 2) * 2.0 / 4000 == pytest.approx(SQUARE, abs=1e-3)  # a pixel or two


def test_frames_are_of_the_state_and_not_of_the_engine(engine: str) -> None:
    world = World(Robot.load("scara_quadruped"), engine=engine)
    reference = World(Robot.load("scara_quadruped"))
    with Renderer(Robot.load("scara_quadruped"), **SMALL) as renderer:
        assert_same_frames(renderer.frame(world.state), renderer.frame(reference.state))


def test_collision_shapes_are_drawn_where_there_is_nothing_else(tmp_path: Path) -> None:
    """Of bodies without visual shapes, and of those whose meshes cannot be read; hulls too."""
    source = Path(crossgait.models_dir()) / "robots" / "serial_quadruped"
    text = (source / "robot.urdf").read_text()
    assert "<visual>" in text
    bare = text
    while "<visual>" in bare:
        bare = bare[: bare.index("<visual>")] + bare[bare.index("</visual>") + len("</visual>") :]
    (tmp_path / "robot.urdf").write_text(bare)
    robot = Robot.load(str(tmp_path / "robot.urdf"))
    assert not robot.visuals
    renderer = Renderer(robot)
    hips_and_shins = 8  # of which there are balls for feet, or nothing: sticks
    assert renderer._model.ngeom == 1 + len(robot.collisions) + hips_and_shins


def test_links_without_shapes_are_sticks(tmp_path: Path) -> None:
    """Of a robot that has balls for feet and nothing else: each link from its joint to the next, or to its foot."""
    source = Path(crossgait.models_dir()) / "robots" / "serial_quadruped"
    text = re.sub(r"<visual>.*?</visual>", "", (source / "robot.urdf").read_text(), flags=re.DOTALL)
    text = re.sub(
        r"<collision(?: [^>]*)?>(?:(?!</collision>).)*<(?:box|cylinder).*?</collision>", "", text, flags=re.DOTALL
    )
    (tmp_path / "robot.urdf").write_text(text)
    robot = Robot.load(tmp_path / "robot.urdf")
    assert {shape["type"] for shape in robot.collisions} == {"sphere"}
    renderer = Renderer(robot)
    state = World(robot).state
    renderer._pose(state)
    poses = crossgait.body_poses(robot, state)
    model, data = renderer._model, renderer._data
    sticks = [i for i in range(model.ngeom) if model.geom_type[i] == mujoco.mjtGeom.mjGEOM_CAPSULE]
    ends = [
        data.geom_xpos[i] + end * model.geom_size[i, 1] * data.geom_xmat[i][2::3] for i in sticks for end in (-1, 1)
    ]
    for body, parent in enumerate(robot.parents):
        for place in [poses[body][:3, 3]] if parent >= 0 else []:
            assert min(np.linalg.norm(end - place) for end in ends) < 1e-6  # MuJoCo's rotations of fromto round
    for shape in robot.collisions:
        foot = (poses[shape["body"]] @ shape["pose"])[:3, 3]
        assert min(np.linalg.norm(end - foot) for end in ends) < 1e-6


def test_a_camera_stands_where_it_is_told() -> None:
    robot = Robot.load("scara_quadruped")
    state = World(robot).state
    away = crossgait.State()
    away.q, away.p_WB = robot.home, np.array([50.0, 0, 0.06])
    with Renderer(robot, azimuth=90, elevation=-30, distance=2, look_at=(0, 0, 0.1), **SMALL) as still:
        beside = still.frame(state)
        empty = still.frame(away)  # the robot has left, and the camera has not gone with it
        assert np.abs(beside.astype(int) - empty).mean() > 0.5
        depth = still.depth(away)
        assert (depth.shape, depth.dtype) == ((60, 80), np.float32)
        # A plane 1.1 m below the camera, looked down at by 30 degrees: 1.1 / sin 30 in the middle of the picture,
        # of which a pixel is 1 / 60 of a picture 45 degrees high.
        assert depth[30, 40] == pytest.approx(1.1 / np.sin(np.radians(30)), rel=0.03)
        assert still.depth(state)[30, 40] < depth[30, 40]
        assert_same_frames(still.frame(state), beside)  # and pictures again
    for wrong in ({"distance": 0}, {"distance": np.inf}, {"look_at": (0, 0)}, {"look_at": (0, 0, np.nan)}):
        with pytest.raises(crossgait.ConfigError, match=f"camera: {next(iter(wrong))}: expected"):
            Renderer(robot, **wrong)


def test_environments_take_a_camera() -> None:
    camera = {"azimuth": 90, "elevation": -10, "distance": 1.0}
    env = gymnasium.make(GAIT, render_mode="depth_array", camera=camera, **SMALL)
    env.reset(seed=0)
    depth = env.render()
    assert (depth.shape, depth.dtype) == ((60, 80), np.float32)
    assert depth[30, 40] == pytest.approx(1, abs=0.15)  # the robot is 0.2 m wide
    env.close()
    with pytest.raises(crossgait.ConfigError, match="camera: expected keys of azimuth, elevation, distance, look_at"):
        gymnasium.make(GAIT, camera={"zoom": 2})
    many = crossgait.envs.AdaptiveGaitVectorEnv(2, render_mode="depth_array", camera=camera, **SMALL)
    many.reset(seed=0)
    frames = many.render()
    assert frames is not None
    assert [frame.shape for frame in frames] == [(60, 80)] * 2
    many.close()


def test_a_mesh_that_cannot_be_read_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from crossgait.viewing import mujoco_scene

    scara, poses = Robot.load("scara_quadruped"), crossgait.body_poses
    monkeypatch.setattr(mujoco_scene._core, "body_poses", lambda _, state: poses(scara, state))

    class Unreadable:
        """The bundled robot with a Collada mesh for its trunk."""

        def __init__(self) -> None:
            robot = Robot.load("scara_quadruped")
            self.bodies, self.collisions, self.parents, self.home = (
                robot.bodies,
                robot.collisions,
                robot.parents,
                robot.home,
            )
            mesh = {"type": "mesh", "mesh": str(tmp_path / "trunk.dae"), "scale": np.ones(3)}
            self.visuals = [shape for shape in robot.visuals if shape["body"] != 0] + [
                robot.visuals[0] | mesh,
            ]

    (tmp_path / "trunk.dae").write_text("<COLLADA/>")
    spec = mujoco_scene.mujoco.MjSpec()
    with pytest.warns(UserWarning, match=r"trunk\.dae cannot be drawn .* collision shapes stand in"):
        mujoco_scene._add_robot(spec, Unreadable())  # type: ignore[arg-type]
    trunk = spec.compile().body("body 0")
    balls = sum(shape["body"] == 0 for shape in scara.collisions)
    assert trunk.geomnum[0] == balls + balls + scara.parents.count(0)  # with a stick to each, and to each leg

    # Beside what can be drawn, too, and without a word where there is no file.
    mixed = Unreadable()
    mixed.visuals[-1]["mesh"] = ""
    mixed.visuals.append(scara.visuals[0] | {"type": "box", "size": np.full(3, 5e-4)})
    spec = mujoco_scene.mujoco.MjSpec()
    mujoco_scene._add_robot(spec, mixed)  # type: ignore[arg-type]
    assert spec.compile().body("body 0").geomnum[0] == 1 + balls


#: Of a wedge with these corners; MuJoCo reads the one, the core the other.
CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
WEDGES = {
    "wedge.obj": "".join(f"v {x} {y} {z}\n" for x, y, z in CORNERS) + "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n",
    "wedge.dae": '<COLLADA version="1.4.1"><asset><up_axis>Z_UP</up_axis></asset><library_geometries><geometry id="g">'
    f'<mesh><source id="p"><float_array>{" ".join(map(str, CORNERS.flatten()))}</float_array><technique_common>'
    '<accessor source="#pa" count="4" stride="3"/></technique_common></source><vertices id="v"><input '
    'semantic="POSITION" source="#p"/></vertices><triangles count="4"><input semantic="VERTEX" source="#v" '
    'offset="0"/><p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles></mesh></geometry></library_geometries></COLLADA>',
}


@pytest.mark.parametrize("written", WEDGES)
def test_meshes_and_hulls_are_drawn(written: str, tmp_path: Path) -> None:
    from crossgait.viewing import mujoco_scene

    file, corners = tmp_path / written, CORNERS
    file.write_text(WEDGES[written])
    spec = mujoco_scene.mujoco.MjSpec()
    body = spec.worldbody.add_body(name="body")
    pose = np.eye(4)
    pose[:3, 3] = [5, 6, 7]
    mesh = mujoco_scene._add_mesh(spec, "mesh", str(file), (0.1, 0.2, 0.3))
    hull = mujoco_scene._add_hull(spec, "hull", corners)
    for name, kind in ((mesh, "mesh"), (hull, "hull")):
        mujoco_scene._add_shape(body, {"type": kind, "pose": pose, "size": np.zeros(3)}, name, None)
    model = spec.compile()
    data = mujoco_scene.mujoco.MjData(model)
    mujoco_scene.mujoco.mj_kinematics(model, data)
    for geom, scale in ((0, (0.1, 0.2, 0.3)), (1, (1, 1, 1))):
        start = model.mesh_vertadr[model.geom_dataid[geom]]
        count = model.mesh_vertnum[model.geom_dataid[geom]]
        vertices = model.mesh_vert[start : start + count] @ data.geom_xmat[geom].reshape(3, 3).T
        lowest = (vertices + data.geom_xpos[geom]).min(axis=0)
        highest = (vertices + data.geom_xpos[geom]).max(axis=0)
        assert lowest == pytest.approx([5, 6, 7], abs=1e-5)  # MuJoCo keeps vertices as float32
        assert highest == pytest.approx(np.array([5, 6, 7]) + scale, abs=1e-5)


# Pipes to ffmpeg, which the libraries that write and read the file leave to the collector.
@pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning")
def test_videos_can_be_recorded(tmp_path: Path) -> None:
    env: Any = gymnasium.make(JOINTS, render_mode="rgb_array", episode_seconds=0.1, **SMALL)
    assert env.metadata["render_fps"] == 50
    folder = tmp_path / "videos"
    env = RecordVideo(env, str(folder), episode_trigger=lambda _: True, disable_logger=True)
    env.reset(seed=0)
    for _ in range(5):
        env.step(np.zeros(12, np.float32))
    env.close()
    (video,) = folder.glob("*.mp4")
    import imageio.v3 as imageio

    frames = imageio.imread(video)
    assert frames.shape[1:] == (60, 80, 3)
    assert len(frames) == 6
    assert frames.std() > 10
    gc.collect()  # here, not in another test


def test_nothing_is_made_before_the_first_frame() -> None:
    env = crossgait.envs.AdaptiveGaitEnv(render_mode="rgb_array", **SMALL)
    env.reset(seed=0)
    env.step(np.zeros(16))
    assert env._renderer is None
    assert env.render() is not None
    env.close()
    assert env._renderer is None
    assert env.render() is not None  # and again after close
    env.close()


def test_drawing_changes_no_bit(engine: str) -> None:
    drawn = crossgait.envs.AdaptiveGaitEnv(engine=engine, render_mode="rgb_array", **SMALL)
    plain = crossgait.envs.AdaptiveGaitEnv(engine=engine)
    assert drawn.reset(seed=0)[0].tobytes() == plain.reset(seed=0)[0].tobytes()
    for _ in range(3):
        drawn.render()
        assert drawn.step(np.zeros(16))[0].tobytes() == plain.step(np.zeros(16))[0].tobytes()
    drawn.close()


def test_rendering_without_a_mode_is_told() -> None:
    env = crossgait.envs.AdaptiveGaitEnv()
    env.reset(seed=0)
    with pytest.warns(UserWarning, match="render_mode"):
        assert env.render() is None


def test_another_episodes_terrain_is_drawn() -> None:
    env = crossgait.envs.AdaptiveGaitEnv(
        terrain="rough", randomisation={"terrain_seed": [0, 1e6]}, render_mode="rgb_array", **SMALL
    )
    frames = []
    for seed in (0, 1, 0):
        env.reset(seed=seed)
        frames.append(env.render())
    assert_same_frames(frames[0], frames[2])
    assert np.abs(frames[0].astype(int) - frames[1]).mean() > 1
    env.close()


def test_vector_environments_render_each() -> None:
    envs = crossgait.envs.AdaptiveGaitVectorEnv(
        2, render_mode="rgb_array", randomisation={"start_yaw": [-3, 3]}, **SMALL
    )
    envs.reset(seed=0)
    frames = envs.render()
    assert frames is not None
    assert [frame.shape for frame in frames] == [(60, 80, 3)] * 2
    assert not np.array_equal(*frames)
    envs.close()
    assert crossgait.envs.AdaptiveGaitVectorEnv(2).render() is None


def test_stable_baselines_tiles_the_frames() -> None:
    envs = CrossgaitVecEnv(GAIT, 2, render_mode="rgb_array", **SMALL)
    envs.reset()
    tiled = envs.render()
    assert tiled is not None
    assert tiled.shape in {(120, 80, 3), (60, 160, 3)}
    envs.close()


def test_a_window_without_a_display_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    env = crossgait.envs.AdaptiveGaitEnv(render_mode="human")
    with pytest.raises(RuntimeError, match="a window needs a display"):
        env.reset(seed=0)


@pytest.mark.skipif(not os.environ.get("DISPLAY"), reason="no display")
def test_a_window_shows_an_episode() -> None:
    env = crossgait.envs.AdaptiveGaitEnv(render_mode="human", policy_dt=0.02)
    env.reset(seed=0)
    for _ in range(5):
        env.step(np.zeros(16))
    assert env._renderer is not None
    env.close()
