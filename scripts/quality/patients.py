"""What scripts/quality/blind-patients and scripts/quality/planted-faults share: asking the program, and an observation's terms."""
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = ROOT / "build" / "release" / "apps" / "crossgait"
LEGS = ("FL", "FR", "RL", "RR")


def crossgait(*arguments, codes=(0,)):
    """What the program prints. Ends this one if its exit code is none of `codes`."""
    done = subprocess.run([str(PROGRAM), *map(str, arguments)], capture_output=True, text=True)
    if done.returncode not in codes:
        print(f"crossgait {' '.join(map(str, arguments))}: {done.stderr.strip()}", file=sys.stderr)
        sys.exit(2 if done.returncode == 2 else 1)
    return done.stdout


def terms_of(env):
    """The observation's terms as dictionaries, in place."""
    env["observation"] = [term if isinstance(term, dict) else {"block": term} for term in env["observation"]]
    return env["observation"]


def scaled(term, factors):
    """Multiply the term's scale by a factor for each of its numbers."""
    scale = term.get("scale", 1)
    numbers = scale if isinstance(scale, list) else [scale]
    numbers = numbers * len(factors) if len(numbers) == 1 else numbers
    term["scale"] = [n * f for n, f in zip(numbers, factors, strict=True)]
