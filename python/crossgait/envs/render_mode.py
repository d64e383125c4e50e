"""What `render_mode` may be, and the renderer that is made for the first frame."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from crossgait.errors import ConfigError
from crossgait.inputs import whole_number

if TYPE_CHECKING:
    from crossgait.viewing.rendering import EnvironmentRenderer


def known_render_mode(mode: str | None, modes: Sequence[str]) -> str | None:
    """Return `mode`. Raises ConfigError unless it is one of `modes` or None."""
    if mode is not None and mode not in modes:
        raise ConfigError("environment", "render_mode", " or ".join(map(repr, modes)), repr(mode))
    return mode


CAMERA = ("azimuth", "elevation", "distance", "look_at")  #: keywords of `Renderer`


def known_camera(camera: Mapping[str, Any] | None) -> Mapping[str, Any] | None:
    """Return `camera`. Raises ConfigError unless all of its keys are of `CAMERA`."""
    for key in camera or {}:
        if key not in CAMERA:
            raise ConfigError("environment", "camera", f"keys of {', '.join(CAMERA)}", repr(key))
    return camera


def frame_size(width: Any, height: Any) -> tuple[int, int]:
    """Width and height of frames, pixels. Raises ConfigError for what is none."""
    return whole_number(width, "environment", "width"), whole_number(height, "environment", "height")


class Drawn:
    """Has a renderer from its first frame on. `_frame_size` is width and height, `_camera` as `known_camera` has it."""

    _frame_size: tuple[int, int]
    _camera: Mapping[str, Any] | None = None
    _renderer: EnvironmentRenderer | None = None

    def _open_renderer(self) -> EnvironmentRenderer:
        if self._renderer is None:
            from crossgait.viewing.rendering import EnvironmentRenderer

            self._renderer = EnvironmentRenderer(*self._frame_size, self._camera)
        return self._renderer

    def _close_renderer(self) -> None:
        if self._renderer is not None:
            self._renderer.close()
            self._renderer = None
