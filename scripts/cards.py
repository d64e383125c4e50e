"""What scripts/engine-cards and scripts/policy-cards share: asking the program, tables, files that are written whole."""
import json
import os
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))


def ask(program, *arguments):
    """What a command's --json says, also where it says that something failed (exit code 1); ends if there is none."""
    with tempfile.TemporaryDirectory() as folder:
        file = os.path.join(folder, "said.json")
        done = subprocess.run([program, *arguments, "--json", file], capture_output=True, text=True, cwd=ROOT)
        if done.returncode not in (0, 1) or not os.path.exists(file):
            sys.exit(f"crossgait {' '.join(arguments)}: {done.stderr.strip()}")
        with open(file, encoding="utf-8") as text:
            return json.load(text)


def table(head, rows):
    """In Markdown."""
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


def write_whole(path, text):
    """Under another name first, then renamed."""
    with open(path + ".partial", "w", encoding="utf-8") as file:
        file.write(text)
    os.replace(path + ".partial", path)
