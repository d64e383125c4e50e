"""Files of moving pictures."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from crossgait.errors import ConfigError

#: Endings of the files that can be written.
KINDS = (".mp4", ".gif", ".webp")


class _WebP:
    """A moving WebP, which Pillow writes of all frames at once."""

    def __init__(self, path: Path, frames_per_second: float) -> None:
        self._path, self._duration = path, round(1000 / frames_per_second)
        self._frames: list[Any] = []

    def append_data(self, frame: Any) -> None:
        from PIL import Image

        self._frames.append(Image.fromarray(frame))

    def __enter__(self) -> _WebP:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if kind is None and self._frames:
            first, *rest = self._frames
            how = {"duration": self._duration, "loop": 0, "quality": 60, "method": 4}
            first.save(self._path, format="WEBP", save_all=True, append_images=rest, **how)


def check(path: str | os.PathLike[str]) -> None:
    """Raise ConfigError for a file with another ending."""
    kind = Path(path).suffix.lower()
    if kind not in KINDS:
        raise ConfigError(os.fspath(path), "file", f"one that ends in {' or '.join(KINDS)}", kind or "no ending")


def writer(path: Path, frames_per_second: float) -> Any:
    """Where frames go one by one (`append_data`), a context manager.

    H.264, whose pictures have even sides; GIF; or WebP, which is a fraction of a GIF.
    """
    try:
        import imageio.v2 as imageio
    except ImportError as error:
        raise ImportError("films are written with imageio: pip install crossgait[video]") from error
    if path.suffix.lower() == ".webp":
        return _WebP(path, frames_per_second)
    if path.suffix.lower() == ".gif":
        return imageio.get_writer(path, duration=1000 / frames_per_second, loop=0)
    return imageio.get_writer(path, fps=frames_per_second, macro_block_size=2)
