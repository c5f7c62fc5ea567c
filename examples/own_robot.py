"""A robot from outside the package: Fetch on tracks, twice as heavy and half as fast, which water and wind move less.

python examples/own_robot.py -e HazardFlood-v1 --affects-agent --output tracked.mp4
"""

from dataclasses import replace
from sys import argv

import hazard_ms
from hazard_ms.robots.fetch import HazardFetch

FETCH = HazardFetch.build


class TrackedFetch(HazardFetch):
    """Fetch's description, arm and camera; another undercarriage, and the bag in the middle instead of on the right."""

    uid = "tracked_fetch"
    build = replace(
        FETCH,
        mass=230.0,
        width=0.70,
        friction=0.9,  # rubber tracks
        forward_step=FETCH.forward_step / 2,
        turn_step=FETCH.turn_step / 2,
    )
    bag = (0.05, 0.0, 0.72)


if __name__ == "__main__":
    raise SystemExit(hazard_ms.main(["play", "--load", __file__, "-r", "tracked", *argv[1:]]))

hazard_ms.register_robot("tracked", TrackedFetch)
