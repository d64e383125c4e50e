"""What a walk looked like over time, and its files for viewers."""

from __future__ import annotations

import os
from collections.abc import Sequence

from crossgait._core import Robot, Terrain
from crossgait.files import check_outputs, noting_reads
from crossgait.inputs import RobotLike, TerrainLike, as_terrain
from crossgait.progress import Progress
from crossgait.traces import scene
from crossgait.traces.table import TraceTable


def _world(
    trace: TraceTable, path: str | os.PathLike[str], robot: RobotLike, terrain: TerrainLike | None
) -> tuple[Robot, Terrain | None]:
    """Robot and ground of a trace, read, and what is written checked to be none of their files."""
    with noting_reads() as read:
        known = scene.the_robot(trace, robot)
        ground = None if terrain is None else as_terrain(terrain)
    check_outputs([("path", path)], [*trace.inputs, *read])
    return known, ground


class Trace(TraceTable):
    """A walk over time: columns by name as NumPy arrays (`trace["p_WB.x"]`), and files for viewers."""

    def to_mcap(self, path: str | os.PathLike[str], robot: RobotLike, terrain: TerrainLike | None = None) -> None:
        """Write an MCAP file for Foxglove: frames and shapes of the bodies, footfalls, and every column to plot.

        Args:
            path: the file appears whole or not at all.
            robot: that walked: a name, a file or a `Robot`.
            terrain: that it walked on: a name, a file or a `Terrain`. Drawn as far as 1 m from its way; not if it is
                flat.

        Raises:
            ConfigError: if it was another robot.
            ImportError: without mcap (`pip install crossgait[mcap]`).

        """
        from crossgait.traces import mcap

        mcap.write(self, path, *_world(self, path, robot, terrain))

    def to_rerun(self, path: str | os.PathLike[str], robot: RobotLike, terrain: TerrainLike | None = None) -> None:
        """Write an .rrd file for Rerun: as `to_mcap`.

        Raises:
            ConfigError: if it was another robot.
            ImportError: without rerun-sdk (`pip install crossgait[rerun]`).

        """
        from crossgait.traces import rerun

        rerun.write(self, path, *_world(self, path, robot, terrain))

    def to_video(
        self,
        path: str | os.PathLike[str],
        robot: RobotLike,
        terrain: TerrainLike | None = None,
        *,
        fps: float = 30,
        slow: float = 1,
        width: int = 640,
        height: int = 480,
        azimuth: float = 130,
        elevation: float = -20,
        distance: float | None = None,
        look_at: Sequence[float] | None = None,
        progress: Progress | bool | None = None,
    ) -> None:
        """Write a film.

        Args:
            path: FILE.mp4 (H.264), FILE.gif or FILE.webp; appears whole or not at all.
            robot: that walked: a name, a file or a `Robot`.
            terrain: that it walked on: a name, a file or a `Terrain`; flat by default.
            fps: frames per second.
            slow: times slower than it happened.
            width: pixels, made even.
            height: pixels, made even.
            azimuth: direction of the camera's look, deg: 90 is along the world's y.
            elevation: of the camera's look, deg.
            distance: of the camera from what it looks at, m; by the robot's size if None.
            look_at: what a camera that stands still looks at, m; None for one that goes along.
            progress: as `crossgait.walk` takes it.

        Raises:
            ConfigError: if it was another robot, or for another ending.
            ImportError: without what draws and writes it (`pip install crossgait[video]`).

        """
        from crossgait.traces import video

        video.write(
            [self],
            path,
            *_world(self, path, robot, terrain),
            fps=fps,
            slow=slow,
            width=width,
            height=height,
            azimuth=azimuth,
            elevation=elevation,
            distance=distance,
            look_at=look_at,
            progress=progress,
        )
