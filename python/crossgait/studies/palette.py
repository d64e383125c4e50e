"""Colours and line styles of engines: the same in every figure, and on pages (web/src/palette.json)."""

from __future__ import annotations

import re
from collections.abc import Sequence

# Okabe and Ito's palette (2008): told apart by the colour-blind, too.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00")
# The libraries that come with Crossgait keep theirs; others take what is free.
LIBRARIES = ("mujoco", "bullet", "dart", "physx")
LINES = ("-", "--", ":", "-.")


def engine_styles(names: Sequence[str]) -> dict[str, tuple[str, str]]:
    """Return colour and line style by name.

    The colour is the library's. An engine as its library has it is solid; the library's others (another law, another
    release) are dashed, in their order.
    """
    libraries = {name: re.split(r"[:@+-]", name, maxsplit=1)[0] for name in names}
    present = list(dict.fromkeys(libraries.values()))
    colours = {library: COLOURS[LIBRARIES.index(library)] for library in present if library in LIBRARIES}
    free = [colour for colour in COLOURS if colour not in colours.values()] or list(COLOURS)
    others = [library for library in present if library not in colours]
    colours |= {library: free[i % len(free)] for i, library in enumerate(others)}
    variants = dict.fromkeys(present, 0)
    styles = {}
    for name in names:
        library = libraries[name]
        if name == library:
            styles[name] = (colours[library], LINES[0])
        else:
            styles[name] = (colours[library], LINES[1 + variants[library] % (len(LINES) - 1)])
            variants[library] += 1
    return styles
