"""Cases of floods: L of docs/physics.md 2.2, and the facts I-1 to I-3 of SAPIEN's integrator."""

from __future__ import annotations

import math
from collections.abc import Iterator

import torch

from hazard_ms.hazards.case import Case, table
from hazard_ms.hazards.flood import wading
from hazard_ms.hazards.flood.buoyancy import BALL, BOX, CYLINDER
from hazard_ms.validation.experiments.flood import (
    HEAVE,
    SHIPPED,
    SINKING,
    TERMINAL,
    WET,
    depth_after,
    dragged,
    drifting,
    first_acceleration,
    first_wet,
    floating_depths,
    free_fall,
    logs,
    period,
    rolling,
    shipped_frames,
    sinking,
    slope_after,
    terminal,
    turning,
    wet,
)

SUNK = {0.1: 0.02402, 0.2: 0.09068, 0.5: 0.42981, 1.0: 1.10319}
DRIFT = {(0, 0.1): 0.19106, (0, 0.5): 0.53040, (0, 1.0): 0.68176, (0, 2.0): 0.79522, (0, 5.0): 0.88344}
DRIFT |= {(1, 0.1): 0.13648, (1, 0.5): 0.43404, (1, 1.0): 0.59663, (1, 2.0): 0.73413, (1, 5.0): 0.85194}
ARMS = {2: 0.002911, 5: 0.007307, 10: 0.014831, 15: 0.022807, 20: 0.031522}
TILTED = {0: 0.3, 10: 0.29691, 30: 0.32125, 60: 0.37978, 90: 0.39555}
# at 1500 the slope is 2.98017 degrees already: 1.5 - 2 tan
DEPTHS = {100: 0.0, 500: 0.39518, 1000: 0.89518, 1500: 1.39588}
CLASSES = {(0.2, 1.0): 1, (0.4, 0.5): 2, (0.6, 0.5): 3, (0.5, 1.5): 4, (1.25, 0.954): 5, (2.5, 0.2): 5, (1.0, 4.5): 6}


def of_levels() -> Iterator[Case]:
    """Cases of the integrator, and of the original's water that rises and carries."""
    yield Case("I-1", "free fall of 1 s in SAPIEN", 4.95405, 1e-4, free_fall, "m")
    yield Case("L-1", "tangent of the slope", 0.0524078, 1e-5, lambda: math.tan(math.radians(SHIPPED.slope)))
    yield Case("L-1", "current", 0.9540568, 1e-5, lambda: SHIPPED.speed, "m/s")
    yield from table("L-2", "depth 2 m from the source, frame {}", DEPTHS, 2e-5, depth_after, unit="m", absolute=True)
    yield from table("L-3, L-30", "first wet frame {} m from the source", WET, 0, lambda d: first_wet().get(d, -1))
    slopes = {1: 2.98017, 2: 2.96060, 3: 2.94128}
    yield from table("L-4", "slope at update {} of the cap", slopes, 1e-5, slope_after, unit="deg")
    drifts = {(0.01, 1.0): 50, (0.06, 1.0): 8, (0.12, 1.0): 4, (0.06, 5.0): 42}
    yield from table("L-5", "frames to 63 % of the current, (m2, kg) {}", drifts, 0, shipped_frames)


def of_motion() -> Iterator[Case]:
    """Cases of things that float, heave, sink and drift."""
    boxes = {(shape, s): s for shape in (BOX, CYLINDER) for s in (0.2, 0.5, 0.9)}
    yield from table(
        "L-10",
        "share of its height under water, (0 box, 1 cylinder; relative density) {}",
        boxes,
        0.01,
        lambda k: floating_depths()[k],
    )
    balls = {0.2: 0.287141, 0.5: 0.5, 0.9: 0.8042}
    yield from table(
        "L-11",
        "share of its height to which a ball sinks, relative density {}",
        balls,
        0.01,
        lambda s: floating_depths()[BALL, s],
    )
    yield from table("L-13", "heave period of a box, s = {}", HEAVE, 0.03, period, unit="s")
    # 2 C B / sqrt(GM), C = 0.373 + 0.023 B / d - 0.043 L / 100 m [IMO, 2008 IS Code, 2.3.4]
    yield Case("L-54", "roll period of a box (IMO formula for ships)", 2.129, 0.10, lambda: rolling(0.5), "s")
    yield from table(
        "L-14", "terminal speed (kg/m3, shape, Cd) {}", TERMINAL, 5e-3, lambda k: terminal()[k], unit="m/s"
    )
    yield from table("L-15", "speed of a sinking cube after {} s", SINKING, 0.01, lambda t: sinking()[t][0], unit="m/s")
    yield from table("L-15", "distance sunk by a cube after {} s", SUNK, 0.01, lambda t: sinking()[t][1], unit="m")
    yield from table(
        "L-16",
        "first acceleration of a ball, added mass {}",
        {0.0: 4.905, 0.5: 3.924},
        1e-3,
        first_acceleration,
        unit="m/s2",
    )
    yield from table(
        "L-17", "drift with the current (cube, s) {}", DRIFT, 0.01, lambda k: drifting()[k], unit="m/s", slow=True
    )


def of_forces() -> Iterator[Case]:
    """Cases of drag and lift as functions, and of the classes of danger."""
    yield Case("L-18", "drag at rest in the flow", 0.0, 0, lambda: dragged(0.0, 0.04), "N")
    yield Case(
        "L-18",
        "drag is odd: sum of both directions",
        0.0,
        1e-4,
        lambda: dragged(0.7, 0.04) + dragged(-0.7, 0.04),
        "N",
        absolute=True,
    )
    yield Case("L-19", "twice the slip: force times", 4.0, 1e-3, lambda: dragged(0.8, 0.04) / dragged(0.4, 0.04))
    yield Case("L-19", "twice the area: force times", 2.0, 1e-3, lambda: dragged(0.8, 0.08) / dragged(0.8, 0.04))
    box, axis = (0.2, 0.1, 0.05), (1.0, 0.3, 0.0)
    shares = table(
        "L-20",
        "immersed share of a box at {} degrees",
        TILTED,
        5e-3,
        lambda a: float(wet(box, axis, a, -0.02).fraction),
        absolute=True,
    )
    yield from shares
    beam, upright = (0.2, 0.3, 0.1), (0.0, 1.0, 0.0)
    arms = table(
        "L-22",
        "righting arm at {} degrees",
        ARMS,
        1e-4,
        lambda a: abs(float(wet(beam, upright, a, 0.0).arm[0, 0])),
        unit="m",
        absolute=True,
    )
    yield from arms
    torques = {2: 0.685, 5: 1.721, 10: 3.492, 15: 5.370, 20: 7.422}
    yield from table("L-22", "righting torque at {} degrees", torques, 0.025, turning, unit="N m")
    yield from table(
        "L-23",
        "a square log of {} rests at",
        {0.15: 0.0, 0.5: 45.0, 0.85: 0.0},
        2.0,
        lambda s: logs()[s],
        unit="deg",
        absolute=True,
        slow=True,
    )
    yield Case(
        "L-25",
        "sideways arm of a level box",
        0.0,
        1e-6,
        lambda: float(wet(beam, upright, 0.0, 0.03).arm[0, :2].abs().max()),
        "m",
        absolute=True,
    )

    def danger(case: tuple[float, float]) -> float:
        return float(wading.hazard_class(torch.tensor([case[0]]), torch.tensor([case[1]])))

    yield from table("3.2", "hazard class at (m, m/s) {}", CLASSES, 0, danger)


def cases() -> Iterator[Case]:
    """All cases of this module."""
    yield from of_levels()
    yield from of_motion()
    yield from of_forces()
