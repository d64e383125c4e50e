"""Judges whether a trot depends on the engine, and what in the engines it comes from."""

import crossgait

verdict = crossgait.verdict("trot", terrain="rough", seconds=0.5, starts=4, explain=True)
print(verdict.verdict)
print(verdict)
print("to blame:", verdict.causes)
