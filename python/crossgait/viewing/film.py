"""Files of moving pictures."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from crossgait.errors import ConfigError
from crossgait.extras import needed_for

#: Endings of the files that can be written.
KINDS = (".mp4", ".gif", ".webp")
_KEPT = (".gif", ".webp")  #: whose frames stay in memory until the end

MOST_FRAMES = 36_000  #: twenty minutes at 30 a second
MOST_KEPT_PIXELS = 3e8  #: three bytes each


class _Pictures:
    """A moving WebP or GIF, which Pillow writes of all frames at once."""

    def __init__(self, path: Path, frames_per_second: float) -> None:
        self._path, self._duration = path, round(1000 / frames_per_second)
        self._frames: list[Any] = []

    def append_data(self, frame: Any) -> None:
        self._frames.append(frame)  # a picture of Pillow's has four bytes for each three

    def __enter__(self) -> _Pictures:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if kind is not None or not self._frames:
            return
        from PIL import Image

        pictures = map(Image.fromarray, self._frames)
        how: dict[str, Any] = {"duration": self._duration, "loop": 0}
        if self._path.suffix.lower() == ".gif":
            pictures = map(_one_palette_of(self._frames), pictures)
            next(pictures).save(self._path, format="GIF", save_all=True, append_images=pictures, optimize=False, **how)
        else:
            next(pictures).save(
                self._path, format="WEBP", save_all=True, append_images=pictures, quality=60, method=4, **how
            )


def _one_palette_of(frames: list[Any]) -> Callable[[Any], Any]:
    """Return what puts pictures into 256 colours of eight frames.

    They are not dithered: dots that flicker are most of a GIF's size.
    """
    from PIL import Image

    together = Image.fromarray(np.concatenate(frames[:: -(-len(frames) // 8)]))
    palette = together.quantize(256, method=Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE)
    return lambda picture: picture.quantize(palette=palette, dither=Image.Dither.NONE)


def check(path: str | os.PathLike[str]) -> None:
    """Raise ConfigError for a file with another ending."""
    kind = Path(path).suffix.lower()
    if kind not in KINDS:
        raise ConfigError(os.fspath(path), "file", f"one that ends in {' or '.join(KINDS)}", kind or "no ending")


def check_size(path: str | os.PathLike[str], frames: int, pixels: float) -> None:
    """Raise ConfigError for more than a film may have. `pixels` are those of all frames."""
    if frames > MOST_FRAMES:
        raise ConfigError(os.fspath(path), "film", f"at most {MOST_FRAMES} frames", str(frames))
    if Path(path).suffix.lower() in _KEPT and pixels > MOST_KEPT_PIXELS:
        expected = f"at most {MOST_KEPT_PIXELS:.0e} pixels in all frames of a GIF or WebP; an MP4 may have more"
        raise ConfigError(os.fspath(path), "film", expected, f"{pixels:.2g}")


def writer(path: Path, frames_per_second: float) -> Any:
    """Where frames go one by one (`append_data`), a context manager.

    H.264, whose pictures have even sides; GIF; or WebP, which is a fraction of a GIF.
    """
    with needed_for("films", "video"):
        import imageio.v2 as imageio
    if path.suffix.lower() in _KEPT:
        return _Pictures(path, frames_per_second)
    with needed_for("films of this kind", "video"):
        import imageio_ffmpeg  # type: ignore[import-untyped]  # noqa: F401  # imageio asks for it with the first frame
    return imageio.get_writer(path, fps=frames_per_second, macro_block_size=2)
