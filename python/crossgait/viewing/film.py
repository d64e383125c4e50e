"""Files of moving pictures."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from crossgait.errors import ConfigError

#: Endings of the files that can be written.
KINDS = (".mp4", ".gif", ".webp")


class _Pictures:
    """A moving WebP or GIF, which Pillow writes of all frames at once."""

    def __init__(self, path: Path, frames_per_second: float) -> None:
        self._path, self._duration = path, round(1000 / frames_per_second)
        self._frames: list[Any] = []

    def append_data(self, frame: Any) -> None:
        from PIL import Image

        self._frames.append(Image.fromarray(frame))

    def __enter__(self) -> _Pictures:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if kind is not None or not self._frames:
            return
        how: dict[str, Any] = {"duration": self._duration, "loop": 0}
        if self._path.suffix.lower() == ".gif":
            first, *rest = _of_one_palette(self._frames)
            first.save(self._path, format="GIF", save_all=True, append_images=rest, optimize=False, **how)
        else:
            first, *rest = self._frames
            first.save(self._path, format="WEBP", save_all=True, append_images=rest, quality=60, method=4, **how)


def _of_one_palette(frames: list[Any]) -> list[Any]:
    """Return the frames in 256 colours of eight of them, not dithered: dots that flicker are most of a GIF's size."""
    from PIL import Image

    some = frames[:: -(-len(frames) // 8)]
    width, height = frames[0].size
    together = Image.new("RGB", (width, height * len(some)))
    for i, frame in enumerate(some):
        together.paste(frame, (0, height * i))
    palette = together.quantize(256, method=Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE)
    return [frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames]


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
    if path.suffix.lower() in (".webp", ".gif"):
        return _Pictures(path, frames_per_second)
    return imageio.get_writer(path, fps=frames_per_second, macro_block_size=2)
