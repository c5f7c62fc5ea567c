"""Frames that measures take once the robot is there.

Measured with Fetch in house_test_1/00, 01 and 03 by `python results/mitigations.py`: an extinguisher put
down 66 to 112 frames; seats of fire 20 to 35 frames of jet for each flame that burns when the jet is opened. A door:
246 frames beyond the way to it, the mean of 23 doors in eight homes of `train` (the same with `doors`).
"""

from __future__ import annotations

DOOR = 250.0  # to take a handle, step aside where it must, turn the leaf and fold the arm
BOARD = 190.0  # to set a flood board that is carried to its rails: 228 and 285 with ways up to 2.5 m [measured: two]
PUT_DOWN = 85.0  # to put a tool on the floor
PIN = 60.0  # to pull the pin of an extinguisher, once [hazard_ms.skills.mitigations.extinguish: 2 s]
FIGHT = 50.0  # to turn to the flames of a seat, and of ways beyond those that are planned
FLAME = 20.0  # of jet for each flame or thing that burns when it is planned; UNEXPECTED in choice.py counts for others
