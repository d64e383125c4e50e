"""Pictures of robots on their ground, whatever engine moves them: drawn by the `mujoco` package (`crossgait[render]`).

    >>> robot = crossgait.Robot.load("scara_quadruped")
    >>> Renderer(robot).frame(crossgait.World(robot, engine="bullet").state).shape
    (480, 640, 3)

Without a display set MUJOCO_GL to egl or osmesa before anything imports mujoco; if it is not set, this package does.
"""

from __future__ import annotations

import os
import threading
import time
import weakref
from collections.abc import Mapping, Sequence
from types import TracebackType
from typing import Any

import numpy as np
import numpy.typing as npt

from crossgait import _core
from crossgait.arguments import checking_arguments
from crossgait.errors import ConfigError
from crossgait.inputs import RobotLike, TerrainLike, as_robot, as_terrain
from crossgait.viewing.mujoco_scene import Frame, has_display, mujoco, reach_of, scene_of

Depth = npt.NDArray[np.float32]

#: Between two frames in a window, s.
_FRAME_TIME = 1 / 60


class Renderer:
    """Draws one robot on one ground. Not for two threads at once; `close` it, or use it as a context manager."""

    @checking_arguments
    def __init__(
        self,
        robot: RobotLike,
        terrain: TerrainLike | None = None,
        *,
        width: int = 640,
        height: int = 480,
        azimuth: float = 130,
        elevation: float = -20,
        distance: float | None = None,
        look_at: Sequence[float] | None = None,
    ) -> None:
        """Build the scene; a graphics context is made by the first `frame` or `show`.

        Args:
            robot: drawn by its visual shapes, or by its collision shapes where it has none or they cannot be read, with
                a stick along each link that has neither.
            terrain: coloured by height, with a line every 0.1 m; flat ground has squares of 0.1 m.
            width: of a frame, pixels.
            height: of a frame, pixels.
            azimuth: direction of the camera's look, deg: 90 is along the world's y.
            elevation: of the camera's look, deg.
            distance: of the camera from what it looks at, m; by the robot's size if None.
            look_at: what a camera that stands still looks at, m; None for one that goes with the robot's base.

        Raises:
            ConfigError: for a robot or terrain that cannot be read, or a camera that is nowhere.

        """
        self.robot, self.terrain = as_robot(robot), as_terrain("flat" if terrain is None else terrain)
        if min(width, height) < 1:
            raise ConfigError("frame", "width, height", "pixels, at least 1", f"{width} x {height}")
        self._size = (width, height)
        self._model = scene_of(self.robot, self.terrain, width, height)
        self._data = mujoco.MjData(self._model)
        self._camera = mujoco.MjvCamera()
        self._camera.azimuth, self._camera.elevation = azimuth, elevation
        self._distance = 4.5 * reach_of(self.robot) if distance is None else _positive(distance)
        self._camera.distance = self._distance
        self._still = None if look_at is None else _point(look_at)
        self._offscreen: mujoco.Renderer | None = None
        self._window: Any = None
        self._shown = -1.0  # time of the state that the window shows, s
        self._started = 0.0  # on the clock, when the episode that it shows began, s

    def __repr__(self) -> str:
        return f"<crossgait.Renderer of '{self.robot.name}', {self._size[0]} x {self._size[1]}>"

    def frame(self, state: _core.State, look_at: Sequence[float] | None = None, wider: float = 0) -> Frame:
        """Draw the robot in `state`: height x width x 3.

        Args:
            state: of the robot.
            look_at: where the camera looks, m; by default as the renderer was made for.
            wider: how much further the camera is away, m.

        Raises:
            RuntimeError: where no graphics context can be made.

        """
        self._aim(state, look_at, wider)
        if self._offscreen is None:
            self._offscreen = self._make_offscreen()
        self._offscreen.update_scene(self._data, self._camera)
        # Shadows are drawn around the robot; on ground far from it they would be specks.
        self._offscreen.scene.flags[mujoco.mjtRndFlag.mjRND_SHADOW] = look_at is None
        frame: Frame = self._offscreen.render()
        return frame.copy()

    def depth(self, state: _core.State, look_at: Sequence[float] | None = None, wider: float = 0) -> Depth:
        """How far what the camera sees is along its look, m: height x width, float32; arguments as of `frame`.

        Where there is only sky it is the far end of what the camera sees. Raises RuntimeError as `frame`.
        """
        self._aim(state, look_at, wider)
        if self._offscreen is None:
            self._offscreen = self._make_offscreen()
        self._offscreen.update_scene(self._data, self._camera)
        self._offscreen.enable_depth_rendering()
        try:
            depth: Depth = self._offscreen.render().astype(np.float32)
        finally:
            self._offscreen.disable_depth_rendering()
        return depth

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

    def _aim(self, state: _core.State, look_at: Sequence[float] | None, wider: float) -> None:
        self._pose(state)
        if look_at is not None:
            self._camera.lookat = _point(look_at)
        self._camera.distance = self._distance + wider

    def _pose(self, state: _core.State) -> None:
        for i, pose in enumerate(_core.body_poses(self.robot, state)):
            self._data.mocap_pos[i] = pose[:3, 3]
            mujoco.mju_mat2Quat(self._data.mocap_quat[i], pose[:3, :3].flatten())
        self._data.mocap_pos[-1] = state.p_WB  # the sun
        mujoco.mj_kinematics(self._model, self._data)
        mujoco.mj_camlight(self._model, self._data)
        self._camera.lookat = state.p_WB if self._still is None else self._still

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
        if not has_display():
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


def _positive(distance: float) -> float:
    if not (np.isfinite(distance) and distance > 0):
        raise ConfigError("camera", "distance", "a number above zero, m", f"{distance:g}")
    return float(distance)


def _point(look_at: Sequence[float]) -> npt.NDArray[np.float64]:
    point = np.asarray(look_at, dtype=float)
    if point.shape != (3,) or not np.isfinite(point).all():
        raise ConfigError("camera", "look_at", "three finite numbers, m", repr(look_at))
    return point


def _close_window(window: Any, threads: set[threading.Thread]) -> None:
    window.close()
    for thread in threads:
        thread.join(timeout=10)


class EnvironmentRenderer:
    """Draws environments of the core, all of one robot, each on the ground of its episode."""

    def __init__(self, width: int, height: int, camera: Mapping[str, Any] | None = None) -> None:
        self._how = {"width": width, "height": height, **(camera or {})}
        self._renderer: Renderer | None = None

    def frame(self, environment: _core.Environment | _core.EnvironmentView) -> Frame:
        """Draw into an array, height x width x 3."""
        return self._of(environment).frame(environment.state)

    def depth(self, environment: _core.Environment | _core.EnvironmentView) -> Depth:
        """Distances, m, height x width."""
        return self._of(environment).depth(environment.state)

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
            self._renderer = Renderer(environment.robot, terrain, **self._how)
        return self._renderer


def _same_ground(a: _core.Terrain, b: _core.Terrain) -> bool:
    """Whether it is one field; both are alive, so that no address is used twice."""
    if a.heights is None or b.heights is None:
        return a.heights is b.heights
    return a.heights.ctypes.data == b.heights.ctypes.data
