"""Frames that measures take once the robot is there, as measured: `python -m hazard_ms.agents.mitigating.costs`."""

from __future__ import annotations

DOOR = 220.0  # to take a handle, turn the leaf and fold the arm [ours]
PUT_DOWN = 80.0  # to put a tool on the floor [ours]
FIGHT = 80.0  # to pull the pin, and to turn to the flames [ours]
FLAME = 12.0  # of jet for each flame or thing that burns [ours]
