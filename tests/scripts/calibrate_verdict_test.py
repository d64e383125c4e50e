"""scripts/quality/calibrate-verdict: its limits, its door to the rule, and a small part of it."""

import importlib.machinery
import importlib.util
import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).parents[2]
SCRIPT = ROOT / "scripts/quality/calibrate-verdict"
BUILD = Path(os.getcwd()).parents[1]  # ctest runs it in BUILD/tests/scripts
PROGRAM, TOOL = BUILD / "apps/crossgait", BUILD / "tests/scripts/crossgait_judge_starts"

sys.path.insert(0, str(SCRIPT.parent))
import verdict_calibration_page as page  # noqa: E402
import verdict_trials as trials  # noqa: E402

loader = importlib.machinery.SourceFileLoader("calibrate_verdict", str(SCRIPT))
spec = importlib.util.spec_from_loader(loader.name, loader)
calibrate = importlib.util.module_from_spec(spec)
loader.exec_module(calibrate)


def has_engines(*names):
    return TOOL.exists() and set(names) <= trials.Program(PROGRAM, 1).engines()


class Limits(unittest.TestCase):
    def test_are_clopper_and_pearsons(self):
        # Without hits the limit is 1 - error^(1/n); the others are the beta distribution's, to the digits given.
        self.assertAlmostEqual(trials.upper_limit(0, 60), 1 - 0.05 ** (1 / 60), places=12)
        self.assertAlmostEqual(trials.upper_limit(1, 93), 0.0500, places=4)
        self.assertAlmostEqual(trials.lower_limit(10, 10), 0.05 ** (1 / 10), places=12)
        self.assertEqual((trials.lower_limit(0, 9), trials.upper_limit(9, 9)), (0, 1))
        # Which is what they are by: as few, or as many, come with the error.
        self.assertAlmostEqual(1 - trials._tail(4, 50, trials.upper_limit(3, 50)), 0.05, places=9)
        self.assertAlmostEqual(trials._tail(3, 50, trials.lower_limit(3, 50)), 0.05, places=9)

    def test_say_how_many_alarms_are_allowed(self):
        self.assertEqual([trials.most_hits(n) for n in (2, 60, 92, 93, 124)], [0, 0, 0, 1, 2])


class Settings(unittest.TestCase):
    def test_come_from_the_seed(self):
        drawn = [trials.draw_setting(1, n) for n in range(40)]
        self.assertEqual(drawn, [trials.draw_setting(1, n) for n in range(40)])
        self.assertNotEqual(drawn, [trials.draw_setting(2, n) for n in range(40)])
        for key, count in (("gait", 8), ("robot", 3), ("terrain", 20)):
            self.assertGreaterEqual(len({setting.get(key) for setting in drawn}), count, key)
        self.assertEqual(sum("environment" in setting for setting in drawn), 6)


class Bounds(unittest.TestCase):
    @staticmethod
    def kept(**found):
        return [bound["kept"] for bound in calibrate.bounds_of(found)]

    def test_are_missed_by_false_alarms(self):
        def rows(alarms):
            return [{"setting": n, "word": "differs" if n < alarms else "agrees"} for n in range(93)]

        self.assertEqual(self.kept(**{"same-law": rows(1)}), [True])
        self.assertEqual(self.kept(**{"same-law": rows(2)}), [False])

    def test_are_missed_by_too_many_words_at_the_margin(self):
        def row(agrees, regular=True):
            return {
                "agrees": {str(n): {"slip_m": agrees} for n in (6, 12, 24)},
                "differs": {"6": 0, "12": 0, "24": 0},
                "trials": 400,
                "regular": ["slip_m"] if regular else [],
            }

        self.assertEqual(self.kept(margin=[row(20)]), [True] * 6)
        self.assertEqual(self.kept(margin=[row(40)]), [False, True] * 3)
        self.assertEqual(self.kept(margin=[row(20, regular=False)]), [True] * 6)
        self.assertEqual(self.kept(margin=[row(40, regular=False)]), [False, True] * 3)

    def test_differences_that_are_skewed_or_tied_are_known(self):
        self.assertTrue(trials.is_regular(list(range(40))))
        self.assertFalse(trials.is_regular([1.2**k for k in range(40)]))
        self.assertFalse(trials.is_regular([k // 6 for k in range(40)]))
        self.assertFalse(trials.is_regular([0.5] * 9))

    def test_are_missed_by_intervals_that_do_not_hold(self):
        def bounds(held, regular, cut=0):
            counts = {
                "held": dict.fromkeys(("6", "12", "24"), held),
                "regular": dict.fromkeys(("6", "12", "24"), regular),
            }
            found = calibrate.bounds_of({"coverage": [counts | {"trials": 400, "cut": cut}]})
            return [bound["kept"] for bound in found[:2]]

        self.assertEqual(bounds(380, 390), [True, True])
        self.assertEqual(bounds(330, 340), [False, False])
        self.assertEqual(bounds(340, 380, cut=9), [True, False])

    def test_a_trial_without_early_ends_speaks_of_pairs_without(self):
        truth = trials.Truth([1.0, 2.0, 3.0, 30.0], [False, False, False, True])
        mean, median = {"estimand": "mean", "is_share": False}, {"estimand": "median", "is_share": False}
        self.assertEqual(truth.of(mean, {"cut_pairs": 0}), 2)
        self.assertEqual(truth.of(median, {"cut_pairs": 1}), 2.5)
        self.assertEqual(truth.of(mean | {"is_share": True}, {"cut_pairs": 0}), 9)

    def test_are_missed_by_a_pair_that_comes_to_agree(self):
        def rows(agrees):
            return [
                {"behaviour": "gallop", "level": "as they are", "whole": "differs", "words": {"6": {"differs": 9}}},
                {
                    "behaviour": "gallop",
                    "level": "pushed",
                    "whole": "unresolved",
                    "words": {"6": {"unresolved": 9, "agrees": agrees}},
                },
            ]

        self.assertEqual(self.kept(pushes=rows(0)), [True])
        self.assertEqual(self.kept(pushes=rows(1)), [False])


class Power(unittest.TestCase):
    def test_the_least_that_is_seen_is_seen_from_there_on(self):
        def rows(*shares):
            return [
                {"size": size, "unit": "%", "seen": {"6": share}} for size, share in zip((1, 2, 5), shares, strict=True)
            ]

        self.assertEqual(page.smallest_seen(rows(0.1, 0.8, 0.9), 6), "+2 %")
        self.assertEqual(page.smallest_seen(rows(0.9, 0.1, 0.9), 6), "+5 %")
        self.assertEqual(page.smallest_seen(rows(0.8, 0.9, 0.9), 6), "+1 % or less")
        self.assertEqual(page.smallest_seen(rows(0.1, 0.1, 0.7), 6), "beyond +5 %")
        drawn = page.picture([row | {"behaviour": "trot", "kind": "mass"} for row in rows(0.1, 0.8, 0.9)], (6,))
        self.assertEqual(drawn.count("<circle"), 3)


class Door(unittest.TestCase):
    """crossgait_judge_starts gives the program's words, from the program's runs."""

    def setUp(self):
        if not has_engines("mujoco", "bullet"):
            self.skipTest("needs mujoco and bullet")
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.runs = Path(folder.name) / "runs.jsonl"

    def ask(self, *arguments, **more):
        with trials.Judge(TOOL, self.runs, 1) as judge:
            return judge.ask(*arguments, **more)

    def test_words_and_intervals_are_the_programs(self):
        setting = {
            "gait": "trot",
            "terrain": "rough",
            "seconds": 0.8,
            "friction": 0.5,
            "seed": 3,
            "push": 0.1,
            "offset": 0.2,
            "heading": 0.5,
        }
        told = trials.Program(PROGRAM, 1).verdict(setting, ("mujoco", "bullet"), 6, self.runs)["pairs"][0]
        rows = len(self.runs.read_text().splitlines())
        found = self.ask(setting, {"engine": "mujoco"}, {"engine": "bullet"}, list(range(6)))
        self.assertEqual(len(self.runs.read_text().splitlines()), rows, "the runs are the program's")
        self.assertEqual(found["word"], told["word"])
        self.assertEqual(
            [(s["key"], s["word"], s["low"], s["high"]) for s in found["statistics"]],
            [(s["key"], s["word"], s["low"], s["high"]) for s in told["statistics"]],
        )

    def test_what_is_planted_is_seen_and_starts_may_be_drawn_again(self):
        setup, engine = {"gait": "trot", "seconds": 0.5}, {"engine": "mujoco"}
        for plant in (
            {"mass": 1.5},
            {"friction": 0.2},
            {"stiffness": 0.5},
            {"damping": 5},
            {"delay": 0.01},
            {"slope": 8},
            {"gravity": 0.5},
        ):
            found = self.ask(setup, engine, engine | {"planted": plant}, [0, 1, 2, 3, 4, 5])
            self.assertEqual(found["word"], "differs", plant)
        self.assertEqual(self.ask(setup, engine, engine, [0, 1, 2, 2, 1, 0])["word"], "agrees")
        other = self.ask(setup, engine, engine, [0, 1, 2, 3, 4, 5], [6, 7, 8, 9, 10, 11], steps=False, differences=True)
        self.assertTrue(all(other["statistics"][0]["differences"]), "the starts are others")

    def test_a_request_that_is_wrong_is_refused(self):
        engine = {"engine": "mujoco"}
        for setup, more, word in (
            ({"gate": "trot"}, {}, "gate"),
            ({}, {"margin": 1}, "margin"),
            ({}, {"margins": {"way": 1}}, "way"),
        ):
            request = {"setup": setup, "a": engine, "b": engine, "starts_a": [0], "starts_b": [0], **more}
            done = subprocess.run(
                [TOOL, "--runs", self.runs], input=json.dumps(request), capture_output=True, text=True, check=False
            )
            self.assertEqual((done.returncode, done.stdout), (2, ""))
            self.assertIn(word, done.stderr)


class Small(unittest.TestCase):
    def test_keeps_its_bounds_and_goes_on_where_it_was(self):
        if not has_engines("mujoco", "bullet", "bullet:matched", "dart:matched"):
            self.skipTest("needs mujoco, bullet and dart")
        with tempfile.TemporaryDirectory() as folder:
            command = [
                SCRIPT,
                "--small",
                "--program",
                PROGRAM,
                "--tool",
                TOOL,
                "--state",
                folder,
                "--json",
                Path(folder) / "found.json",
            ]
            done = subprocess.run(command, capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            found = (Path(folder) / "found.json").read_text()
            (kept,) = Path(folder).glob("*/results-*.jsonl")
            results = kept.read_text()
            kept.write_text(results[: len(results) // 2])  # stopped in the middle of a line
            done = subprocess.run(command, capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            self.assertEqual((Path(folder) / "found.json").read_text(), found)


if __name__ == "__main__":
    unittest.main()
