"""Behaviours, verdicts and exact limits for scripts/quality/calibrate-verdict."""
import hashlib
import json
import math
import os
import pathlib
import random
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]

# Home height over that of scara_quadruped: the scale of lengths that are drawn.
ROBOTS = {"scara_quadruped": 1.0, "scara_quadruped_long": 1.23, "serial_quadruped": 4.08}
GAITS = ("trot", "walk", "pace", "bound", "pronk", "gallop", "trot:guide", "walk:guide", "gallop:guide")


class Failed(Exception):
    """The program, or the tool, did not do what it was asked to."""


def upper_limit(hits, trials, error=0.05):
    """Above this a share gives so few hits with a probability below `error` (Clopper and Pearson 1934)."""
    if hits >= trials:
        return 1.0
    return _bisect(lambda share: _tail(hits + 1, trials, share) < 1 - error)


def lower_limit(hits, trials, error=0.05):
    return 0.0 if hits == 0 else _bisect(lambda share: _tail(hits, trials, share) < error)


def most_hits(trials, bound=0.05):
    """So many hits still have an upper limit within the bound; with too few trials for that, none are allowed."""
    hits = 0
    while hits + 1 < trials and upper_limit(hits + 1, trials) <= bound:
        hits += 1
    return hits


def _bisect(is_below):
    low, high = 0.0, 1.0
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if is_below(middle) else (low, middle)
    return high


def _tail(successes, trials, share):
    """Probability of at least so many."""
    if share <= 0 or share >= 1:
        return 1.0 if share >= 1 or successes <= 0 else 0.0
    terms = (math.exp(math.lgamma(trials + 1) - math.lgamma(k + 1) - math.lgamma(trials - k + 1)
                      + k * math.log(share) + (trials - k) * math.log1p(-share)) for k in range(successes, trials + 1))
    return min(1.0, sum(terms))


def mean(values):
    return sum(values) / len(values)


def median(values):
    ordered, half = sorted(values), len(values) // 2
    return ordered[half] if len(values) % 2 else (ordered[half - 1] + ordered[half]) / 2


class Truth:
    """What a pool of differences of one statistic is, for the trials that are drawn of it.

    Samples in which a run ends early are judged by the median of all; others speak of the pairs in which none does."""

    def __init__(self, differences, early):
        whole = [value for value, ends in zip(differences, early, strict=True) if not ends] or differences
        self.all = {"mean": mean(differences), "median": median(differences)}
        self.whole = {"mean": mean(whole), "median": median(whole)}
        self.regular = is_regular(differences)

    def of(self, statistic, found):
        """What this trial's interval has to hold. Shares of outcomes are of all pairs."""
        return (self.all if statistic["is_share"] or found["cut_pairs"] else self.whole)[statistic["estimand"]]

    def planted(self, ends_early):
        return self.all["median" if ends_early else "mean"]


def is_regular(values):
    """Neither skewed (by a third standardised moment of 1 or more) nor so tied that one value makes up a tenth of them."""
    middle = mean(values)
    deviation = math.sqrt(mean([(value - middle) ** 2 for value in values]))
    if deviation == 0 or max(values.count(value) for value in set(values)) >= 0.1 * len(values):
        return False
    return abs(mean([((value - middle) / deviation) ** 3 for value in values])) < 1


def draw_terrain(draw, size):
    kind = draw.choice(("flat", "rough", "slope", "stairs", "steps", "waves"))
    low = f"{draw.uniform(0.002, 0.015) * size:.4f}"
    return {"flat": "flat", "rough": f"rough:amplitude={low},length={0.15 * size:.3f}",
            "slope": f"slope:angle={draw.uniform(1, 8):.2f},heading={draw.uniform(0, 360):.0f}",
            "stairs": f"stairs:rise={low},run={0.2 * size:.3f},start={0.3 * size:.3f}",
            "steps": f"steps:height={low},block={0.1 * size:.3f}",
            "waves": f"waves:amplitude={low},wavelength={0.4 * size:.3f}"}[kind]


def draw_setting(seed, number):
    """One setting of a verdict: robot, gait, ground, starts; every sixth an environment that randomises."""
    draw = random.Random(f"{seed}/{number}")
    robot = draw.choice(list(ROBOTS))
    setting = {"robot": robot, "gait": draw.choice(GAITS), "terrain": draw_terrain(draw, ROBOTS[robot]),
               "seconds": draw.choice((1.5, 2.0, 2.5)), "friction": round(draw.uniform(0.3, 1.2), 3)}
    starts = {"seed": draw.randrange(1, 10**6), "heading": round(draw.uniform(0, 1.5), 3)}
    if draw.random() < 0.5:
        starts["push"] = round(draw.uniform(0, 0.6) * math.sqrt(ROBOTS[robot]), 3)
    if draw.random() < 0.5:
        starts["offset"] = round(draw.uniform(0, 0.5) * ROBOTS[robot], 3)
    if number % 6 == 5:
        return {"environment": environment(setting, draw.uniform(0.1, 0.6)), **starts}
    return setting | starts


def environment(setting, width):
    """The same walk as a policy that does nothing, with friction, masses and gains that differ from start to start."""
    ranges = "".join(f"  {key}: [{1 - width * low:.3f}, {1 + width * high:.3f}]\n" for key, low, high in (
        ("friction", 1, 1.5), ("trunk_mass", 0.7, 1), ("mass", 0.3, 0.3), ("servo_stiffness", 0.5, 0.5), ("joint_damping", 0.5, 1)))
    return (f"robot: {setting['robot']}\nterrain: '{setting['terrain']}'\nfriction: {setting['friction']}\ngait: {setting['gait']}\n"
            f"episode_seconds: {setting['seconds']}\nrandomisation:\n{ranges}")


def with_file(setting, folder):
    """The setting with its environment written to a file, which is called by what is in it."""
    if "environment" not in setting:
        return setting
    text = setting["environment"]
    file = folder / f"{hashlib.sha256(text.encode()).hexdigest()[:16]}.yaml"
    if not file.exists():
        file.with_suffix(".partial").write_text(text)
        file.with_suffix(".partial").rename(file)
    rest = {key: value for key, value in setting.items() if key != "environment"}
    return rest | {"config": str(file), "policy": "zero"}


def command_of(setting):
    """Options of `crossgait verdict`."""
    return [word for key, value in setting.items() for word in (f"--{key}", str(value))]


class Program:
    """`crossgait verdict`, whose runs are kept."""

    def __init__(self, program, workers):
        self.program, self.workers = program, workers

    def verdict(self, setting, engines, starts, runs):
        command = [self.program, "verdict", *command_of(setting), "--engines", ",".join(engines), "--starts", str(starts),
                   "--runs", runs, "--workers", str(self.workers), "--json", "-"]
        done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise Failed(f"{' '.join(map(str, command))}: {done.stderr.strip()}")
        return json.loads(done.stdout)

    def engines(self):
        done = subprocess.run([self.program, "engines", "--json", "-"], capture_output=True, text=True, check=True)
        return {engine["name"] for engine in json.loads(done.stdout)["engines"]}


class Judge:
    """tests/scripts/judge_starts.cpp, which judges whichever starts it is told to by the program's rule."""

    def __init__(self, tool, runs, workers):
        command = [str(tool), "--runs", str(runs), "--workers", str(workers)]
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.stdin.close()
        self.process.wait()
        self.process.stdout.close()

    def ask(self, setup, a, b, starts_a, starts_b=None, **more):
        request = {"setup": setup, "a": a, "b": b, "starts_a": starts_a,
                   "starts_b": starts_a if starts_b is None else starts_b, **more}
        self.process.stdin.write(json.dumps(request) + "\n")
        self.process.stdin.flush()
        answer = self.process.stdout.readline()
        if not answer:
            raise Failed("crossgait_judge_starts ended: what it said is above")
        return json.loads(answer)


class State:
    """What is done, a line of JSON each, so that whoever is stopped goes on from there."""

    def __init__(self, folder, program, tool):
        engines = sorted((program.parent.parent / "engines").glob("*.so"))
        self.folder = folder / digest(program, *engines)
        self.runs = self.folder / "runs"
        self.runs.mkdir(parents=True, exist_ok=True)
        # Runs are the program's alone; what is made of them hangs on the tool as well.
        self.file = self.folder / f"results-{digest(tool)}.jsonl"
        self.done = {}
        if self.file.exists():
            for line in self.file.read_text().splitlines():
                try:
                    row = json.loads(line)
                except json.JSONDecodeError:
                    continue  # cut off when it was stopped: made again
                self.done[row["key"]] = row["result"]

    def once(self, key, make):
        if key not in self.done:
            result = make()
            with open(self.file, "a+", encoding="utf-8") as file:
                if file.tell() > 0 and not self._ends_whole():
                    file.write("\n")
                file.write(json.dumps({"key": key, "result": result}) + "\n")
            self.done[key] = result
        return self.done[key]

    def _ends_whole(self):
        with open(self.file, "rb") as file:
            file.seek(-1, os.SEEK_END)
            return file.read() == b"\n"


def digest(*files):
    told = hashlib.sha256()
    for file in files:
        told.update(pathlib.Path(file).read_bytes())
    return told.hexdigest()[:12]
