"""Pictures of robots on their ground, whatever engine moves them: drawn by the `mujoco` package (`crossgait[render]`).

    >>> robot = crossgait.Robot.load("scara_quadruped")
    >>> Renderer(robot).frame(crossgait.World(robot, engine="bullet").state).shape
    (480, 640, 3)

Without a display set MUJOCO_GL to egl or osmesa before anything imports mujoco; if it is not set, this module sets egl.
"""

from __future__ import annotations

import os
import sys
import threading
import time
import warnings
import weakref
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
import numpy.typing as npt

from crossgait import _core


def _has_display() -> bool:
    return sys.platform != "linux" or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


if not _has_display():
    os.environ.setdefault("MUJOCO_GL", "egl")
try:
    import mujoco
except ImportError as error:
    raise ImportError("crossgait.viewing.rendering needs mujoco: pip install crossgait[render]") from error

Frame = npt.NDArray[np.uint8]

#: Side of the floor's squares and distance of the terrain's lines, m.
SQUARE = 0.1
#: Between two frames in a window, s.
_FRAME_TIME = 1 / 60

_PLAIN = (0.75, 0.75, 0.78, 1.0)
_GEOM_TYPES = {
    "sphere": mujoco.mjtGeom.mjGEOM_SPHERE,
    "box": mujoco.mjtGeom.mjGEOM_BOX,
    "cylinder": mujoco.mjtGeom.mjGEOM_CYLINDER,
    "capsule": mujoco.mjtGeom.mjGEOM_CAPSULE,
    "mesh": mujoco.mjtGeom.mjGEOM_MESH,
    "hull": mujoco.mjtGeom.mjGEOM_MESH,
}
# Colours of heights from the lowest to the highest: red, green, blue.
_LOWEST, _HIGHEST = np.array([58, 82, 74]), np.array([226, 214, 178])
_LARGEST_TEXTURE = 4096
_SUNSHINE = np.array([-0.4, 0.3, -1.0])


class Renderer:
    """Draws one robot on one ground. Not for two threads at once; `close` it, or use it as a context manager."""

    def __init__(
        self,
        robot: _core.Robot,
        terrain: _core.Terrain | None = None,
        *,
        width: int = 640,
        height: int = 480,
        azimuth: float = 130,
        elevation: float = -20,
    ) -> None:
        """Build the scene; a graphics context is made by the first `frame` or `show`.

        Args:
            robot: drawn by its visual shapes, or by its collision shapes where it has none or they cannot be read.
            terrain: coloured by height, with a line every .1 m; flat ground has squares of .1 m.
            width: of a frame, pixels.
            height: of a frame, pixels.
            azimuth: direction of the camera's look, deg: 90 is along the world's y.
            elevation: of the camera's look, deg.

        """
        self.robot = robot
        self.terrain = terrain if terrain is not None else _core.Terrain()
        self._size = (width, height)
        self._model = _scene(robot, self.terrain, width, height)
        self._data = mujoco.MjData(self._model)
        self._camera = mujoco.MjvCamera()
        self._camera.azimuth, self._camera.elevation = azimuth, elevation
        self._camera.distance = 4.5 * _reach(robot)
        self._offscreen: mujoco.Renderer | None = None
        self._window: Any = None
        self._shown = -1.0  # time of the state that the window shows, s
        self._started = 0.0  # on the clock, when the episode that it shows began, s

    def frame(self, state: _core.State) -> Frame:
        """Draw the robot in `state`: height x width x 3, the camera looking at its base.

        Raises RuntimeError where no graphics context can be made.
        """
        self._pose(state)
        if self._offscreen is None:
            self._offscreen = self._make_offscreen()
        self._offscreen.update_scene(self._data, self._camera)
        frame: Frame = self._offscreen.render()
        return frame.copy()

    def show(self, state: _core.State) -> bool:
        """Draw into a window, no faster than it happened. False once somebody has closed the window.

        Raises RuntimeError without a display.
        """
        if self._window is None:
            self._window = self._open_window(state)
        if not self._window.is_running():
            return False
        ahead = self._started + state.time - time.perf_counter()
        if state.time < self._shown or ahead < -1:  # another episode, or slower than it happens
            self._started = time.perf_counter() - state.time
            ahead = 0.0
        elif state.time - self._shown < _FRAME_TIME:
            return True
        if ahead > 0:
            time.sleep(ahead)
        self._shown = state.time
        with self._window.lock():
            self._pose(state)
            self._window.cam.lookat = self._camera.lookat
        self._window.sync()
        return True

    def close(self) -> None:
        """Close window and graphics context; drawing again makes others."""
        if self._offscreen is not None:
            self._offscreen.close()
        if self._window is not None:
            self._close_window()
        self._offscreen = self._window = None

    def __enter__(self) -> Renderer:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _pose(self, state: _core.State) -> None:
        for i, pose in enumerate(_core.body_poses(self.robot, state)):
            self._data.mocap_pos[i] = pose[:3, 3]
            mujoco.mju_mat2Quat(self._data.mocap_quat[i], pose[:3, :3].flatten())
        self._data.mocap_pos[-1] = state.p_WB  # the sun
        mujoco.mj_kinematics(self._model, self._data)
        mujoco.mj_camlight(self._model, self._data)
        self._camera.lookat = state.p_WB

    def _make_offscreen(self) -> mujoco.Renderer:
        try:
            return mujoco.Renderer(self._model, height=self._size[1], width=self._size[0])
        except Exception as error:
            chosen = os.environ.get("MUJOCO_GL") or "not set"
            raise RuntimeError(
                f"no graphics context could be made (MUJOCO_GL is {chosen}). Without a display set MUJOCO_GL=egl or "
                "MUJOCO_GL=osmesa before anything imports mujoco; Debian has them in libegl1 and libosmesa6"
            ) from error

    def _open_window(self, state: _core.State) -> Any:
        if not _has_display():
            raise RuntimeError(
                "a window needs a display, and neither DISPLAY nor WAYLAND_DISPLAY is set: "
                'render_mode="rgb_array" draws without one'
            )
        import mujoco.viewer

        self._pose(state)
        self._shown = -1.0
        others = set(threading.enumerate())
        window = mujoco.viewer.launch_passive(self._model, self._data, show_left_ui=False, show_right_ui=False)
        # Its thread must not outlive the interpreter, nor the model.
        threads = set(threading.enumerate()) - others
        self._close_window = weakref.finalize(self, _close_window, window, threads)
        window.cam.azimuth, window.cam.elevation = self._camera.azimuth, self._camera.elevation
        window.cam.distance = self._camera.distance
        return window


def _close_window(window: Any, threads: set[threading.Thread]) -> None:
    window.close()
    for thread in threads:
        thread.join(timeout=10)


class EnvironmentRenderer:
    """Draws environments of the core, all of one robot, each on the ground of its episode."""

    def __init__(self, width: int, height: int) -> None:
        self._size = (width, height)
        self._renderer: Renderer | None = None

    def frame(self, environment: _core.Environment | _core.EnvironmentView) -> Frame:
        """Draw into an array, height x width x 3."""
        return self._of(environment).frame(environment.state)

    def show(self, environment: _core.Environment) -> bool:
        """Draw into a window; False once somebody has closed it."""
        return self._of(environment).show(environment.state)

    def close(self) -> None:
        """Close what it opened."""
        if self._renderer is not None:
            self._renderer.close()
            self._renderer = None

    def _of(self, environment: _core.Environment | _core.EnvironmentView) -> Renderer:
        terrain = environment.terrain
        if self._renderer is None or not _same_ground(self._renderer.terrain, terrain):
            self.close()
            width, height = self._size
            self._renderer = Renderer(environment.robot, terrain, width=width, height=height)
        return self._renderer


def _same_ground(a: _core.Terrain, b: _core.Terrain) -> bool:
    """Whether it is one field; both are alive, so that no address is used twice."""
    if a.heights is None or b.heights is None:
        return a.heights is b.heights
    return a.heights.ctypes.data == b.heights.ctypes.data


def _reach(robot: _core.Robot) -> float:
    """Distance from the base's origin to that of the body farthest from it, in the home pose, m."""
    home = _core.State()
    home.q = robot.home
    return max(0.1, *(float(np.linalg.norm(pose[:3, 3])) for pose in _core.body_poses(robot, home)))


def _scene(robot: _core.Robot, terrain: _core.Terrain, width: int, height: int) -> mujoco.MjModel:
    spec = mujoco.MjSpec()
    spec.visual.global_.offwidth, spec.visual.global_.offheight = width, height
    spec.visual.quality.shadowsize = 2048
    # In extents. Shadows speckle the floor in a tighter clip.
    spec.stat.extent = 8 * _reach(robot)
    spec.visual.map.znear, spec.visual.map.zfar, spec.visual.map.shadowclip = 0.01, 9, 1.1
    spec.visual.headlight.ambient = [0.35, 0.35, 0.35]
    spec.visual.headlight.diffuse = [0.3, 0.3, 0.3]
    spec.visual.headlight.specular = [0.05, 0.05, 0.05]
    spec.visual.rgba.haze = [0.80, 0.87, 0.93, 1]
    spec.add_texture(
        name="sky",
        type=mujoco.mjtTexture.mjTEXTURE_SKYBOX,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_GRADIENT,
        rgb1=[0.42, 0.60, 0.80],
        rgb2=[0.80, 0.87, 0.93],
        width=256,
        height=1536,
    )
    picture = _add_ground(spec, terrain)
    _add_robot(spec, robot)
    _add_sun(spec, _reach(robot))
    model = spec.compile()
    if picture is not None:
        start = model.tex_adr[model.texture("ground").id]
        model.tex_data[start : start + picture.size] = picture.ravel()
    return model


def _add_sun(spec: mujoco.MjSpec, reach: float) -> None:
    """A light that casts shadows. It goes with the base: shadows are drawn about it alone."""
    sun = spec.worldbody.add_body(name="sun", mocap=True)
    sun.add_light(
        type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL,
        pos=-8 * reach * _SUNSHINE,
        dir=_SUNSHINE,
        diffuse=[0.75, 0.73, 0.68],
        specular=[0.2, 0.2, 0.2],
        castshadow=True,
    )


def _add_ground(spec: mujoco.MjSpec, terrain: _core.Terrain) -> Frame | None:
    """Returns the picture that the texture "ground" is to show."""
    if terrain.heights is None or terrain.size is None:
        _add_floor(spec)
        return None
    return _add_height_field(spec, terrain.heights, terrain.size)


def _add_floor(spec: mujoco.MjSpec) -> None:
    spec.add_texture(
        name="floor",
        type=mujoco.mjtTexture.mjTEXTURE_2D,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_CHECKER,
        rgb1=[0.63, 0.66, 0.69],
        rgb2=[0.54, 0.57, 0.60],
        width=256,
        height=256,
    )
    # Two squares along each side of the texture.
    repeats = 1 / (2 * SQUARE)
    floor = spec.add_material(name="floor", texuniform=True, texrepeat=[repeats, repeats])
    floor.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = "floor"
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0, 0, 1], material="floor")


def _add_height_field(spec: mujoco.MjSpec, heights: npt.NDArray[np.float32], size: tuple[float, float]) -> Frame:
    low, high = float(heights.min()), float(heights.max())
    rows, columns = heights.shape
    picture = _coloured(heights, size)
    spec.add_texture(
        name="ground",
        type=mujoco.mjtTexture.mjTEXTURE_2D,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_FLAT,  # until it is painted
        width=picture.shape[1],
        height=picture.shape[0],
        nchannel=3,
    )
    ground = spec.add_material(name="ground", specular=0.1)
    ground.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = "ground"
    spec.add_hfield(
        name="ground",
        nrow=rows,
        ncol=columns,
        size=[size[0] / 2, size[1] / 2, max(high - low, 1e-6), 0.05],
        userdata=(heights - low).flatten(),
    )
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_HFIELD, hfieldname="ground", material="ground", pos=[0, 0, low])
    return picture


def _coloured(heights: npt.NDArray[np.float32], size: tuple[float, float]) -> Frame:
    """A picture of the field from above, the largest y first: colours by height, and darker lines every `SQUARE`."""
    rows, columns = (min(_LARGEST_TEXTURE, max(512, round(length / SQUARE * 25))) for length in (size[1], size[0]))
    y, x = np.linspace(0, heights.shape[0] - 1, rows), np.linspace(0, heights.shape[1] - 1, columns)
    share = (heights - heights.min()) / max(float(np.ptp(heights)), 1e-9)
    shade = (255 * share).astype(np.uint8)[np.rint(y).astype(int)][:, np.rint(x).astype(int)]
    shades = _LOWEST + np.linspace(0, 1, 256)[:, None] * (_HIGHEST - _LOWEST)
    colours: Frame = np.stack((shades, 0.82 * shades)).astype(np.uint8)
    lines = _is_line(size[1], rows)[:, None] | _is_line(size[0], columns)
    picture: Frame = colours[lines.astype(np.uint8), shade][::-1]
    return picture


def _is_line(length: float, pixels: int) -> npt.NDArray[np.bool_]:
    """Which pixels of a row or column over `length` m, centred on the origin, are on a line."""
    place = np.linspace(-length / 2, length / 2, pixels)
    return np.abs(place - SQUARE * np.rint(place / SQUARE)) < max(0.003, length / pixels)


def _add_robot(spec: mujoco.MjSpec, robot: _core.Robot) -> None:
    bodies = [spec.worldbody.add_body(name=f"body {i}", mocap=True) for i in range(len(robot.bodies))]
    meshes: dict[tuple[str, tuple[float, ...]], str | None] = {}
    unseen = set(range(len(bodies)))
    for shape in robot.visuals:
        mesh = None
        if shape["type"] == "mesh":
            key = (shape["mesh"], tuple(shape["scale"]))
            if key not in meshes:
                meshes[key] = _add_mesh(spec, f"mesh {len(meshes)}", *key)
            mesh = meshes[key]
            if mesh is None:
                continue
        _add_shape(bodies[shape["body"]], shape, mesh, shape["rgba"])
        unseen.discard(shape["body"])
    for i, shape in enumerate(robot.collisions):
        if shape["body"] in unseen:
            mesh = _add_hull(spec, f"hull {i}", shape["vertices"]) if shape["type"] == "hull" else None
            _add_shape(bodies[shape["body"]], shape, mesh, None)


def _add_shape(
    body: mujoco.MjsBody, shape: dict[str, Any], mesh: str | None, rgba: npt.NDArray[np.float64] | None
) -> None:
    quaternion = np.empty(4)
    mujoco.mju_mat2Quat(quaternion, shape["pose"][:3, :3].flatten())
    geom = body.add_geom(
        type=_GEOM_TYPES[shape["type"]],
        pos=shape["pose"][:3, 3],
        quat=quaternion,
        rgba=_PLAIN if rgba is None else rgba,
        contype=0,
        conaffinity=0,
    )
    if mesh is not None:
        geom.meshname = mesh
    else:
        geom.size = shape["size"]


def _add_mesh(spec: mujoco.MjSpec, name: str, file: str, scale: tuple[float, ...]) -> str | None:
    """Its name, or None, with a warning, if MuJoCo cannot read the file (Collada, for one)."""
    settings = {
        "file": str(Path(file).absolute()),
        "scale": scale,
        "inertia": mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL,  # which needs no volume
    }
    probe = mujoco.MjSpec()
    try:
        probe.add_mesh(name=name, **settings)
        probe.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname=name, contype=0, conaffinity=0)
        probe.compile()
    except ValueError as error:
        words = str(error).splitlines()[0]
        warnings.warn(f"{file} cannot be drawn ({words}); collision shapes stand in for it", stacklevel=2)
        return None
    spec.add_mesh(name=name, **settings)
    return name


def _add_hull(spec: mujoco.MjSpec, name: str, vertices: npt.NDArray[np.float64]) -> str:
    """A mesh of points alone is drawn by their convex hull."""
    spec.add_mesh(name=name, uservert=vertices.flatten(), inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_CONVEX)
    return name
