"""Your robot: what its file says, what was inferred, what its legs reach, and whether it walks.

Run it with: python your_robot.py [FILE.urdf or FILE.xml].
"""

from __future__ import annotations

import sys

import numpy as np

import crossgait


def main(name_or_file: str) -> None:
    """Look at a robot and let it trot a quarter of sqrt(g h) in every engine."""
    robot = crossgait.Robot.load(name_or_file)
    print(f"{robot.name}: {robot.mass_kg:.2f} kg, {len(robot.servos)} servos, h = {robot.standing_height:.3f} m")
    for what, value, reason in robot.inferred:
        print(f"  {what}: {value} ({reason})")
    for warning in robot.warnings:
        print(f"  warning: {warning}")

    for name, leg in crossgait.legs(robot).items():
        space = leg.workspace((31, 11, 31))
        reach = space["target"][space["reachable"]]
        low, high = reach.min(axis=0), reach.max(axis=0)
        print(f"{name} ({leg.kind}): reaches x {low[0]:+.3f} to {high[0]:+.3f}, z {low[2]:+.3f} to {high[2]:+.3f} m")

    speed = 0.25 * float(np.sqrt(9.81 * robot.standing_height))
    result = crossgait.compare("trot", robot=name_or_file, command=(speed, 0, 0), seconds=4)
    frame = result.to_frame()
    frame["speed / told"] = frame["mean_speed_mps"] / speed
    print(frame[["outcome", "speed / told", "rms_pitch_deg", "drag", "heading_error_deg"]].round(3))


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "serial_quadruped")
