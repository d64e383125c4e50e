"""Rows: never lost, never made twice, and the same whoever makes them."""

from __future__ import annotations

import errno
import fcntl
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from sweep_studies import SHORT, Serial, crash, hashes, lines, serial_rows, study, study_file

import crossgait
from crossgait import ConfigError
from crossgait.files import lock
from crossgait.sweep import ProcessPool, RowFile, Run, Summary, load, sweep, write_sorted
from crossgait.sweep.__main__ import main

pytest.importorskip("yaml")
ENGINE = crossgait.available_engines()[0]
SHORT = SHORT.format(engine=ENGINE)
COMMAND = [sys.executable, "-m", "crossgait.sweep"]


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> list[Run]:
    return study(tmp_path_factory.mktemp("short"), SHORT).runs()


@pytest.fixture(scope="module")
def serial(runs: list[Run]) -> list[bytes]:
    return serial_rows(runs)


def hash_of(row: bytes) -> str:
    return str(json.loads(row)["hash"])


def test_rows_are_the_cores_stored_runs(runs: list[Run], serial: list[bytes]) -> None:
    row = json.loads(serial[0])
    assert list(row) == ["hash", "run", "result"]
    assert row["run"]["schema"] == {"name": "run", "version": 5}
    assert {json.loads(line)["hash"] for line in serial} == {run.hash for run in runs}
    result = dict(row["result"])
    assert result.pop("outcome") == "walked"
    assert set(result) >= {"seconds", "distance_m", "slip_m", "cost_of_transport"}
    assert all(np.isfinite(value) for value in result.values())


def test_a_pool_makes_the_rows_of_a_loop_bit_for_bit(runs: list[Run], serial: list[bytes], tmp_path: Path) -> None:
    told: list[int] = []
    file = tmp_path / "rows.jsonl"
    summary = sweep(runs, file, lambda: ProcessPool(2), listener=lambda s: told.append(s.made))
    assert lines(file) == serial
    assert (summary.made, summary.failed, summary.missing, summary.interrupted) == (16, 0, 0, False)
    assert summary.workers == 2
    assert told == sorted(told)
    assert told[-1] == 16
    again = sweep(runs, file, lambda: pytest.fail("there is nothing to make"))
    assert (again.made, again.there_before) == (0, 16)
    assert lines(file) == serial


def test_a_sweep_that_is_killed_goes_on(runs: list[Run], serial: list[bytes], tmp_path: Path) -> None:
    path, file = study_file(tmp_path, SHORT), tmp_path / "study.jsonl"
    killed = subprocess.Popen([*COMMAND, str(path), "--workers", "1"], start_new_session=True)
    while not file.exists() or file.stat().st_size == 0:
        assert killed.poll() is None
        time.sleep(0.002)
    killed.kill()
    killed.wait()
    kept = file.read_bytes()
    assert 0 < kept.count(b"\n") < 16
    # Its worker ends by itself, in the middle of whatever it does, and lets go of nothing: the lock is the sweep's.
    done = subprocess.run([*COMMAND, str(path), "--workers", "1", "--json", "-"], stdout=subprocess.PIPE, check=True)
    summary = json.loads(done.stdout)
    whole = kept[: kept.rindex(b"\n") + 1]
    assert summary["there_before"] == whole.count(b"\n")
    assert summary["made"] == 16 - summary["there_before"]
    assert file.read_bytes().startswith(whole)
    assert lines(file) == serial


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interruption_keeps_what_there_is(tmp_path: Path, number: signal.Signals) -> None:
    path, file = study_file(tmp_path, SHORT.replace("starts: 4", "starts: 4000")), tmp_path / "study.jsonl"
    sweeping = subprocess.Popen([*COMMAND, str(path), "--workers", "1"], stderr=subprocess.PIPE, text=True)
    while not file.exists() or file.stat().st_size == 0:
        assert sweeping.poll() is None
        time.sleep(0.01)
    sweeping.send_signal(number)
    _, told = sweeping.communicate(timeout=60)
    assert sweeping.returncode == 130
    kept = file.read_bytes()
    assert kept.endswith(b"\n")
    assert told == (f"interrupted: {kept.count(10)} of 16000 runs are in {file}; the same command goes on from here\n")


def test_a_torn_last_line_is_made_again(runs: list[Run], serial: list[bytes], tmp_path: Path) -> None:
    file = tmp_path / "rows.jsonl"
    file.write_bytes(b"".join(serial)[:-40])
    assert len(load(file)) == 15
    executor = Serial()
    sweep(runs, file, lambda: executor)
    assert executor.made == [json.loads(serial[-1])["hash"]]
    assert lines(file) == serial


def test_a_whole_last_line_without_its_end_is_kept(serial: list[bytes], tmp_path: Path) -> None:
    file = tmp_path / "rows.jsonl"
    file.write_bytes(b"".join(serial[:2])[:-1])
    assert len(load(file)) == 2
    with RowFile(file) as rows:
        assert [rows.has_failed(hash_of(row)) for row in serial[:3]] == [False, False, None]
        rows.add(serial[2].decode().strip())
    assert file.read_bytes() == b"".join(serial[:3])


def _others(row: bytes) -> list[bytes]:
    """Files that are no store, and no beginning of one."""
    return [
        b"my only notes, no newline at the end",
        b'{"hash": "00", "notes": "one line, as json.dump writes it"}',
        b'{"hash":"00","run":{},"notes":[]}',
        (row + row).replace(b"\n", b"\r"),
        row[:-1] + b" and a remark",
        b"\x7fELF\x00\x01\x02\xff",
        row + b"notes",
        row + bytes(9),
        row + b'{"hash":"my',
        b'{"hash":"my dict',
        b'{"hash":"0123456789abcdef',
        b'{"hash":"0123456789abcdef","my":[',
        b"{",
    ]


def test_a_file_that_is_something_else_is_left_as_it_is(serial: list[bytes], tmp_path: Path) -> None:
    file = tmp_path / "rows.jsonl"
    for other in _others(serial[0]):
        file.write_bytes(other)
        with pytest.raises(ConfigError, match=r"expected a stored run|expected text"):
            RowFile(file)
        assert file.read_bytes() == other


@pytest.mark.parametrize("replaced", [True, False])
def test_a_store_that_is_replaced_or_removed_meanwhile_is_an_error(
    serial: list[bytes], tmp_path: Path, replaced: bool
) -> None:
    file = tmp_path / "rows.jsonl"

    def write(rows_after: int) -> None:
        with RowFile(file) as rows:
            rows.add(serial[0].decode().strip())
            file.unlink()
            if replaced:
                file.write_text("somebody's")
            for row in serial[1 : 1 + rows_after]:
                rows.add(row.decode().strip())

    for rows_after in (0, 1):
        file.unlink(missing_ok=True)
        with pytest.raises(ConfigError, match="what was added since is lost"):
            write(rows_after)


def test_what_another_program_wrote_is_not_cut_off(serial: list[bytes], tmp_path: Path) -> None:
    file = tmp_path / "rows.jsonl"
    file.write_bytes(serial[0] + serial[1][:-30])
    with RowFile(file) as rows:
        with file.open("ab") as other:
            other.write(b"somebody's")
        before = file.read_bytes()
        with pytest.raises(ConfigError, match="another program writes it"):
            rows.add(serial[2].decode().strip())
        assert file.read_bytes() == before


def test_the_core_and_sweeps_keep_each_other_out(serial: list[bytes], tmp_path: Path) -> None:
    file = tmp_path / "rows.jsonl"
    file.write_bytes(serial[0][:-40])
    verdict = [sys.executable, "-m", "crossgait", "verdict", "--seconds", "0.1", "--settle", "0.1", "--starts", "4"]
    with RowFile(file):
        refused = subprocess.run([*verdict, "--runs", str(file)], capture_output=True, text=True, check=False)
    if "expected two or more engines" in refused.stderr:
        pytest.skip("one engine alone")
    assert refused.returncode == 2
    assert f"one that process {os.getpid()} is writing" in refused.stderr
    assert file.read_bytes() == serial[0][:-40]
    subprocess.run([*verdict, "--runs", str(file)], capture_output=True, check=True)
    with RowFile(file) as rows:  # which the core has repaired, and filled
        assert all(rows.has_failed(hash_of(row)) is False for row in file.read_bytes().splitlines())


def test_a_file_system_without_locks_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def flock(file: int, operation: int) -> None:
        raise OSError(errno.EOPNOTSUPP, os.strerror(errno.EOPNOTSUPP))

    monkeypatch.setattr(fcntl, "flock", flock)
    with (tmp_path / "lock").open("w") as file, pytest.raises(ConfigError, match="expected a file system with locks"):
        lock(file.fileno(), tmp_path, "folder", "one run at a time")


def test_rows_are_not_sorted_into_their_own_file(serial: list[bytes], tmp_path: Path) -> None:
    file = tmp_path / "rows.jsonl"
    file.write_bytes(b"".join(serial))
    with pytest.raises(ConfigError, match="--sorted: expected a file that is not read"):
        write_sorted(file, [], tmp_path / "." / "rows.jsonl")
    assert file.read_bytes() == b"".join(serial)


@pytest.mark.parametrize(
    "line",
    [
        "{",
        "[]",
        '{"hash":"x","result":{}}',
        '{"hash":"0123456789abcdef","result":{}}',
        '{"hash": 3, "result": {}}',
        '{"hash": "a"}',
        "\xff",
    ],
)
def test_a_line_that_is_no_row_is_named(serial: list[bytes], tmp_path: Path, line: str) -> None:
    file = tmp_path / "rows.jsonl"
    file.write_bytes(serial[0] + line.encode("latin-1") + b"\n")
    for read in (RowFile, load):
        with pytest.raises(ConfigError, match="line 2: expected a stored run") as caught:
            read(file)
        assert caught.value.source == str(file)
    assert file.read_bytes().startswith(serial[0] + line.encode("latin-1"))  # nothing was touched


def test_two_sweeps_do_not_write_one_file(tmp_path: Path, serial: list[bytes]) -> None:
    file = tmp_path / "study.jsonl"
    path = study_file(tmp_path, SHORT)
    with RowFile(file) as rows:
        rows.add(serial[0].decode().strip())
        with pytest.raises(ConfigError, match=f"one that process {os.getpid()} is writing"):
            RowFile(file)
        other = subprocess.run([*COMMAND, str(path)], capture_output=True, text=True, check=False)
        assert other.returncode == 2
        assert f"one writer at a time, found one that process {os.getpid()} is writing" in other.stderr
    assert file.read_bytes() == serial[0]
    with RowFile(file) as rows:  # and afterwards the next one may
        assert rows.has_failed(hash_of(serial[0])) is False
        assert rows.has_failed("no hash") is None


def test_a_row_that_finds_no_room_leaves_nothing(tmp_path: Path, serial: list[bytes]) -> None:
    import resource

    file = tmp_path / "rows.jsonl"
    before, handler = resource.getrlimit(resource.RLIMIT_FSIZE), signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    with RowFile(file) as rows:
        rows.add(serial[0].decode().strip())
        try:
            resource.setrlimit(resource.RLIMIT_FSIZE, (len(serial[0]) + 100, before[1]))
            with pytest.raises(ConfigError, match="room"):
                rows.add(serial[1].decode().strip())
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, before)
            signal.signal(signal.SIGXFSZ, handler)
    assert file.read_bytes() == serial[0]


def test_a_run_that_cannot_be_made_is_a_row(tmp_path: Path) -> None:
    text = f"engines: [{ENGINE}]\nwalks: [{{physics_dt: [0.001, 0.0015], control_dt: 0.002, seconds: 0.1}}]\n"
    runs = study(tmp_path, text).runs()
    file = tmp_path / "rows.jsonl"
    summary = sweep(runs, file, Serial)
    assert (summary.made, summary.failed) == (2, 1)
    table = load(file)
    assert table.loc[runs[0].hash, "error"] is None or table["error"].isna()[runs[0].hash]
    assert "0.0015" in table.loc[runs[1].hash, "error"]
    assert table.loc[runs[1].hash, "behaviour.physics_dt"] == 0.0015
    assert sweep(runs, file, lambda: pytest.fail("it is there")).made == 0
    assert sweep(runs, file, Serial, retry_failed=True).made == 1
    assert len(load(file)) == 2


def test_what_differs_where_it_is_made_is_a_failure(tmp_path: Path, runs: list[Run]) -> None:
    run = runs[0]
    other = Run(run.subject, run.engine, run.variation, run.start, "0" * 16)  # as a node with another version has it
    sweep([other], tmp_path / "rows.jsonl", Serial)
    (row,) = map(json.loads, lines(tmp_path / "rows.jsonl"))
    assert row["hash"] == "0" * 16
    assert run.hash in row["error"]
    assert "result" not in row


def test_a_crash_is_tried_again_and_then_a_row(runs: list[Run], serial: list[bytes], tmp_path: Path) -> None:
    file = tmp_path / "rows.jsonl"
    outcomes = {runs[0].hash: ["crashed"], runs[1].hash: ["crashed"] * 2, runs[2].hash: ["lost"] * 5}
    summary = sweep(runs, file, lambda: Serial(outcomes))
    assert (summary.made, summary.failed, summary.crashes, summary.lost) == (16, 1, 3, 5)
    rows = {name: line for name, line in zip(hashes(file), file.read_bytes().splitlines(keepends=True), strict=True)}
    assert "signal SIGSEGV" in json.loads(rows[runs[1].hash])["error"]
    assert json.loads(rows[runs[1].hash])["run"]["start"] == runs[1].start
    del rows[runs[1].hash]
    assert set(rows.values()) < set(serial)


def test_a_process_that_dies_is_replaced(runs: list[Run], serial: list[bytes], tmp_path: Path) -> None:
    some = runs[:4]
    summary = sweep(some, tmp_path / "rows.jsonl", lambda: ProcessPool(1, crash))
    assert (summary.made, summary.failed, summary.crashes) == (4, 1, 2)
    rows = lines(tmp_path / "rows.jsonl")
    (failed,) = (row for row in map(json.loads, rows) if "error" in row)
    assert failed["hash"] == some[1].hash
    assert "SIGSEGV" in failed["error"]
    assert len(set(rows) & set(serial)) == 3


def test_workers_that_do_not_start_are_an_error(tmp_path: Path) -> None:
    program = """
import os
if __name__ == "__mp_main__":
    os._exit(3)
import sys
from crossgait.sweep import ProcessPool
pool = ProcessPool(1)
try:
    while True:
        pool.wait(1)
except RuntimeError as error:
    print(error)
pool.close()
"""
    (tmp_path / "program.py").write_text(program)
    done = subprocess.run([sys.executable, tmp_path / "program.py"], capture_output=True, text=True, check=True)
    assert done.stdout == "a worker process ended before its first task (exit code 3)\n"


def test_sorted_rows_are_in_the_grids_order(runs: list[Run], serial: list[bytes], tmp_path: Path) -> None:
    file = tmp_path / "rows.jsonl"
    file.write_bytes(b"".join(serial) + b'{"hash":"00000000000000aa","error":"of another study"}\n' + serial[0][:50])
    assert write_sorted(file, [run.hash for run in runs], tmp_path / "sorted.jsonl") == 16
    assert hashes(tmp_path / "sorted.jsonl") == [run.hash for run in runs]
    assert lines(tmp_path / "sorted.jsonl") == serial


def test_rows_are_a_table(serial: list[bytes], tmp_path: Path) -> None:
    file = tmp_path / "rows.jsonl"
    file.write_bytes(b"".join(serial))
    table = load(file)
    assert len(table) == 16
    assert set(table["behaviour.terrain"]) == {"flat", "rough"}
    assert set(table["behaviour.parameters.step_height"]) == {0.02, 0.03}
    first = json.loads(serial[0])
    assert table.loc[first["hash"], "distance_m"] == first["result"]["distance_m"]  # every digit
    assert table["mean_speed_mps"].to_numpy() == pytest.approx(
        (table["distance_m"] / table["simulated_seconds"]).to_numpy()
    )
    assert table["error"].isna().all()
    failed = json.dumps({"hash": first["hash"], "run": None, "error": "again, elsewhere"}).encode() + b"\n"
    file.write_bytes(serial[0] + failed)  # as of two files put together
    assert load(file)["error"].isna().all()
    assert write_sorted(file, [first["hash"]], tmp_path / "one.jsonl") == 1
    assert lines(tmp_path / "one.jsonl") == [serial[0]]
    file.write_bytes(b"")
    assert len(load(file)) == 0


def test_a_verdict_of_a_sweeps_rows_makes_no_run(tmp_path: Path) -> None:
    by_laws = {str(e.laws): e.name for e in crossgait.engines() if e.available}
    if len(by_laws) < 2:
        pytest.skip("needs engines of two laws")
    engines = list(by_laws.values())[:2]
    text = (
        f"engines: [{', '.join(engines)}]\nvariations: all\nstarts: 4\n"
        "walks: [{gait: trot, terrain: rough, seconds: 0.2}]\n"
    )
    runs, file = study(tmp_path, text).runs(), tmp_path / "rows.jsonl"
    sweep(runs, file, lambda: ProcessPool(2))
    rows = file.read_bytes()
    options = {"engines": engines, "terrain": "rough", "seconds": 0.2, "starts": 4}
    judged = crossgait.verdict("trot", runs=file, **options)
    assert file.read_bytes() == rows
    assert len(rows.splitlines()) == len(runs)
    assert judged.pairs == crossgait.verdict("trot", **options).pairs
    with file.open("ab") as more:  # runs that failed count as not there
        more.write(b'{"hash":"0000000000000000","run":null,"error":"signal SIGSEGV"}\n')
    assert crossgait.verdict("trot", runs=file, **options).word == judged.word


def test_the_command_teaches_and_counts(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = str(study_file(tmp_path, SHORT))
    assert main([path, "--dry-run"]) == 0
    told = capsys.readouterr().out.splitlines()
    assert told[0] == "16 runs"
    assert len(told) == 12
    assert told[-1].strip() == "and 6 more"
    assert main([path, "--print-config"]) == 0
    assert "heading_hold: true" in capsys.readouterr().out
    assert os.listdir(tmp_path) == ["study.yaml"]  # neither made anything
    assert main([str(tmp_path / "none.yaml")]) == 2
    assert "none.yaml" in capsys.readouterr().err
    with pytest.raises(SystemExit) as ended:
        main(["--help"])
    assert ended.value.code == 0
    assert "axis of the grid" in capsys.readouterr().out


def test_the_command_writes_rows_and_a_summary(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], serial: list[bytes]
) -> None:
    path = str(study_file(tmp_path, SHORT))
    files = {name: str(tmp_path / name) for name in ("rows.jsonl", "sorted.jsonl", "summary.json")}
    options = ["--runs", files["rows.jsonl"], "--sorted", files["sorted.jsonl"], "--json", files["summary.json"]]
    assert main([path, "--workers", "2", *options]) == 0
    shown = capsys.readouterr()
    assert shown.out.startswith("16 of 16 runs made")
    assert shown.err == ""  # nobody is looking
    summary = json.loads(Path(files["summary.json"]).read_text())
    assert (summary["runs"], summary["made"], summary["missing"]) == (16, 16, 0)
    assert lines(Path(files["sorted.jsonl"])) == lines(Path(files["rows.jsonl"])) == serial


def test_a_summary_counts() -> None:
    summary = Summary(runs=10, there_before=2, made=4, seconds=2)
    assert (summary.missing, summary.runs_per_second) == (4, 2)
    assert Summary(runs=1).runs_per_second == 0


def test_axes_of_a_study_are_columns_to_group_by(tmp_path: Path) -> None:
    text = """
    engines: [mujoco]
    starts: 2
    walks: [{gait: trot, seconds: 0.1, settle: 0.1, parameters: {step_height: [0.02, 0.03]}}]
    policies:
      - policy: [zero, random]
        set: {friction: [0.4, 0.8], policy_dt: 0.02, episode_seconds: 0.1, settle_seconds: 0.1, adapt: [[step_length]]}
    """
    mine, rows = study(tmp_path, text), tmp_path / "rows.jsonl"
    sweep(mine.runs(), rows, Serial)
    rows.write_text("".join(reversed(rows.read_text().splitlines(keepends=True))))
    other = tmp_path / "other"
    other.mkdir()
    sweep(study(other, "engines: [mujoco]\nwalks: [{gait: walk, seconds: 0.1}]").runs(), rows, Serial)
    table = load(rows, mine)
    assert list(table.index) == [run.hash for run in mine.runs()]  # its own alone, in its order
    assert list(load(rows, mine.source).columns) == list(table.columns)
    axes = list(table.columns[:3])
    assert sorted(axes) == ["friction", "policy", "step_height"]
    policies = table[table["policy"].notna()]
    assert list(policies.groupby(["policy", "friction"]).size()) == [2, 2, 2, 2]
    assert list(policies["friction"]) == list(policies["behaviour.environment.friction"])
    assert set(policies["behaviour.environment.adapt"]) == {("step_length",)}
    assert np.allclose(table["simulated_seconds"], 0.1)
    assert len(load(rows)) == len(table) + 1
    for column in table.columns:
        table.groupby(column).size()  # nothing in it that cannot be grouped


def test_what_a_run_holds_is_not_taken_for_the_rows_own(serial: list[bytes], tmp_path: Path) -> None:
    row = {"hash": "0123456789abcdef", "run": {"hash": 1, "error": "none really"}, "error": "crashed"}
    (tmp_path / "rows.jsonl").write_text(json.dumps(row) + "\n")
    table = load(tmp_path / "rows.jsonl")
    assert table.loc["0123456789abcdef", "error"] == "crashed"
    renamed = serial[0].replace(b',"run":{', b',"xun":{', 1)
    (tmp_path / "rows.jsonl").write_bytes(renamed)
    with pytest.raises(ConfigError, match="that of a run, found no run"):
        load(tmp_path / "rows.jsonl")


def test_options_of_the_command_are_checked(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = str(study_file(tmp_path, SHORT))
    for workers in ("0", "a", "1e9", "100000"):
        with pytest.raises(SystemExit):
            main([path, "--workers", workers])
        assert f"expected 1 to 1024, found '{workers}'" in capsys.readouterr().err
    assert main([path, "--sorted", "-"]) == 2
    assert "--sorted: expected the name of a file" in capsys.readouterr().err
