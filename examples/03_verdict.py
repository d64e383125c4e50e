"""Judges whether a trot depends on the engine, and what in the engines it comes from."""

import crossgait

verdict = crossgait.verdict("trot", terrain="rough", seconds=0.5, starts=6, explain=True)
print(verdict.word)
print(verdict)
print("why:", verdict.causes)
