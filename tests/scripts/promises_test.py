"""Tests that promises of SECURITY.md, and answers of docs/, name tests that .ci/run runs."""

import re
import unittest
from pathlib import Path

ROOT = Path(__file__).parents[2]
# What .ci/run runs the tests of each folder by.
RUN_BY = {"tests": "scripts/test", "python": "scripts/test", "web": "scripts/test-page"}


def defines(file, name):
    """Is there a test of this name in a file of C++, Python or JavaScript?"""
    text = (ROOT / file).read_text(encoding="utf-8")
    if file.endswith(".cpp"):
        suite, _, case = name.partition(".")
        return re.search(rf"^TEST(_F|_P)?\({re.escape(suite)}, {re.escape(case)}\)", text, re.MULTILINE)
    if file.endswith(".py"):
        return re.search(rf"^ *def {re.escape(name)}\(", text, re.MULTILINE)
    return f'test("{name}", ' in text


def wrong(promise, held_by, run):
    """What is wrong with a row of the table, where `run` is the text of what has to pass."""
    references = re.findall(r"`([^`]+)`", held_by)
    if not references:
        return [f"{promise}: names no test"]
    found = []
    for reference in references:
        file, _, name = reference.partition(": ")
        by = RUN_BY.get(file.split("/")[0], file)
        if not (ROOT / file).is_file():
            found.append(f"{promise}: there is no {file}")
        elif name and not defines(file, name):
            found.append(f"{promise}: {file} has no test {name}")
        elif not name and file.split("/")[0] in RUN_BY:
            found.append(f"{promise}: {file}: expected the name of a test")
        if not re.search(rf"^ *step {re.escape(by)}\b", run, re.MULTILINE):
            found.append(f"{promise}: .ci/run does not run {by}")
    return found


class Promises(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.run_text = (ROOT / ".ci/run").read_text(encoding="utf-8")
        security = (ROOT / "SECURITY.md").read_text(encoding="utf-8")
        cls.promised, table = security.split("## What holds the promises")
        cls.rows = re.findall(r"^\| (?!promise |-)(.+?) \| (.+?) \|$", table, re.MULTILINE)

    def test_each_is_held_by_tests_that_run(self):
        self.assertGreaterEqual(len(self.rows), 1 + len(re.findall(r"^- ", self.promised, re.MULTILINE)))
        for promise, held_by in self.rows:
            with self.subTest(promise):
                self.assertEqual(wrong(promise, held_by, self.run_text), [])

    def test_each_answer_is_held_by_a_test(self):
        for page, first, last in (
            ("python-answers", 1, 66),
            ("attacks-answered", 1, 50),
            ("attacks-answered-later", 51, 96),
        ):
            text = (ROOT / f"docs/{page}.md").read_text(encoding="utf-8")
            rows = re.findall(r"^\| (\d+) \| .* \| (.+?) \|$", text, re.MULTILINE)
            self.assertEqual([int(number) for number, _ in rows], list(range(first, last + 1)), page)
            for number, held_by in rows:
                with self.subTest(page, row=number):
                    self.assertEqual(wrong(f"row {number}", held_by, self.run_text), [])

    def test_sees_what_is_not_there(self):
        file = "tests/view/server_test.cpp"
        for held_by, said in (
            ("hope", "names no test"),
            (f"`{file}`", "the name of a test"),
            (f"`{file}: RandomToken.IsShort`", "has no test"),
            ("`tests/view/no_test.cpp: A.B`", "there is no"),
            ("`tests/scripts/locks_test.py: test_nothing`", "has no test"),
            ("`web/test/page.test.mjs: no such title`", "has no test"),
            ("`scripts/quality/mutants`, `scripts/demo`", "does not run scripts/demo"),
        ):
            with self.subTest(held_by):
                self.assertIn(said, " ".join(wrong("p", held_by, self.run_text)))


if __name__ == "__main__":
    unittest.main()
