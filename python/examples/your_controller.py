"""Your own controller: a function of the robot's state, walked, compared and judged in every engine.

A creeping gait in a dozen lines: each foot in turn is lifted and set forward while the others push the body on.
It looks at the base's roll and shifts the feet against the roll: a little feedback that no engine knows of.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

import crossgait

ORDER = {"FL": 0.25, "FR": 0.75, "RL": 0.0, "RR": 0.5}  # when each leg lifts off, in cycles
SIDE = np.array([1, -1, 1, -1])  # left feet are at +y
CYCLE, DUTY, STEP, LIFT, DEPTH = 0.6, 0.85, 0.04, 0.03, 0.065  # s, -, m, m, m


def make() -> Callable[[crossgait.State], npt.NDArray[np.float64]]:
    """Return a controller that has its own clock."""
    begin: list[float] = []

    def feet(state: crossgait.State) -> npt.NDArray[np.float64]:
        begin.append(state.time) if not begin else None
        clock = (state.time - begin[0]) / CYCLE
        phase = (clock - np.array(list(ORDER.values()))) % 1
        swing = np.clip(phase / (1 - DUTY), 0, 1)
        stance = np.clip((phase - (1 - DUTY)) / DUTY, 0, 1)
        x = np.where(phase < 1 - DUTY, STEP * (swing - 0.5), STEP * (0.5 - stance))
        z = -DEPTH + np.where(phase < 1 - DUTY, LIFT * np.sin(np.pi * swing), 0)
        roll = state.roll_pitch_yaw[0]
        return np.stack([x, np.zeros(4), z + 0.02 * SIDE * roll], axis=1)

    return feet


def main() -> None:
    """Say what the engines make of it."""
    creep = crossgait.Behaviour(make, crossgait.Walk(seconds=1.2), targets="feet", name="creep")
    print(crossgait.compare(creep))
    verdict = crossgait.verdict(creep, starts=4, explain=True)
    print(verdict)
    print("to blame:", verdict.causes)


if __name__ == "__main__":
    main()
