"""What tests share."""

from __future__ import annotations

import os

os.environ.setdefault("MPLBACKEND", "Agg")

import numpy as np
import pytest

import crossgait


@pytest.fixture(params=crossgait.available_engines())
def engine(request: pytest.FixtureRequest) -> str:
    """Every engine that is available here."""
    return str(request.param)


def epsilon(*engines: str) -> float:
    """Distance from 1 to the next number of the one that computes in least precision."""
    precision = {engine.name: engine.precision for engine in crossgait.engines()}
    return max(float(np.finfo(precision[name]).eps) for name in engines)


@pytest.fixture(scope="session")
def scara() -> crossgait.Robot:
    return crossgait.Robot.load("scara_quadruped")


@pytest.fixture(autouse=True, scope="session")
def _scratch_is_trusted(tmp_path_factory: pytest.TempPathFactory) -> None:
    """Tests load what they have written, which is not below the folder that they run in."""
    crossgait.trust(tmp_path_factory.getbasetemp())
