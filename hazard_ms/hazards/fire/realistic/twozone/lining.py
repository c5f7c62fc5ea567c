"""Heat that soaks into walls, floors and ceilings: conduction in depth (Warp).

    rho c dT/dt = d/dx (k dT/dx),   k dT/dx = h (T_gas - T) + source at the hot face,   h_b (T - T_0) at the back

Scheme: finite volumes in CELLS layers that grow by RATIO from the hot face, backward Euler, so stable for any step. The
elimination runs from the back to the front and leaves T_1 = a + b T_gas: the gas and its walls are solved together, and
what one loses the others gain. Linings: gypsum board 16 mm, concrete 150 mm [docs/physics.md 3.1], common brick [M:
Quintiere].
"""

from __future__ import annotations

from dataclasses import dataclass

import warp as wp

from hazard_ms.simulation.kernels.launch import OPTIONS

wp.set_module_options(OPTIONS)

CELLS = 10  # layers of a lining [ours]
RATIO = 1.5  # thickness of a layer over that of the one in front of it: the first of gypsum board is 0.14 mm [ours]
BEHIND = 0.010  # heat transfer from the back of a lining [kW/m^2 K] [docs/physics.md 4.4]

# Thickness of the first and of the last layer over that of the lining
FIRST = (RATIO - 1.0) / (RATIO**CELLS - 1.0)
LAST = FIRST * RATIO ** (CELLS - 1)

Column = wp.types.vector(length=CELLS, dtype=float)


@dataclass(frozen=True)
class Lining:
    """The material of the walls and the ceiling of a room."""

    conductivity: float  # [kW/m K]
    capacity: float  # heat capacity of its volume [kJ/m^3 K]
    thickness: float  # [m]


GYPSUM = Lining(0.17e-3, 960 * 1.10, 0.016)  # [docs/physics.md 3.1]
LININGS = {  # by the material of the walls; gypsum board behind every other one [ours]
    "concrete": Lining(1.6e-3, 2400 * 0.75, 0.150),  # [docs/physics.md 3.1]
    "brick": Lining(0.69e-3, 1600 * 0.84, 0.100),  # [M: Quintiere]
}


@wp.struct
class Slab:
    """A lining as kernels take it, see Lining."""

    conductivity: float
    capacity: float
    thickness: float


@wp.struct
class Front:
    """A step of conduction after elimination: T_k = a_k + b_k T_(k-1), the gas before the first layer."""

    a: Column
    b: Column
    gain: float  # conductance from the gas to the middle of the first layer [kW/m^2 K]


@wp.func
def gain(slab: Slab, film: float) -> float:
    """Conductance [kW/m^2 K] from the gas to the middle of the first layer, `film` [kW/m^2 K] that at the face."""
    return 1.0 / (1.0 / wp.max(film, 1.0e-6) + 0.5 * FIRST * slab.thickness / slab.conductivity)


@wp.func
def eliminate(warmth: Column, slab: Slab, film: float, source: float, room: float, dt: float) -> Front:
    """Half a step of conduction over `dt` [s]: that which does not know the gas yet.

    `warmth` [C] is the lining's temperature, `film` [kW/m^2 K] the transfer from the gas, `source` [kW/m^2] the flux of
    everything else on the hot face, `room` [C] the temperature behind.
    """
    front = Front()
    k = slab.conductivity
    deep = LAST * slab.thickness
    behind = 1.0 / (1.0 / BEHIND + 0.5 * deep / k)
    known = room
    slope = float(0.0)
    for step in range(CELLS):
        j = CELLS - 1 - step
        ahead = gain(slab, film)
        flux = source
        if j > 0:
            ahead = 2.0 * k / (deep * (1.0 + 1.0 / RATIO))
            flux = 0.0
        held = slab.capacity * deep / dt
        total = held + ahead + behind * (1.0 - slope)
        known = (held * warmth[j] + behind * known + flux) / total
        slope = ahead / total
        front.a[j] = known
        front.b[j] = slope
        behind = ahead
        deep = deep / RATIO
    front.gain = behind
    return front


@wp.func
def restore(front: Front, gas: float) -> Column:
    """The lining's temperature [C] after the step, once that of the `gas` [C] is known."""
    warmth = Column()
    before = gas
    for j in range(CELLS):
        before = front.a[j] + front.b[j] * before
        warmth[j] = before
    return warmth
