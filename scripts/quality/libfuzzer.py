"""One target under libFuzzer, for coverage-fuzz and python-fuzz.

Seconds are the processor's: beside other work a target takes longer and finds the same. After a finding it goes on. What takes longer than
it may is run again alone, and is a finding if the processor needs that long for it. What was done is added to what earlier runs did."""
import json
import os
import re
import subprocess
import tempfile

LONGEST = 65536  # bytes of an input
PATIENCE = 10  # times what an input may take, on a machine that others use
MOST_FINDINGS = 20  # of a run: more of them say nothing new


def memory_folder():
    """A folder for the file that every input is written to: in memory, where there is such a place."""
    place = "/dev/shm"
    return tempfile.TemporaryDirectory(dir=place if os.access(place, os.W_OK) else None)


def run(command, log, **process):
    """Exit code and seconds of the processor."""
    with open(log, "ab") as file:
        child = subprocess.Popen(command, stdout=file, stderr=file, **process)
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
    return child.returncode, usage.ru_utime + usage.ru_stime


def is_slow(command, path, slowest, log, **process):
    _, seconds = run([*command, f"-timeout={PATIENCE * slowest}", "-runs=1", path], log, **process)
    return seconds > slowest


def sort_slow_ones(command, home, slowest, **process):
    """Moves inputs that took long on the clock alone from findings to slow."""
    (home / "slow").mkdir(exist_ok=True)
    for path in sorted((home / "findings").iterdir()):
        if path.name.startswith(("slow-unit-", "timeout-")) and not is_slow(command, path, slowest, home / "log.txt", **process):
            path.rename(home / "slow" / path.name)


def add(home, this):
    """The row of a target: seconds and executions of this run, and of all."""
    file = home / "done.json"
    done = json.loads(file.read_text()) if file.exists() else {"seconds": 0, "executions": 0}
    done = {key: done[key] + this[key] for key in done}
    file.write_text(json.dumps(done) + "\n")
    return {"target": home.name} | this | {f"all_{key}": value for key, value in done.items()}


def fuzz(command, home, seconds, slowest, corpora, **process):
    """Runs `command`, which libFuzzer is linked to, for `seconds` of the processor. Its row of the table."""
    for name in ("corpus", "findings"):
        (home / name).mkdir(parents=True, exist_ok=True)
    log = home / "log.txt"
    log.unlink(missing_ok=True)
    used, failed, stops = 0.0, False, 0
    while used < 0.95 * seconds and stops <= MOST_FINDINGS:
        options = [f"-max_total_time={max(1, round(seconds - used))}", f"-timeout={PATIENCE * slowest}", f"-report_slow_units={slowest}", "-rss_limit_mb=2048",
                   "-print_final_stats=1", f"-max_len={LONGEST}", f"-artifact_prefix={home / 'findings'}/"]
        code, took = run([*command, *options, home / "corpus", *corpora], log, **process)
        used += took
        stops += code != 0
        if code != 0 and not any((home / "findings").iterdir()):
            failed = True  # it does not begin
            break
    executions = sum(map(int, re.findall(r"stat::number_of_executed_units: *(\d+)", log.read_text(errors="replace"))))
    sort_slow_ones(command, home, slowest, **process)
    row = add(home, {"seconds": round(used), "executions": executions})
    return row | {"failed": failed, "findings": sorted(path.name for path in (home / "findings").iterdir())}
