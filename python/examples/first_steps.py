"""First steps: engines, a walk, a comparison, a verdict. Run it with: python first_steps.py [FOLDER for pictures]."""

from __future__ import annotations

import sys
from pathlib import Path

import crossgait


def main(folder: Path) -> None:
    """Walk, compare and judge a trot, and draw what came of it."""
    for engine in crossgait.engines():
        print(f"{engine.name:16} {engine.version:8} {engine.mode if engine.available else engine.reason}")

    walked = crossgait.walk("trot", command=(0.35, 0, 0), seconds=5, trace=True)
    print(repr(walked))
    walked.plot().savefig(folder / "walk.png")

    compared = crossgait.compare("trot", terrain="rough", seed=3, seconds=5, trace=True)
    print(compared)
    compared.plot().savefig(folder / "compare.png")

    verdict = crossgait.verdict("trot", seconds=2, starts=6)
    print(verdict.word)
    print(verdict.to_frame()[["unit", "score", "low", "high", "word"]].round(3))
    verdict.plot().savefig(folder / "verdict.png")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path.cwd())
