"""Judges a controller of your own: a crawl in ten lines, which shifts the feet against the body's roll."""

import numpy as np

import crossgait

OFFSET = np.array([0.25, 0.75, 0.0, 0.5])  # when FL, FR, RL and RR lift off, in cycles
SIDE = np.array([1, -1, 1, -1])  # left feet are at +y
CYCLE, SWING, STEP, LIFT, DEPTH = 0.6, 0.15, 0.04, 0.03, 0.065  # s, of a cycle, m, m, m


def make():
    """Return a function of the robot's state: feet in their leg frames, 4 x 3, m."""

    def feet(state: crossgait.State) -> np.ndarray:
        phase = (state.time / CYCLE - OFFSET) % 1
        swings = phase < SWING
        share = np.where(swings, phase / SWING, (phase - SWING) / (1 - SWING))
        x = np.where(swings, STEP * (share - 0.5), STEP * (0.5 - share))
        z = -DEPTH + LIFT * np.sin(np.pi * share) * swings + 0.02 * SIDE * state.roll_pitch_yaw[0]
        return np.stack([x, np.zeros(4), z], axis=1)

    return feet


crawl = crossgait.Controller(make, crossgait.Walk(seconds=1.2), targets="feet", name="crawl")
print(crossgait.compare(crawl))
verdict = crossgait.verdict(crawl, starts=6, explain=True)
print(verdict)
print("to blame:", verdict.causes)
