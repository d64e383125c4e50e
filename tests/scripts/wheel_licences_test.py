"""scripts/quality/wheel-licences finds what a wheel carries without its licence."""

import json
import subprocess
import sys
import tempfile
import unittest
import zipfile
from pathlib import Path

SCRIPT = Path(__file__).parents[2] / "scripts/quality/wheel-licences"
INFO = "crossgait-0.1.0.dist-info/"
THIRD = f"{INFO}licenses/third-party/"
LIBRARY = {"type": "file", "name": "/usr/lib/x86_64-linux-gnu/libfmt.so.9.1.0"}
BILL = {"components": [{"name": "libfmt9", "components": [LIBRARY]}, {"name": "three"}]}
WHOLE = {
    f"{INFO}METADATA": "Name: crossgait",
    f"{INFO}sboms/crossgait.cdx.json": json.dumps(BILL),
    f"{INFO}licenses/LICENSE": "Apache",
    f"{THIRD}libfmt9": "On Debian systems: /usr/share/common-licenses/GPL-2.",
    f"{THIRD}three": "MIT",
    f"{THIRD}common-licenses/GPL-2": "GPL",
    "crossgait.libs/libfmt-0123abcd.so.9.1.0": "",
    "crossgait/_core.so": "",
}


class WheelLicences(unittest.TestCase):
    def judged(self, files):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "crossgait-0.1.0-py3-none-any.whl"
            with zipfile.ZipFile(file, "w") as wheel:
                for name, text in files.items():
                    wheel.writestr(name, text)
            done = subprocess.run([sys.executable, SCRIPT, file], capture_output=True, text=True, check=False)
        return done.returncode, done.stdout + done.stderr

    def test_takes_a_wheel_with_all_of_them(self):
        code, said = self.judged(WHOLE)
        self.assertEqual(code, 0, said)
        self.assertIn("all 2 parts", said)

    def test_takes_a_library_named_by_its_soname(self):
        files = {name.replace("so.9.1.0", "so.9"): text for name, text in WHOLE.items()}
        self.assertEqual(self.judged(files)[0], 0)

    def test_finds_each_text_that_is_missing(self):
        for name, named in (("libfmt9", "libfmt9"), ("three", "three"), ("common-licenses/GPL-2", "GPL-2")):
            code, said = self.judged({file: text for file, text in WHOLE.items() if file != THIRD + name})
            self.assertEqual(code, 1, said)
            self.assertIn(named, said)
        self.assertEqual(self.judged(WHOLE | {f"{THIRD}three": " \n"})[0], 1)

    def test_finds_a_library_that_the_bill_does_not_have(self):
        for library in ("libgsl-89abcdef.so.27", "libfmt-0123abcd.so.8", "libfm-0123abcd.so.9"):
            code, said = self.judged(WHOLE | {f"crossgait.libs/{library}": ""})
            self.assertEqual(code, 1, said)
            self.assertIn(library, said)

    def test_refuses_what_is_no_wheel_of_ours(self):
        for missing in ("METADATA", "sboms/crossgait.cdx.json", "licenses/LICENSE"):
            code, said = self.judged({file: text for file, text in WHOLE.items() if file != INFO + missing})
            self.assertEqual(code, 2, said)
            self.assertIn(missing.split("/")[-1], said)


if __name__ == "__main__":
    unittest.main()
