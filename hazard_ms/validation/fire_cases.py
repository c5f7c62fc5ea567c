"""Cases of the fire of the presets `paper` and `shipped`: F of docs/physics.md 2.1."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial

from hazard_ms.hazards.case import Case, table
from hazard_ms.validation.experiments.fire import (
    CELLS,
    NEVER,
    PAPER,
    SHIPPED,
    after_burning,
    age_at_success,
    broken_rules,
    burning_cells,
    burnt_after,
    cooling,
    equilibrium,
    ignites,
    ignition_update,
    isolated,
    literal_mean,
    observed,
    out_of_range,
    overheated,
    pair,
    pair_mode,
    relaxed,
    shuffled,
)

F1 = {0.05: 577.6923, 0.1: 577.6923, 0.22: 505.925, 0.25: 484.0, 0.3: 446.471, 0.5: 310.0}
F1 |= {0.75: 198.462, 1.0: 136.0, 1.5: 78.0, 2.0: 54.1176, 3.0: 35.676}
F4 = {1: 194.6, 10: 152.7363, 50: 59.2518, 100: 28.5595}
F12 = {60: 1.8371, 100: 1.25, 200: 0.7454, 300: 0.5175, 400: 0.3627, 500: 0.2282, 560: 0.1361}
F13 = {  # threshold, distance: updates
    **{(60, d): n for d, n in zip((0.1, 0.22, 0.3, 0.5, 0.7), (3, 3, 4, 5, 8), strict=True)},
    **{(100, d): n for d, n in zip((0.1, 0.22, 0.3, 0.5, 0.7), (6, 6, 7, 11, 18), strict=True)},
    **{(200, d): n for d, n in zip((0.1, 0.22, 0.3, 0.5, 0.7), (13, 16, 19, 32, 83), strict=True)},
    **{(300, d): n for d, n in zip((0.1, 0.22, 0.3, 0.5, 0.7), (23, 29, 36, 111, NEVER), strict=True)},
    **{(400, d): n for d, n in zip((0.1, 0.22, 0.3, 0.5, 0.7), (38, 51, 73, NEVER, NEVER), strict=True)},
    **{(500, d): n for d, n in zip((0.1, 0.22, 0.3, 0.5, 0.7), (65, 145, NEVER, NEVER, NEVER), strict=True)},
}
F17 = {0.1: 591.589, 0.5: 444.014, 1.0: 254.674, 2.0: 104.228, 4.0: 43.631}
F18 = {0.5: 5, 1.0: 14, 1.5: 39, 2.0: NEVER}
F26 = {200: (1.77, 0.49), 500: (4.62, 1.13), 1000: (18.39, 2.93), 1500: (41.47, 5.28)}
SPREADS = {
    "F-20": ((0, 0, 100), 183.761, 18.546),
    "F-21": ((1, 1, 100), 187.804, 18.326),
    "F-22": ((0, 200, 200), 156.832, 54.783),
}


def cases() -> Iterator[Case]:
    """All cases of this module."""
    yield from table(
        "F-1", "equilibrium at {} m from a flame (shipped)", F1, 1e-4, lambda d: equilibrium(SHIPPED, d), unit="C"
    )
    near = {0.05: 310.0, 0.3: 310.0, 0.5: 310.0, 1.0: 136.0}
    yield from table(
        "F-2", "equilibrium at {} m from a flame (paper)", near, 1e-4, lambda d: equilibrium(PAPER, d), unit="C"
    )
    yield from table("F-4", "cooling from 200 C, after {} updates", F4, 1e-4, lambda n: cooling()[n], unit="C")
    near = {n: 136.0 - 116.0 * 0.97**n for n in (1, 10, 22, 50)}
    yield from table("F-3", "relaxation 1 m from a flame, after {} updates", near, 1e-4, relaxed, unit="C")
    yield from table(
        "F-5", "two things 0.5 m apart, thing {}", {0: 99.7621, 1: 71.7512}, 1e-4, lambda k: pair(0.5, k), unit="C"
    )
    yield from table(
        "F-6", "two things 0.1 m apart, thing {}", {0: 158.895, 1: 145.399}, 1e-4, lambda k: pair(0.1, k), unit="C"
    )
    yield from table(
        "F-8", "two things without a room, thing {}", {0: 160.00059, 1: 159.99941}, 1e-6, isolated, unit="C"
    )
    modes = {(d, 0): 1 - 0.03 / (1 + (0.5 / d) ** 2) for d in (0.2, 0.5, 2.0)}
    modes |= {(d, 1): 1 - 0.03 * (1 + 2 * (0.5 / d) ** 2) / (1 + (0.5 / d) ** 2) for d in (0.2, 0.5, 2.0)}
    yield from table("F-9", "factor per update of (distance m, 0 mean or 1 difference) {}", modes, 1e-5, pair_mode)
    yield Case("F-10", "temperatures outside the range from room to flames", 0.0, 0, out_of_range)
    yield Case("F-11", "difference when the things are shuffled", 0.0, 1e-3, shuffled, "K", absolute=True)
    inside, outside = {t: 1.0 for t in F12}, {t: 0.0 for t in F12}
    yield from table(
        "F-12", "threshold {} C ignites 1 % inside its distance", inside, 0, lambda t: ignites(t, 0.99 * F12[t])
    )
    yield from table("F-12", "threshold {} C does not 1 % outside", outside, 0, lambda t: ignites(t, 1.01 * F12[t]))
    yield from table("F-13", "updates to ignition, (threshold C, distance m) {}", F13, 0, ignition_update)
    yield Case("F-14", "ignitions at 0.05 m with a threshold of 600 C", 0.0, 0, lambda: ignites(600.0, 0.05))
    yield Case("F-16", "frames from ignition to burnt", 1500, 0, burnt_after)
    yield Case(
        "F-16",
        "temperature ten updates after burning out (paper)",
        20 + 580 * 0.97**10,
        1e-4,
        partial(after_burning, PAPER),
        "C",
    )
    yield Case(
        "F-16", "temperature ten updates after burning out (shipped)", 600.0, 1e-4, partial(after_burning, SHIPPED), "C"
    )
    yield from table("F-17", "observed temperature at {} m from a flame", F17, 1e-4, observed, unit="C")
    yield from table("F-18", "updates until the agent at {} m is overheated", F18, 0, overheated)
    for name, (arguments, mean, sd) in SPREADS.items():
        width = 4 * sd / math.sqrt(CELLS)
        yield Case(
            name,
            "age at which a cell ignites the next: mean",
            mean,
            width,
            partial(age_at_success, arguments, 0),
            "frames",
            absolute=True,
            slow=True,
        )
        yield Case(
            name,
            "age at which a cell ignites the next: standard deviation",
            sd,
            0.04,
            partial(age_at_success, arguments, 1),
            "frames",
            slow=True,
        )
    yield Case(
        "F-23", "updates until a cell ignites the next, one draw per update", 25.459, 1e-3, literal_mean, absolute=True
    )
    yield Case("F-27", "flames that vanish, or that no earlier flame is beside", 0.0, 0, broken_rules)
    for frame, (mean, sd) in F26.items():
        width = 4 * sd * math.sqrt(1 / 400 + 1 / 120) + 0.005
        yield Case(
            "F-26",
            f"burning cells after {frame} frames",
            mean,
            width,
            partial(burning_cells, frame),
            absolute=True,
            slow=True,
        )
