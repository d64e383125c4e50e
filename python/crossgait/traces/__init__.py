"""Traces: what a walk looked like over time, as columns, CSV, and files for viewers."""

from __future__ import annotations

from crossgait.traces.table import Numbers
from crossgait.traces.trace import Trace

__all__ = ["Numbers", "Trace"]
