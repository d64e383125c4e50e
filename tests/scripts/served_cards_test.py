"""scripts/cards/served-cards: --check reads from the page what failed when it was written."""

import contextlib
import importlib.machinery
import importlib.util
import io
import sys
import unittest
from pathlib import Path

CARDS = Path(__file__).parents[2] / "scripts/cards"


def script():
    sys.path.insert(0, str(CARDS))  # what it imports is beside it
    loader = importlib.machinery.SourceFileLoader("served_cards", str(CARDS / "served-cards"))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("served_cards", loader))
    loader.exec_module(module)
    return module


def card(engine, **statuses):
    laws = ("contact", "loop", "joint_friction", "joint_limit", "coupling", "implicit_servo")
    return {
        "engine": {"name": engine, "library": "L", "version": "1", "mode": "m", "precision": "float32"}
        | {f"{law}_law": "" for law in laws},
        "passed": 1,
        "failed": 1,
        "skipped": 0,
        "checks": [
            {"name": name, "status": status, "reason": "", "precondition": "", "measurements": []}
            for name, status in statuses.items()
        ],
    }


class ServedCards(unittest.TestCase):
    def setUp(self):
        self.script = script()
        # Two that failed by the same words, of which there are none, share a line.
        both = card("python:both", gravity="failed", push="failed")
        cards = [card("python:one", gravity="failed", push="passed"), card("python:one_more", push="failed"), both]
        self.page = self.script.page_of(cards, [["`robot`", "flat", "1e-07", "2e-06"]], "today", 2)

    def says(self, cards, beyond=()):
        with contextlib.redirect_stdout(io.StringIO()) as said:
            code = self.script.check(cards, list(beyond), self.page)
        return code, said.getvalue()

    def test_what_is_as_on_the_page_passes(self):
        code, said = self.says(
            [card("python:one", gravity="failed", push="passed"), card("python:one_more", push="failed")]
        )
        self.assertEqual(code, 0)
        self.assertIn("as on its card", said)

    def test_checks_that_failed_alike_are_each_known(self):
        code, said = self.says([card("python:both", gravity="passed", push="failed")])
        self.assertEqual(code, 1)
        self.assertIn("python:both: gravity passes, other than on the page", said)

    def test_another_failure_one_that_is_gone_and_a_distance_beyond_its_bound_do_not(self):
        code, said = self.says([card("python:one", gravity="passed", push="failed")], ["robot on flat is far"])
        self.assertEqual(code, 1)
        self.assertIn("python:one: gravity passes, other than on the page", said)
        self.assertIn("python:one: push fails, other than on the page", said)
        self.assertIn("robot on flat is far", said)


if __name__ == "__main__":
    unittest.main()
