"""Reads a robot's file, says what was inferred, and lets it trot at a quarter of sqrt(g h): 04_your_robot.py [FILE]."""

import sys

import crossgait

file = sys.argv[1] if len(sys.argv) > 1 else "serial_quadruped"
robot = crossgait.Robot.load(file)
print(f"{robot.name}: {robot.mass_kg:.2f} kg, {len(robot.servos)} servos")
for what, value, reason in robot.inferred:
    print(f"  {what}: {value} ({reason})")

speed = 0.25 * (9.81 * robot.standing_height) ** 0.5
print(crossgait.compare("trot", robot=file, command=(speed, 0, 0), seconds=2))
