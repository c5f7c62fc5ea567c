"""Functions of the smoke's kernels, one at a time, for tests that compare them with exact solutions."""

from __future__ import annotations

import torch
import warp as wp
from torch import Tensor

from hazard_ms.hazards.fire.realistic.twozone import combustion, exchange, lining, plumes, vents
from hazard_ms.simulation.kernels.launch import OPTIONS, Launches

wp.set_module_options(OPTIONS)


@wp.kernel
def _conduct(
    slab_k: float, slab_c: float, slab_d: float, film: float, source: float, gas: float, dt: float, steps: int,
    warmth: wp.array(dtype=lining.Column),
):  # fmt: skip
    slab = lining.Slab()
    slab.conductivity = slab_k
    slab.capacity = slab_c
    slab.thickness = slab_d
    for _ in range(steps):
        front = lining.eliminate(warmth[0], slab, film, source, 20.0, dt)
        warmth[0] = lining.restore(front, gas)


@wp.func
def side_of(numbers: wp.array(dtype=float)) -> vents.Side:
    side = vents.Side()
    side.pressure = numbers[0]
    side.face = numbers[1]
    side.density = numbers[2]
    side.air = numbers[3]
    return side


@wp.kernel
def _pass(
    width: float, sill: float, top: float, a: wp.array(dtype=float), b: wp.array(dtype=float),
    found: wp.array(dtype=float),
):  # fmt: skip
    here = side_of(a)
    there = side_of(b)
    flow = vents.through(width, sill, top, here, there)
    found[0] = flow.hot
    found[1] = flow.cold
    found[2] = flow.hot_back
    found[3] = flow.cold_back


def conducted(slab: lining.Lining, film: float, source: float, gas: float, seconds: float, steps: int) -> Tensor:
    """Temperatures [C] of the layers of a lining of 20 C after so many seconds, [CELLS]."""
    warmth = torch.full((1, lining.CELLS), 20.0)
    numbers = (slab.conductivity, slab.capacity, slab.thickness, film, source, gas, seconds / steps, steps)
    Launches().run(_conduct, (1,), *(float(n) if k < 7 else n for k, n in enumerate(numbers)), warmth)
    return warmth[0]


def passed(opening: tuple[float, ...], a: tuple[float, ...], b: tuple[float, ...]) -> list[float]:
    """Flows [kg/s] through an opening of width, lower and upper end [m], between two sides as vents.Side has them."""
    found = torch.empty(4)
    Launches().run(_pass, (1,), *opening, torch.tensor(a), torch.tensor(b), found)
    return found.tolist()


@wp.kernel
def _laws(given: wp.array2d(dtype=float), found: wp.array2d(dtype=float)):  # type: ignore[valid-type]
    n = wp.tid()
    a, b, c, d, e = given[n, 0], given[n, 1], given[n, 2], given[n, 3], given[n, 4]
    found[n, 0] = exchange.spill(a, b, c, d, e)
    found[n, 1] = plumes.entrained(a, b, c, d, e)
    found[n, 2] = plumes.flame_length(a, b)
    found[n, 3] = combustion.monoxide(a)


def law(name: str, *numbers: float) -> float:
    """What the law `name` of the smoke gives for some numbers: spill, entrained, flame_length or monoxide."""
    found = torch.zeros(1, 4)
    Launches().run(_laws, (1,), torch.tensor([[*numbers, *[0.0] * (5 - len(numbers))]]), found)
    return float(found[0, ("spill", "entrained", "flame_length", "monoxide").index(name)])
