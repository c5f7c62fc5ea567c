"""The eyes of the track with perception: how large the pictures of the head camera are, and how wide it looks.

Written "512/120", or "640x480/55": width and height in pixels, and the angle over the width in degrees. With the truth,
and unless a detector has others, they are EYES, the robots' own.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Any

from hazard_ms.spec.checks import LEAST_PIXELS

EYES = "256/120"  # of the robots (docs/benchmark.md 2)
FORM = re.compile(r"(\d{1,4})(?:x(\d{1,4}))?/(\d{1,3})")
MOST_PIXELS = 2048  # of a side: a look would take seconds [ours]
# a thing of the size of a hand, and pixels across it from which most such things are found [m], [pixels] [ours]:
# results/detector.md has a recall of 0.64 from 32 pixels on
HAND, ACROSS = 0.1, 8
FAR = 3.0  # distance up to which the truth tells what a look shows on the floor and on furniture [m] [ours]
NARROWEST, WIDEST = 10, 150  # of the angle over the width [degrees] [ours]


@dataclass(frozen=True)
class Eyes:
    """A camera by its pictures."""

    width: int  # [pixels]
    height: int  # [pixels]
    degrees: int  # over the width

    @classmethod
    def of(cls, text: str) -> Eyes:
        """The eyes that `text` names. Raises ValueError for another form, and for sizes out of range."""
        found = FORM.fullmatch(text)
        if found is None:
            raise ValueError(f"eyes must look like 512/120 or 640x480/55, got {text!r:.100}")
        width, degrees = int(found[1]), int(found[3])
        height = int(found[2] or width)
        for side in (width, height):
            if not LEAST_PIXELS <= side <= MOST_PIXELS:
                raise ValueError(f"sides of eyes must be from {LEAST_PIXELS} to {MOST_PIXELS} pixels, got {text!r}")
        if not NARROWEST <= degrees <= WIDEST:
            raise ValueError(f"the angle of eyes must be from {NARROWEST} to {WIDEST} degrees, got {text!r}")
        return cls(width, height, degrees)

    @property
    def sight(self) -> float:
        """Distance up to which a detector tells most things, no more than FAR [m]."""
        focal = self.width / 2.0 / math.tan(math.radians(self.degrees) / 2.0)  # [pixels]
        return min(FAR, focal * HAND / ACROSS)

    @property
    def camera(self) -> dict[str, Any]:
        """Keywords of ManiSkill's cameras: sides [pixels], and `fov`, the angle over the height [rad]."""
        upright = 2.0 * math.atan(math.tan(math.radians(self.degrees) / 2.0) * self.height / self.width)
        return {"width": self.width, "height": self.height, "fov": upright}
