"""scripts/sbom names what this build was made of."""

import json
import os
import subprocess
import sys
import tempfile
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BUILD = os.path.dirname(os.path.dirname(os.getcwd()))  # ctest runs it in BUILD/tests/scripts


class Sbom(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.licences = folder.name
        text = subprocess.run(
            [sys.executable, os.path.join(ROOT, "scripts", "sbom"), BUILD, "--licenses", cls.licences],
            check=True,
            capture_output=True,
            text=True,
        ).stdout
        cls.bill = json.loads(text)
        cls.components = {component["name"]: component for component in cls.bill["components"]}

    def test_says_what_it_is(self):
        self.assertEqual((self.bill["bomFormat"], self.bill["specVersion"]), ("CycloneDX", "1.5"))
        self.assertEqual(self.bill["metadata"]["component"]["name"], "crossgait")

    def test_names_libraries_by_their_files(self):
        library = self.components["libfmt9"]
        installed = subprocess.run(
            ["dpkg-query", "--show", "--showformat=${Version}", "libfmt9"], check=True, capture_output=True, text=True
        ).stdout
        self.assertEqual(library["version"], installed)
        (file,) = library["components"]
        told = subprocess.run(["sha256sum", file["name"]], check=True, capture_output=True, text=True).stdout
        self.assertEqual(file["hashes"][0]["content"], told.split()[0])

    def test_names_what_is_headers_alone_and_what_is_on_pages(self):
        self.assertLessEqual({"libeigen3-dev", "nlohmann-json3-dev", "libcli11-dev"}, set(self.components))
        page = os.path.join(BUILD, "web", "page.html")
        if os.path.exists(page) and os.path.getsize(page) > 0:  # empty where npm could fetch nothing
            self.assertLessEqual({"three", "uplot"}, set(self.components))
            self.assertEqual(self.components["three"]["licenses"], [{"license": {"id": "MIT"}}])

    def test_writes_the_licence_of_each(self):
        self.assertEqual(set(self.components) | {"common-licenses"}, set(os.listdir(self.licences)))
        for name, says in (("libeigen3-dev", "MPL"), ("libfmt9", "Victor Zverovich")):
            with open(os.path.join(self.licences, name), encoding="utf-8") as file:
                self.assertIn(says, file.read())
        with open(os.path.join(self.licences, "common-licenses", "GPL-3"), encoding="utf-8") as file:
            self.assertIn("GNU GENERAL PUBLIC LICENSE", file.read())

    def test_leaves_out_what_is_not_handed_out(self):
        self.assertNotIn("libgtest-dev", self.components)


if __name__ == "__main__":
    unittest.main()
