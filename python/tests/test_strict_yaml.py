"""YAML within a budget: counted before anything is made of it."""

from __future__ import annotations

import os
import time
from pathlib import Path

import pytest

from crossgait.errors import ConfigError

pytest.importorskip("yaml")
from crossgait.importing import stated
from crossgait.sweep.strict_yaml import MOST_BYTES, MOST_LEVELS, MOST_VALUES, parse_yaml, read_yaml


def bomb(levels: int) -> str:
    """Lists of nine of the one before."""
    lists = ["a0: &a0 [x,x,x,x,x,x,x,x,x]"]
    lists += [f"a{i}: &a{i} [{','.join([f'*a{i - 1}'] * 9)}]" for i in range(1, levels)]
    return "\n".join(lists) + "\n"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (bomb(9), f"at most {MOST_VALUES} values"),
        ("[" * 100_000, f"at most {MOST_LEVELS} levels"),
        ("- " * 100_000, f"at most {MOST_LEVELS} levels"),
        ("{a: " * 1000, f"at most {MOST_LEVELS} levels"),
        ("[" + "a," * MOST_VALUES + "]", f"at most {MOST_VALUES} values"),
        ("a: &a [*a]", "an alias of what stands before it"),
        ("a: *b", "an alias of what stands before it"),
    ],
)
def test_what_is_beyond_the_budget_is_an_error(text: str, expected: str) -> None:
    with pytest.raises(ConfigError) as caught:
        parse_yaml(text, "file.yaml")
    assert caught.value.expected == expected


def test_what_is_within_it_is_read() -> None:
    assert len(parse_yaml("[" + "a," * (MOST_VALUES - 1) + "]", "")) == MOST_VALUES - 1
    assert parse_yaml(bomb(2), "")["a1"] == [["x"] * 9] * 9
    assert parse_yaml("a: &a {b: 1e-3}\nc: {<<: *a, d: 2}\n", "")["c"] == {"b": 1e-3, "d": 2}
    assert parse_yaml("[" * MOST_LEVELS + "]" * MOST_LEVELS, "") is not None


def test_only_regular_files_of_their_size_are_read(tmp_path: Path) -> None:
    pipe, large = tmp_path / "pipe.yaml", tmp_path / "large.yaml"
    os.mkfifo(pipe)
    large.write_text("#" * (MOST_BYTES + 1))
    begin = time.monotonic()
    for path, found in ((pipe, "a pipe or device"), ("/dev/zero", "a pipe or device"), (tmp_path, "Is a directory")):
        with pytest.raises(ConfigError) as caught:
            read_yaml(path)
        assert caught.value.found == found
    with pytest.raises(ConfigError, match=f"at most {MOST_BYTES} bytes"):
        read_yaml(large)
    assert time.monotonic() - begin < 60  # not for ever
    with pytest.raises(ConfigError, match="No such file"):
        read_yaml(tmp_path / "none.yaml")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("? [a, b]\n: 1\n", r"a\.yaml: line 1: expected YAML, found a key that is no text"),
        ("a: {? {b: c} : d}\n", r"a\.yaml: line 1: expected YAML, found a key that is no text"),
        ("a: 1\na: 2\n", r"a\.yaml: line 2: expected YAML, found a stands there twice"),
        ("a: 2020-13-45\n", r"a\.yaml: file: expected YAML, found month must be in 1\.\.12"),
        ("a: !!int text\n", r"a\.yaml: file: expected YAML, found invalid literal"),
        (f"a: {'9' * 5000}\n", r"a\.yaml: file: expected YAML, found Exceeds the limit"),
        ("a: !!no_such_kind 1\n", r"a\.yaml: line 1: expected YAML, found could not determine a constructor"),
        ("a: [1\n", r"a\.yaml: line 2: expected YAML"),
    ],
)
def test_bad_yaml_is_refused(text: str, message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        parse_yaml(text, "a.yaml")


@pytest.mark.parametrize(
    "text", ["? [a, b]\n: 1\n", "a: 2020-13-45\n", "a: !!int text\n", "sim:\n  dt: !!pnt_vos:\n", "a: 1\na: 2\n", ""]
)
def test_bad_yaml_beside_a_policy_is_refused(text: str, tmp_path: Path) -> None:
    file = tmp_path / "env.yaml"
    file.write_text(text)
    with pytest.raises(ConfigError, match=r"env\.yaml"):
        stated.of_yaml(str(file))
