"""Tests that what says Crossgait's version agrees (docs/versioning.md)."""

import json
import re
import unittest
from pathlib import Path

ROOT = Path(__file__).parents[2]


def only(pattern, file):
    found = re.findall(pattern, (ROOT / file).read_text(encoding="utf-8"), re.MULTILINE)
    assert len(found) == 1, f"{file}: expected {pattern} once, found {found}"
    return found[0]


VERSION = only(r"^project\(crossgait VERSION ([0-9.]+) ", "CMakeLists.txt")


class Versions(unittest.TestCase):
    def test_the_citation_is_of_this_version(self):
        self.assertEqual(only(r"^version: (.*)$", "CITATION.cff"), VERSION)

    def test_the_changelog_has_this_version_and_a_place_for_the_next_above_it(self):
        headings = re.findall(r"^## (\S+)", (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"), re.MULTILINE)
        self.assertEqual(headings[:2], ["Unreleased", VERSION])

    def test_schemas_are_drafts_until_they_are_frozen(self):
        files = sorted((ROOT / "docs/schemas").glob("*.json"))
        self.assertTrue(files)
        for file in files:
            comment = json.loads(file.read_text(encoding="utf-8")).get("$comment", "")
            self.assertEqual("draft" in comment, int(VERSION.split(".")[0]) < 1, f"{file.name}: {comment}")


if __name__ == "__main__":
    unittest.main()
