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
from collections.abc import Sequence
from types import TracebackType
from typing import Any

import numpy as np

from crossgait import _core
from crossgait.viewing.mujoco_scene import Frame, has_display, mujoco, reach_of, scene_of

#: Between two frames in a window, s.
_FRAME_TIME = 1 / 60


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
            terrain: coloured by height, with a line every 0.1 m; flat ground has squares of 0.1 m.
            width: of a frame, pixels.
            height: of a frame, pixels.
            azimuth: direction of the camera's look, deg: 90 is along the world's y.
            elevation: of the camera's look, deg.

        """
        self.robot = robot
        self.terrain = terrain if terrain is not None else _core.Terrain()
        self._size = (width, height)
        self._model = scene_of(robot, self.terrain, width, height)
        self._data = mujoco.MjData(self._model)
        self._camera = mujoco.MjvCamera()
        self._camera.azimuth, self._camera.elevation = azimuth, elevation
        self._distance = self._camera.distance = 4.5 * reach_of(robot)
        self._offscreen: mujoco.Renderer | None = None
        self._window: Any = None
        self._shown = -1.0  # time of the state that the window shows, s
        self._started = 0.0  # on the clock, when the episode that it shows began, s

    def frame(self, state: _core.State, look_at: Sequence[float] | None = None, wider: float = 0) -> Frame:
        """Draw the robot in `state`: height x width x 3.

        Args:
            state: of the robot.
            look_at: where the camera looks, m; at the robot's base by default.
            wider: how much further the camera is away, m.

        Raises:
            RuntimeError: where no graphics context can be made.

        """
        self._pose(state)
        if look_at is not None:
            self._camera.lookat = np.asarray(look_at, dtype=float)
        self._camera.distance = self._distance + wider
        if self._offscreen is None:
            self._offscreen = self._make_offscreen()
        self._offscreen.update_scene(self._data, self._camera)
        # Shadows are drawn around the robot; on ground far from it they would be specks.
        self._offscreen.scene.flags[mujoco.mjtRndFlag.mjRND_SHADOW] = look_at is None
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
