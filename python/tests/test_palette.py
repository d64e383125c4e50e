"""Engines look the same in figures and on pages."""

from __future__ import annotations

import json
from pathlib import Path

from crossgait.studies.palette import COLOURS, LIBRARIES, engine_styles

ROOT = Path(__file__).parents[2]


def test_figures_have_the_colours_of_pages() -> None:
    page = json.loads((ROOT / "web/src/palette.json").read_text())
    assert [colour.lower() for colour in COLOURS] == page["light"]
    assert list(LIBRARIES) == page["libraries"]
    assert len(page["dark"]) == len(page["light"])


def test_a_library_keeps_its_colour_and_its_variants_are_dashed() -> None:
    styles = engine_styles(["bullet:matched", "mujoco", "bullet", "mujoco@4.0.0", "mujoco@2.3.7"])
    assert styles["bullet"] == (COLOURS[1], "-")
    assert styles["bullet:matched"] == (COLOURS[1], "--")
    assert styles["mujoco"] == (COLOURS[0], "-")
    assert styles["mujoco@4.0.0"] == (COLOURS[0], "--")
    assert styles["mujoco@2.3.7"] == (COLOURS[0], ":")


def test_others_take_colours_that_are_free() -> None:
    styles = engine_styles(["mine", "mujoco", "yours", *(f"engine{i}" for i in range(9))])
    assert styles["mine"][0] == COLOURS[1]
    assert styles["yours"][0] == COLOURS[2]
    assert COLOURS[0] not in {colour for name, (colour, _) in styles.items() if name != "mujoco"}
