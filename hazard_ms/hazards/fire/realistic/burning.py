"""Heat release of burning things: measured curves, or growth as t^2, a plateau and a decline (torch).

    Q(t) = min(alpha t^2, peak) up to the time when 80 % of the energy is gone, then straight down to 0

A t^2 fire uses up the energy of the thing. Its peak is the release per area times the exposed area, unless the energy
does not last until then. Time is since ignition. All functions are exact, so nothing depends on the length of a frame.
Sources of the numbers: hazard_ms.hazards.fire.realistic.fuels. Fires themselves are worked out by `.burners`, a kernel
with the same laws: a test holds it to these, bit for bit.
"""

from __future__ import annotations

import functools
from typing import NamedTuple

import torch
from torch import Tensor

from hazard_ms.hazards.fire.realistic.fuels import CURVES
from hazard_ms.spec import rounding

STEADY = 0.8  # share of the energy that is gone when a t^2 fire begins to decline [M: usual in design fires]
_TINY = 1e-6  # least growth [kW/s^2], energy [kJ], power [kW] and time [s], so that 0 / 0 cannot occur


class Course(NamedTuple):
    """The heat release of a thing from its ignition on; all of one shape [...]."""

    growth: Tensor  # alpha [kW/s^2]
    peak: Tensor  # highest heat release [kW]
    decline: Tensor  # time at which the decline begins [s]
    end: Tensor  # time at which everything is burnt [s]
    curve: Tensor  # row of CURVES that holds instead, -1 for none, int64


def course(growth: Tensor, peak: Tensor, energy: Tensor) -> Course:
    """Heat release of t^2 fires, [...].

    They grow with `growth` [kW/s^2] to at most `peak` [kW] and have `energy` [kJ] to burn, all [...].
    """
    alpha = growth.clamp(min=_TINY)
    energy = energy.clamp(min=_TINY)
    # until the plateau [s]
    first = torch.minimum(rounding.sqrt(peak / alpha), rounding.power(3.0 * STEADY * energy / alpha, 1.0 / 3.0))
    top = (alpha * first * first).clamp(min=_TINY)
    decline = first + (STEADY * energy - alpha * first**3 / 3.0).clamp(min=0.0) / top
    end = decline + 2.0 * (1.0 - STEADY) * energy / top
    return Course(alpha, top, decline, end, torch.full_like(top, -1, dtype=torch.int64))


def t_squared(growth: Tensor | float, age: Tensor) -> Tensor:
    """Heat release alpha t^2 [kW], [...], of fires that grow with `growth` [kW/s^2], at `age` [s], [...]."""
    return growth * age.clamp(min=0.0).square()


def release(course: Course, age: Tensor) -> Tensor:
    """Heat release [kW], [...], at `age` [s], [...], since ignition; 0 before and after burning."""
    span = (course.end - course.decline).clamp(min=_TINY)
    grown = torch.minimum(t_squared(course.growth, age), course.peak) * ((course.end - age) / span).clamp(0.0, 1.0)
    return torch.where(course.curve >= 0, measured(course.curve, age), grown)


def measured(curve: Tensor, age: Tensor) -> Tensor:
    """Heat release [kW], [...], of the rows `curve`, [...], of CURVES at `age` [s], [...].

    It is straight between the knots, and 0 outside of them.
    """
    times, powers, _ = tables(age.device)
    row = curve.clamp(min=0)
    after = torch.searchsorted(times[row], age[..., None], right=True).clamp(1, times.shape[1] - 1)
    before = after - 1
    (t0, t1), (q0, q1) = (
        (v[row].gather(-1, before)[..., 0], v[row].gather(-1, after)[..., 0]) for v in (times, powers)
    )
    share = (age - t0) / (t1 - t0).clamp(min=_TINY)
    return torch.where((age >= 0) & (age < times[row][..., -1]), torch.lerp(q0, q1, share), 0.0)


def lasting(curve: Tensor) -> Tensor:
    """Time [s], [...], at which the rows `curve`, [...], of CURVES end."""
    return tables(curve.device)[0][curve.clamp(min=0)][..., -1]


def radiant(curve: Tensor, otherwise: float) -> Tensor:
    """Share of their heat, [...], that fires of the rows `curve`, [...], of CURVES radiate; `otherwise` for row -1."""
    return torch.where(curve >= 0, tables(curve.device)[2][curve.clamp(min=0)], otherwise)


class Tables(NamedTuple):
    """R measured curves, with N knots each: the last one is repeated as needed."""

    times: Tensor  # [s], [R, N]
    powers: Tensor  # [kW], [R, N]
    shares: Tensor  # of the heat that is radiated, [R]


@functools.lru_cache(maxsize=4)
def tables(device: torch.device) -> Tables:
    """The measured curves: times [s] and powers [kW], [R, N], and radiant shares, [R]."""
    longest = max(len(c.knots) for c in CURVES.values())
    rows = [[*c.knots, *[c.knots[-1]] * (longest - len(c.knots))] for c in CURVES.values()]
    table = torch.tensor(rows, device=device)
    return Tables(
        table[..., 0].contiguous(),
        table[..., 1].contiguous(),
        torch.tensor([c.radiant for c in CURVES.values()], device=device),
    )
