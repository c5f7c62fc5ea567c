"""The fires of a realistic fire: what gives off how much heat, and where (Warp, one thread per fire).

Fires are the things that burn, and the flames on the floor. The laws are those of `.burning`, in single precision, and
give the same bits. Diameters have correctly rounded square roots, which torch's are not on all processors.
"""

from __future__ import annotations

import math

import torch
import warp as wp

from hazard_ms.hazards.fire import spread
from hazard_ms.hazards.fire.fire_state import BURNING
from hazard_ms.hazards.fire.realistic import burning, fuels
from hazard_ms.hazards.fire.realistic.blaze_state import BlazeState
from hazard_ms.hazards.fire.realistic.radiation import Fires
from hazard_ms.simulation.kernels.bodies import Bodies
from hazard_ms.simulation.kernels.launch import OPTIONS
from hazard_ms.simulation.world import World

wp.set_module_options(OPTIONS)

CELL_AREA = spread.STEP**2  # area of a cell of the floor [m^2]
CELL_RELEASE = CELL_AREA * fuels.AS_GOODS  # of one that burns [kW]
CELL_WIDTH = math.sqrt(4.0 * CELL_AREA / math.pi)  # diameter of a disc of the same area [m]

ON_FIRE = wp.constant(wp.int64(BURNING))
CELL_POWER, CELL_DIAMETER = wp.constant(CELL_RELEASE), wp.constant(CELL_WIDTH)
AS_A_DISC = wp.constant(4.0 / math.pi)  # square of a diameter over the area of the disc
TINY = wp.constant(1.0e-6)  # least value of a divisor, in its own unit


@wp.struct
class Burners:
    """The fields of BlazeState with the same names: things, [E, B], and flames on the floor, [E, F]."""

    status: wp.array2d(dtype=wp.int64)
    burn_age: wp.array2d(dtype=float)
    growth: wp.array2d(dtype=float)
    peak: wp.array2d(dtype=float)
    decline: wp.array2d(dtype=float)
    burn_end: wp.array2d(dtype=float)
    curve: wp.array2d(dtype=wp.int64)
    flame_cell: wp.array2d(dtype=wp.int64)
    flame_birth: wp.array2d(dtype=wp.int64)
    flame_age: wp.array2d(dtype=float)
    flame_peak: wp.array2d(dtype=float)
    flame_dry: wp.array2d(dtype=float)
    wet: wp.array2d(dtype=float)


@wp.struct
class Curves:
    """Measured curves: knots [s], [kW], [R, N], and the share of their heat that they radiate, [R]."""

    times: wp.array2d(dtype=float)
    powers: wp.array2d(dtype=float)
    shares: wp.array(dtype=float)


@wp.func
def t_squared(growth: float, age: float) -> float:
    """Heat release [kW] of a fire that grows with `growth` [kW/s^2], at `age` [s], see `burning.t_squared`."""
    since = wp.max(age, 0.0)
    return growth * (since * since)


@wp.func
def measured(curves: Curves, row: int, age: float) -> float:
    """Heat release [kW] of a row of the measured curves at `age` [s], see `burning.measured`."""
    last = curves.times.shape[1] - 1
    if age < 0.0 or age >= curves.times[row, last]:
        return 0.0
    after = int(1)
    while after < last and curves.times[row, after] <= age:
        after += 1
    start, end = curves.times[row, after - 1], curves.times[row, after]
    low, high = curves.powers[row, after - 1], curves.powers[row, after]
    share = (age - start) / wp.max(end - start, TINY)
    base = low
    if share >= 0.5:  # from the nearer knot, as torch.lerp does
        base = high
        share = share - 1.0
    return float(wp.float64(share) * wp.float64(high - low) + wp.float64(base))


@wp.func
def released(burners: Burners, curves: Curves, e: int, b: int) -> float:
    """Heat release [kW] of the burning thing `b`, see `burning.release`."""
    age = burners.burn_age[e, b]
    row = int(burners.curve[e, b])
    if row >= 0:
        return measured(curves, row, age)
    end = burners.burn_end[e, b]
    left = (end - age) / wp.max(end - burners.decline[e, b], TINY)
    return wp.min(t_squared(burners.growth[e, b], age), burners.peak[e, b]) * wp.clamp(left, 0.0, 1.0)


@wp.kernel
def burn(
    frame: wp.array(dtype=wp.int64),
    floor_growth: float,
    first_release: float,
    first_base: float,
    radiant: float,
    bodies: Bodies,
    burners: Burners,
    curves: Curves,
    power: wp.array2d(dtype=float),
    share: wp.array2d(dtype=float),
    diameter: wp.array2d(dtype=float),
):
    """Set `power` [kW], the `share` of it that is radiated, and the `diameter` of the base [m] of every fire.

    `floor_growth` [kW/s^2] and `first_release` [kW] are those of all fires of the start together, `first_base` [m] is
    that of one which gives off so much; `radiant`: the share that is radiated where no measurement tells.
    """
    e, m = wp.tid()
    things = bodies.exists.shape[1]
    share[e, m] = radiant
    heat = float(0.0)
    if m < things:
        extent = bodies.extent[e, m]
        diameter[e, m] = wp.sqrt(AS_A_DISC * extent[0] * extent[1])
        row = int(burners.curve[e, m])
        if row >= 0:
            share[e, m] = curves.shares[row]
        if bodies.exists[e, m] and not bodies.safe[e, m] and burners.status[e, m] == ON_FIRE:
            heat = (1.0 - burners.wet[e, m]) * released(burners, curves, e, m)
    else:
        f = m - things
        most = burners.flame_peak[e, f]
        part, wide = float(1.0), CELL_DIAMETER
        if most > CELL_POWER:
            part = most / first_release
            wide = first_base * wp.sqrt(part)
        diameter[e, m] = wide
        if burners.flame_cell[e, f] >= wp.int64(0) and burners.flame_birth[e, f] <= frame[e]:
            heat = burners.flame_dry[e, f] * wp.min(t_squared(floor_growth * part, burners.flame_age[e, f]), most)
    power[e, m] = heat


def fires(
    state: BlazeState, world: World, growth: float, first_release: float, first_base: float, radiant: float
) -> Fires:
    """The fires of each environment: B things, then F flames on the floor. The numbers are those of `burn`."""
    base = world.base_of(world.position, world.rotation, world.extent)
    place = torch.cat([base, state.flame_place], 1)
    power, share, diameter = (torch.empty_like(place[..., 0], memory_format=torch.contiguous_format) for _ in range(3))
    structs = (
        world.launches.struct(Bodies, world),
        world.launches.struct(Burners, state),
        world.launches.struct(Curves, burning.tables(place.device)),
    )
    numbers = (growth, first_release, first_base, radiant)
    world.launches.run(burn, tuple(power.shape), world.frame, *numbers, *structs, power, share, diameter)
    return Fires(place, power, share, diameter)
