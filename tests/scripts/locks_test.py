"""Tests that all that comes from the registries of Python and npm is locked by version and hash (scripts/lock)."""

import json
import re
import tomllib
import unittest
from pathlib import Path

ROOT = Path(__file__).parents[2]
FOLDER = ROOT / "python/requirements"
BY_HAND = {"torch", "torch-cpu"}  # locks without a file of pins
NPM = [ROOT / "web", ROOT / "web/docs"]
COMMANDS = re.compile(
    r"\bpip\s+(install|download|wheel)\b|\bnpm\s+(install|i|add|ci|exec)\b"
    r"|\b(uv\s+(pip\s+install|pip\s+sync|run|tool|sync)|uvx|npx|pipx)\b"
)


def read(file):
    return file.read_text(encoding="utf-8")


def normal(name):
    return re.sub(r"[-_.]+", "-", name).lower()


def pins(file):
    """Names and versions of a file of pins; of a name without a version, that which its constraints say."""
    lines = [line.split(" #")[0].strip() for line in read(file).splitlines() if not line.startswith("#")]
    known = {}
    for line in lines:
        if line.startswith("--constraint "):
            known |= dict(pins(file.parent / line.split()[1]))
    found = []
    for line in lines:
        if not line.startswith("--"):
            name, _, version = line.split(";")[0].strip().partition("==")
            found.append((normal(name), version or known[normal(name)]))
    return found


def locked(file):
    """Entries of a lock: name, version, hashes, and who asks for it."""
    found = []
    for entry in re.findall(r"^[A-Za-z0-9].*\n(?:[ \t].*\n)*", read(file), re.MULTILINE):
        name, version = re.match(r"([\w.-]+)==(\S+)", entry).groups()
        hashes = re.findall(r"--hash=sha256:([0-9a-f]{64})\b", entry)
        via = re.findall(r"#\s+(?:via\s+)?(\S.*)", entry.replace("# via\n", ""))
        found.append((normal(name), version, hashes, via))
    return found


def sources():
    """Scripts of all kinds that may install something."""
    files = [*(ROOT / "scripts").rglob("*"), *(ROOT / "experiments").glob("*"), *(ROOT / ".github").rglob("*.yml")]
    files += [ROOT / ".ci/run", *(ROOT / "tests").rglob("CMakeLists.txt"), *(ROOT / "cmake").glob("*")]
    return [file for file in files if file.is_file() and "__pycache__" not in file.parts]


def commands(text):
    """Each command that installs something, whole, and the line above it."""
    lines = text.splitlines()
    for begin, line in enumerate(lines):
        if line.lstrip().startswith("#") or not COMMANDS.search(spaced(line)):
            continue
        end = begin + 1
        while end < len(lines) and (
            lines[end - 1].endswith("\\")
            or sum(spelt.count("(") - spelt.count(")") for spelt in lines[begin:end]) > 0  # of Python
        ):
            end += 1
        yield spaced(" ".join(lines[begin:end])), lines[begin - 1]


def spaced(line):
    """Without what only tells of a command, and with a command's words apart by blanks, as in a shell."""
    return re.sub(r"[\"',\[\]]+", " ", re.sub(r"(['\"`])(pip|npm) install\b[^'\"`]*\1", "", line))


class Python(unittest.TestCase):
    def test_every_file_of_pins_has_a_lock(self):
        self.assertEqual(
            {file.stem for file in FOLDER.glob("*.txt")} | BY_HAND, {file.stem for file in FOLDER.glob("*.lock")}
        )

    def test_a_lock_has_what_its_pins_say(self):
        for source in sorted(FOLDER.glob("*.txt")):
            asked = pins(source)
            entries = locked(source.with_suffix(".lock"))
            if source.stem == "package":
                entries += locked(FOLDER / "torch.lock")
            named = source.relative_to(ROOT).as_posix()
            with self.subTest(source.name):
                self.assertTrue(asked)
                direct = [(name, version) for name, version, _, via in entries if not via or f"-r {named}" in via]
                self.assertEqual(sorted(direct), sorted(asked), f"{named} has changed: run scripts/lock")
                names = {name for name, *_ in entries}
                for name, _, _, via in entries:
                    parents = {normal(parent) for parent in via if not parent.startswith(("-r ", "-c "))}
                    self.assertLessEqual(parents, names, f"{name} is there for what is not: run scripts/lock")

    def test_every_package_has_hashes_and_none_an_address(self):
        for file in sorted(FOLDER.glob("*.lock")):
            with self.subTest(file.name):
                entries = locked(file)
                self.assertTrue(entries)
                for name, version, hashes, _ in entries:
                    self.assertTrue(hashes, f"{name} {version}")
                self.assertEqual(
                    sum(len(hashes) for _, _, hashes, _ in entries), len(re.findall("--hash=", read(file)))
                )
                self.assertNotRegex(read(file), r"://|\s@\s|--(extra-)?index-url|--find-links|--trusted-host")

    def test_the_build_of_pytorch_for_processors_alone_is_of_the_same_release(self):
        (torch,) = (version for name, version, *_ in locked(FOLDER / "torch.lock") if name == "torch")
        ((name, version, _, _),) = locked(FOLDER / "torch-cpu.lock")
        self.assertEqual((name, version), ("torch", f"{torch}+cpu"))

    def test_what_the_wheel_is_tested_with_is_what_its_extras_take(self):
        project = tomllib.loads(read(ROOT / "pyproject.toml"))["project"]
        extras = [one for extra in ("frames", "mujoco", "plot") for one in project["optional-dependencies"][extra]]
        names = {normal(re.match(r"[\w.-]+", one)[0]) for one in project["dependencies"] + extras}
        self.assertEqual({name for name, _ in pins(FOLDER / "wheel-test.txt")}, names)

    def test_the_release_of_mujoco_that_the_extra_installs_is_locked_with_its_library(self):
        extra = tomllib.loads(read(ROOT / "pyproject.toml"))["project"]["optional-dependencies"]["mujoco"]
        version = dict(pins(FOLDER / "package.txt"))["mujoco"]
        self.assertEqual(extra, [f"mujoco=={version}"])
        self.assertIn(("mujoco-core", version), pins(FOLDER / "engines.txt"))


class Npm(unittest.TestCase):
    def test_a_lock_has_what_its_package_says(self):
        for folder in NPM:
            with self.subTest(folder.name):
                package, lock = (json.loads(read(folder / name)) for name in ("package.json", "package-lock.json"))
                for kind in ("dependencies", "devDependencies"):
                    self.assertEqual(package.get(kind), lock["packages"][""].get(kind), "run scripts/lock")
                    for name, version in package.get(kind, {}).items():
                        self.assertEqual(lock["packages"][f"node_modules/{name}"]["version"], version)

    def test_every_package_has_a_hash_and_none_an_address(self):
        for folder in NPM:
            with self.subTest(folder.name):
                text = read(folder / "package-lock.json")
                entries = {name: entry for name, entry in json.loads(text)["packages"].items() if name}
                self.assertTrue(entries)
                for name, entry in entries.items():
                    self.assertRegex(entry.get("integrity", ""), r"^sha512-[A-Za-z0-9+/]{86}==$", name)
                self.assertNotRegex(text, r"://|\"resolved\"")


class Commands(unittest.TestCase):
    def test_everything_is_installed_by_its_hash_or_says_why_not(self):
        seen = 0
        for file in sources():
            for command, above in commands(read(file)):
                seen += 1
                by_hash = "--require-hashes" in command or re.search(r"\bnpm\s+ci\b", command)
                only_locks = "--package-lock-only" in command
                said = re.search(r"# No hashes: \w", above)
                self.assertTrue(by_hash or only_locks or said, f"{file.relative_to(ROOT)}: {command}")
        self.assertGreater(seen, 5)

    def test_sees_what_is_installed_without_a_hash(self):
        for text in ("pip install torch", 'run([python, "-m", "pip", "install",\n     "torch"])', "npm install three"):
            ((command, _),) = commands("x = 1\n" + text)
            self.assertRegex(command, "torch|three")


if __name__ == "__main__":
    unittest.main()
