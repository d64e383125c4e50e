"""Engines that come with Crossgait and run in processes of their own, each optional by its package.

`--engine python:drake` serves `crossgait.engines.drake`; docs/engines-in-processes.md.
"""
