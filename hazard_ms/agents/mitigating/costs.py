"""Frames that measures take once the robot is there.

Measured with Fetch in house_test_1/00 by `python -m hazard_ms.bench.mitigations`: a door 307 frames beyond the way to
it; a seat of fire of nine flames 145 frames of which no jet flows, and 118 of jet; an extinguisher put down 85.
"""

from __future__ import annotations

DOOR = 300.0  # to take a handle, step aside, turn the leaf and fold the arm
PUT_DOWN = 85.0  # to put a tool on the floor
FIGHT = 120.0  # to get into range, pull the pin, and turn to the flames
FLAME = 13.0  # of jet for each flame or thing that burns
