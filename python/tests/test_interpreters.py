"""Pythons that the package does not run in, and objects that no constructor made."""

from __future__ import annotations

import copy
import importlib.util
import pickle
import subprocess
import sys
import sysconfig

import pytest

import crossgait
from crossgait import _core, interpreter

WITHIN = """
import sys
import _xxsubinterpreters as interpreters
if sys.argv[1] == "main first":
    import crossgait
within = interpreters.create()
for text in ("import crossgait", "from crossgait import _core"):
    try:
        interpreters.run_string(within, text)
    except interpreters.RunFailedError as error:
        assert "crossgait runs in the main interpreter alone" in str(error), error
    else:
        raise SystemExit("was imported")
interpreters.run_string(within, "import sys; assert 'numpy' not in sys.modules")
interpreters.destroy(within)
import crossgait
crossgait.World("scara_quadruped")
"""

AGAIN = """
import sys, crossgait
first = sys.modules.pop("crossgait._core")
try:
    import crossgait._core
except ImportError as error:
    assert "loads once in a process" in str(error), error
else:
    raise SystemExit("was loaded twice")
first.Environment(first.EnvironmentConfig()).reset(1)
"""


@pytest.mark.skipif(
    importlib.util.find_spec("_xxsubinterpreters") is None, reason="another Python names them otherwise"
)
@pytest.mark.parametrize("order", ["main first", "within first"])
def test_sub_interpreters_are_refused(order: str) -> None:
    subprocess.run([sys.executable, "-c", WITHIN, order], check=True, timeout=120)


def test_the_core_is_loaded_once() -> None:
    subprocess.run([sys.executable, "-c", AGAIN], check=True, timeout=120)


def test_free_threaded_pythons_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    interpreter.check()
    monkeypatch.setattr(sysconfig, "get_config_var", lambda name: 1 if name == "Py_GIL_DISABLED" else None)
    with pytest.raises(ImportError, match="needs a Python with the GIL"):
        interpreter.check()


CLASSES = [value for value in vars(_core).values() if isinstance(value, type)]


@pytest.mark.parametrize("kind", CLASSES)
def test_an_object_that_was_not_made_is_a_type_error(kind: type) -> None:
    with pytest.raises(TypeError, match="not safe"):
        object.__new__(kind)


def test_nor_is_one_of_a_class_of_somebody(scara: crossgait.Robot) -> None:
    class Mine(crossgait.World):
        pass

    with pytest.raises(TypeError, match="not safe"):
        object.__new__(Mine)
    with pytest.raises(TypeError):
        copy.copy(crossgait.World(scara))
    config = crossgait.EnvironmentConfig(friction=0.5)
    assert pickle.loads(pickle.dumps(config)).to_yaml() == config.to_yaml()
