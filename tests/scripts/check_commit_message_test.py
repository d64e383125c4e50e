"""Tests scripts/check-commit-message: messages in files, as Git hands them to a hook, and in a repository."""

import os
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

SCRIPT = Path(__file__).parents[2] / "scripts/check-commit-message"


def run(*arguments, **options):
    return subprocess.run(arguments, capture_output=True, text=True, check=False, **options)


class InFiles(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.file = Path(folder.name) / "COMMIT_EDITMSG"

    def checked(self, message):
        self.file.write_text(message, encoding="utf-8")
        return run(SCRIPT, self.file)

    def assert_accepted(self, message):
        done = self.checked(message)
        self.assertEqual((done.returncode, done.stderr), (0, ""), message)

    def assert_refused(self, message, *words):
        done = self.checked(message)
        self.assertEqual(done.returncode, 1, message)
        for word in (*words, "CONTRIBUTING.md"):
            self.assertIn(word, done.stderr)

    def test_a_subject_of_72_characters_and_no_longer_one(self):
        self.assert_accepted("x" * 72)
        self.assert_accepted("x" * 72 + "\n")
        self.assert_refused("x" * 73 + "\n", "73 characters", "at most 72")

    def test_characters_are_counted_and_not_bytes(self):
        self.assert_accepted("é" * 72 + "\n")
        self.assert_refused("é" * 73 + "\n", "73 characters")

    def test_no_full_stop_after_the_subject(self):
        self.assert_refused("Read a robot once.\n\nBody.\n", "ends in a full stop")
        self.assert_accepted("Read version 0.1\n\nBody.\n")

    def test_a_blank_line_before_the_body(self):
        self.assert_accepted("Subject\n\nBody, and a line of it that is as long as it likes" + " to be" * 20 + "\n")
        self.assert_accepted("Subject\n \nBody\n")
        self.assert_refused("Subject\nBody\n", "line 2 is not blank: Body")

    def test_both_faults_are_named(self):
        self.assert_refused("x" * 80 + "\nBody\n", "80 characters", "line 2 is not blank")

    def test_a_message_of_comments_is_empty(self):
        self.assert_refused("", "empty")
        self.assert_refused("\n\n", "empty")
        self.assert_refused("# Please enter the commit message\n", "empty")

    def test_what_git_adds_for_the_editor_does_not_count(self):
        self.assert_accepted("\n# " + "x" * 80 + "\nSubject\n# On branch main\n")
        self.assert_accepted("Subject\n# ------------------------ >8 ------------------------\ndiff --git a b\n")

    def test_subjects_that_git_writes_may_be_longer(self):
        for begin in ("Merge branch '", 'Revert "', "fixup! ", "squash! ", "amend! "):
            self.assert_accepted(begin + "x" * 80 + ".\n")
        self.assert_refused("Merges branch " + "x" * 80, "characters")
        self.assert_refused("Merge x\nBody\n", "line 2 is not blank")

    def test_bad_input_is_no_verdict(self):
        for arguments in ([], ["--help"], [self.file, self.file], [self.file], [self.file.parent], ["--commits"]):
            done = run(SCRIPT, *arguments)
            self.assertEqual(done.returncode, 2, arguments)
            self.assertTrue(done.stderr)


@unittest.skipUnless(shutil.which("git"), "needs git")
class InARepository(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        nobody = {f"GIT_{who}_{what}": "nobody" for who in ("AUTHOR", "COMMITTER") for what in ("NAME", "EMAIL")}
        outside = {key: value for key, value in os.environ.items() if not key.startswith("GIT_")}
        alone = {"GIT_CONFIG_GLOBAL": os.devnull, "GIT_CONFIG_NOSYSTEM": "1"}
        self.options = {"cwd": folder.name, "env": outside | nobody | alone}
        self.git("init", "--quiet")

    def git(self, *arguments):
        done = run("git", *arguments, **self.options)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout.strip()

    def commit(self, message):
        self.git("commit", "--quiet", "--allow-empty", "--cleanup=verbatim", "--message", message)

    def test_the_commits_of_a_range_and_no_others(self):
        self.commit("before " + "x" * 80)
        self.commit("Good")
        self.commit("Good\n\nBecause.")
        done = run(SCRIPT, "--commits", "HEAD~2..HEAD", **self.options)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.commit("Bad\nbody")
        bad = self.git("rev-parse", "HEAD")
        self.commit("Good")
        done = run(SCRIPT, "--commits", "HEAD~4..HEAD", **self.options)
        self.assertEqual(done.returncode, 1)
        self.assertIn(f"{bad[:10]}: line 2 is not blank: body", done.stderr)
        self.assertEqual(done.stderr.count("check-commit-message:"), 1)
        self.assertEqual(run(SCRIPT, "--commits", "HEAD", **self.options).returncode, 1)

    def test_a_range_that_is_none(self):
        self.assertEqual(run(SCRIPT, "--commits", "nowhere..HEAD", **self.options).returncode, 2)

    def test_as_a_hook(self):
        hooks = Path(self.options["cwd"]) / ".git/hooks"
        hooks.mkdir(exist_ok=True)
        (hooks / "commit-msg").symlink_to(SCRIPT)
        self.commit("Good")
        done = run("git", "commit", "--allow-empty", "--message", "x" * 73, **self.options)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("73 characters", done.stderr)
        self.assertEqual(self.git("rev-list", "--count", "HEAD"), "1")


if __name__ == "__main__":
    unittest.main()
