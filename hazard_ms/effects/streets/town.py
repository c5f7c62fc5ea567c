"""A town while it is built: its meshes, and the paintings of its pieces."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from hazard_ms.effects.streets.mesh import Cell, Frame, Mesh
from hazard_ms.effects.streets.painting import cut_out, solid


@dataclass
class Town:
    """All that is seen of a town, as meshes: firm or moved by the wind, each solid or cut out; and puddles."""

    firm: Mesh = field(default_factory=Mesh)
    firm_cut: Mesh = field(default_factory=Mesh)
    wet: Mesh = field(default_factory=Mesh)
    loose: Mesh = field(default_factory=Mesh)
    loose_cut: Mesh = field(default_factory=Mesh)

    @property
    def meshes(self) -> tuple[Mesh, ...]:
        """All of them."""
        return self.firm, self.firm_cut, self.wet, self.loose, self.loose_cut


def paint(name: str) -> Cell:
    """The cell of a painting of the solid atlas."""
    return solid().cells[name]


def cut(name: str) -> Cell:
    """The cell of a painting that is cut out."""
    return cut_out().cells[name]


def rod(
    town: Town, frame: Frame, start: tuple[float, float, float], end: tuple[float, float, float], half: float, cell: str
) -> None:
    """A thin rod between two points, as two crossed strips."""
    (a, b, c), (d, e, f) = start, end
    if max(abs(d - a), abs(e - b)) < 1e-6:
        strips = (((half, 0.0, 0.0), False), ((0.0, half, 0.0), False))
    else:
        long = math.hypot(d - a, e - b)
        strips = (((0.0, 0.0, half), True), ((-(e - b) / long * half, (d - a) / long * half, 0.0), True))
    for (i, j, k), _ in strips:
        town.firm.quad(
            frame,
            [(a - i, b - j, c - k), (d - i, e - j, f - k), (d + i, e + j, f + k), (a + i, b + j, c + k)],
            paint(cell),
        )
