"""What scripts/cards/engine-cards and scripts/cards/policy-cards share: asking the program, tables, files that are written whole."""
import json
import os
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))


def ask(program, *arguments, codes=(0, 1)):
    """What a command's --json says, also where it says that something failed (exit code 1, or those of `codes`); ends if there
    is none."""
    with tempfile.TemporaryDirectory() as folder:
        file = os.path.join(folder, "said.json")
        done = subprocess.run([program, *arguments, "--json", file], capture_output=True, text=True, cwd=ROOT)
        if done.returncode not in codes or not os.path.exists(file):
            sys.exit(f"crossgait {' '.join(arguments)}: {done.stderr.strip()}")
        with open(file, encoding="utf-8") as text:
            return json.load(text)


class Method:
    """What is measured: the policy, or a gait without one, in an environment."""

    def __init__(self, name, policy, config):
        self.name, self.arguments = name, ["--policy", policy, "--config", config]


def shown(told):
    """What cards say of episodes."""
    mean = {key: told[key]["mean"] for key in ("mean_speed_mps", "cost_of_transport", "swing_contact_ratio", "slip_per_path") if told.get(key)}
    return mean | {"episodes": told["episodes"], "ended_early": told["ended_early"]}


def falls_bound(ended, episodes):
    """Upper end of the exact one-sided 95 % interval of a share (Clopper and Pearson, 1934), by bisection."""
    low, high = ended / episodes, 1.0
    for _ in range(60):
        share = (low + high) / 2
        term = total = (1 - share) ** episodes
        for k in range(ended):
            term *= (episodes - k) / (k + 1) * share / (1 - share)
            total += term
        low, high = (share, high) if total > 0.05 else (low, share)
    return high


def table(head, rows):
    """In Markdown."""
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


def write_whole(path, text):
    """Under another name first, then renamed."""
    with open(path + ".partial", "w", encoding="utf-8") as file:
        file.write(text)
    os.replace(path + ".partial", path)
