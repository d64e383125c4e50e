"""Tests that pages of docs/ can be read at a sitting, are on the site, and stand with what writes them."""

import re
import unittest
from pathlib import Path

ROOT = Path(__file__).parents[2]
PAGES = sorted((ROOT / "docs").rglob("*.md"))
MOST_WORDS = 2500  # a quarter of an hour; cells and marks of tables count as `wc -w` counts them


def words(text):
    return len(text.split())


class Pages(unittest.TestCase):
    def test_are_short_enough(self):
        self.assertGreater(len(PAGES), 50)
        for page in PAGES:
            with self.subTest(page=page.relative_to(ROOT)):
                self.assertLessEqual(words(page.read_text(encoding="utf-8")), MOST_WORDS)

    def test_are_on_the_site_once(self):
        navigation = (ROOT / "mkdocs.yml").read_text(encoding="utf-8").split("\nnav:\n")[1]
        named = re.findall(r"\bdocs/[\w/-]+\.md", navigation)
        self.assertEqual(sorted(named), [str(page.relative_to(ROOT)) for page in PAGES])

    def test_that_are_generated_name_what_wrote_them(self):
        for page in (p for p in PAGES if p.parent != ROOT / "docs" and "generated" in p.parts):
            head = page.read_text(encoding="utf-8").split("\n## ")[0]
            commands = re.findall(r"`((?:scripts/|crossgait )[^`]+)`", head)
            with self.subTest(page=page.relative_to(ROOT)):
                self.assertTrue(commands)
                for command in commands:
                    program = command.split()[0]
                    self.assertTrue(program == "crossgait" or (ROOT / program).is_file(), command)


if __name__ == "__main__":
    unittest.main()
