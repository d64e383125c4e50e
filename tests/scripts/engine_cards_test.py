"""scripts/cards/engine-cards: the cards of engines are made of what `crossgait conformance` says today."""

import os
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).parents[2]
PROGRAM = Path(os.getcwd()).parents[1] / "apps/crossgait"  # ctest runs it in BUILD/tests/scripts


def has_bullet():
    done = (
        subprocess.run([PROGRAM, "engines"], capture_output=True, text=True, check=False) if PROGRAM.exists() else None
    )
    return done is not None and "Bullet" in done.stdout


@unittest.skipUnless(has_bullet(), "without Bullet, or the program")
class Cards(unittest.TestCase):
    def test_of_one_engine_are_whole(self):
        with tempfile.TemporaryDirectory() as folder:
            script = ROOT / "scripts/cards/engine-cards"
            subprocess.run([script, "--program", PROGRAM, "--out", folder, "bullet"], check=True, capture_output=True)
            card = (Path(folder) / "engine-cards.md").read_text()
            numbers = {file.stem: file.read_text() for file in (Path(folder) / "engine-numbers").iterdir()}
        self.assertIn("| `bullet` | Bullet ", card)
        self.assertIn("hard/sweeps", card)
        self.assertIn("\nNone.\n", card)  # beyond their bounds
        for topic, check in (
            ("model", "mass_properties"),
            ("friction", "friction_cone_plane"),
            ("joint-limits", "joint_limit_stop"),
        ):
            self.assertIn(f"\n## {check}\n", numbers[topic])
            self.assertIn(f"]({f'engine-numbers/{topic}.md'})", card)


if __name__ == "__main__":
    unittest.main()
