"""Tests that whoever goes through the folders of code goes through all of them (cmake/CrossgaitLibrary.cmake)."""

import re
import unittest
from pathlib import Path

ROOT = Path(__file__).parents[2]


def only(pattern, file):
    found = re.findall(pattern, (ROOT / file).read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    assert len(found) == 1, f"{file}: expected {pattern} once, found {found}"
    return found[0]


CODE = set(only(r"set\(CROSSGAIT_CODE_FOLDERS ([^)]*)\)", "cmake/CrossgaitLibrary.cmake").split())
INSTALLED = set(only(r"^foreach\(folder ([^)]*)\)", "cmake/CrossgaitInstall.cmake").split())


class Folders(unittest.TestCase):
    def test_of_code_are_those_of_the_formatter_and_of_clang_tidy(self):
        formatted = set(only(r"^  find (.*?) -name", "scripts/lint").split())
        self.assertEqual(CODE - {"python"}, formatted - {"examples", "python/bindings"})
        self.assertEqual(CODE, set(only(r"^HeaderFilterRegex: '/\(([^)]*)\)/", ".clang-tidy").split("|")))

    def test_with_headers_that_are_installed_are_code_and_documented(self):
        self.assertLessEqual(INSTALLED, CODE)
        self.assertEqual(INSTALLED | {"backends"}, set(only(r"^INPUT *= ([^\n]*)", "docs/Doxyfile").split()))

    def test_with_libraries_have_mutants_drawn(self):
        drawn = set(re.findall(r'"(\w+)"', only(r"^FOLDERS = \[([^\]]*)\]", "scripts/quality/mutants")))
        self.assertEqual(drawn, CODE - {"view", "scenes", "benchmarks", "conformance", "apps", "python", "tests"})


if __name__ == "__main__":
    unittest.main()
