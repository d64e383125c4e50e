"""What commands print."""

from __future__ import annotations

import pytest

from crossgait.commands import exit_code, say
from crossgait.errors import ConfigError


def test_control_characters_do_not_reach_the_terminal(capsys: pytest.CaptureFixture[str]) -> None:
    say("a\x1b]0;title\x07b\x7f\x9b31m\r\tü\n")
    assert capsys.readouterr().out == "a\\x1b]0;title\\x07b\\x7f\\x9b31m\\x0d\tü\n\n"


def test_errors_are_of_one_way_out(capsys: pytest.CaptureFixture[str]) -> None:
    def work() -> int:
        raise ConfigError("f\x1b.yaml", "key\x00", "one", "\x1b[31mtwo")

    assert exit_code("crossgait.sweep", work) == 2
    assert capsys.readouterr().err == "crossgait.sweep: f\\x1b.yaml: key\\x00: expected one, found \\x1b[31mtwo\n"
