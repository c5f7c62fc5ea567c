"""Fire that creeps over the floor on lattices, one around each first fire, from cell to cell (torch).

A flame grows for 140 frames, then tries every 10 frames, with a probability that rises with the frames since its last
success; a success uses up one direction, drawn at random, whether or not the neighbour can burn. Constants:
docs/physics.md 1.1.

Flames are kept as a roster in the order of ignition, [E, F]: cell (-1: no flame yet), frames of birth and of the last
success, directions used up. Cell (s, i, j), number (s K + i) K + j, is centred at anchor[s] + STEP (i - K // 2, j - K
// 2), i along x, j along y.
"""

from __future__ import annotations

import math

import torch
from torch import Tensor

STEP = 0.22  # distance between neighbours [m]: 1.1 of the edge of a flame's footprint [HAZARD fire/fire.py:92, 153]
CELL = 0.2  # edge of a flame's footprint [m] [HAZARD fire/fire_utils.py:21]
EVERY = 10  # frames between attempts, and between steps of growth [HAZARD fire/fire.py:59]
# size of a flame relative to its model [HAZARD fire/fire_utils.py:23-25]
SCALE_FIRST, SCALE_STEP, SCALE_LAST = 0.1, 0.05, 0.8
GROWTH_STEPS = 14  # number of steps from the first scale to the last
FIRST_CHANCE = 0.02  # probability of an attempt up to the younger of AGES [HAZARD fire/fire_utils.py:18]
# between these the probability rises linearly to 1, in units of AGE_UNIT [HAZARD fire/fire_utils.py:19-20]
AGES = (30, 50)
AGE_UNIT = 5  # frames [HAZARD fire/fire.py:147]
DIRECTIONS = 4  # +x, -x, +y, -y
# Most successes of one scene in one frame: a few are usual, more than this is beyond five standard deviations
AT_ONCE = 32


def probability(age: Tensor) -> Tensor:
    """Probability, [...], that an attempt succeeds, `age` frames, [...], after the last success or the birth."""
    share = (age // AGE_UNIT - AGES[0]).float() / (AGES[1] - AGES[0])
    return FIRST_CHANCE + (1.0 - FIRST_CHANCE) * share.clamp(0.0, 1.0)


def growth(birth: Tensor, frame: Tensor) -> Tensor:
    """Steps of growth, 0 to GROWTH_STEPS, [...], that flames born at the frame `birth`, [...], have made at `frame`."""
    return (frame // EVERY - (birth + EVERY - 1) // EVERY + 1).clamp(0, GROWTH_STEPS)


def lattice_reach(frames: int) -> int:
    """Largest number of cells from its origin that a fire can be by the frame `frames`, if every attempt succeeds."""
    first = EVERY * GROWTH_STEPS + 1  # birth of the first fire's first neighbour
    generation = EVERY * (GROWTH_STEPS + 1)  # from then on, birth to birth
    return 0 if frames < first else (frames - first) // generation + 1


def roster_length(frames: int, lattices: int) -> int:
    """Number of flames to make room for: five standard deviations above the mean of an open floor, at most all cells.

    docs/physics.md F-26: 41.47 +- 5.28 for each lattice after 1,500 frames, growing as frames^2 and frames^1.35.
    """
    reach, age = lattice_reach(frames), frames / 1500
    most = lattices * (2 * reach * (reach + 1) + 1)
    likely = lattices * (3 + 41.47 * age**2) + 5 * 5.28 * age**1.35 * math.sqrt(lattices)
    return min(most, math.ceil(likely))


def succeeds(cell: Tensor, birth: Tensor, last: Tensor, used: Tensor, frame: Tensor, draw: Tensor) -> Tensor:
    """Whether each flame of the roster has a success, [E, F], bool, at `frame`, [E], a multiple of EVERY.

    `cell`, `birth`, `last` and `used` are the roster, `draw` is uniform in (0, 1), all [E, F].
    """
    now = frame[:, None]
    ready = (cell >= 0) & (used != 2**DIRECTIONS - 1) & (growth(birth, now - EVERY) == GROWTH_STEPS)
    success = ready & (draw < probability(now - last))
    return success & (success.cumsum(1) <= AT_ONCE)


def compact(mask: Tensor, length: int) -> Tensor:
    """Indices along the last axis where `mask` [E, F] holds, in order, then -1: [E, `length`].

    What does not fit is left out.
    """
    slot = mask.cumsum(1) - 1
    slot = torch.where(mask, slot.clamp(max=length), length)
    index = torch.arange(mask.shape[1], device=mask.device).expand_as(slot)
    return torch.full((len(mask), length + 1), -1, device=mask.device).scatter_(1, slot, index)[:, :length]


def pick(used: Tensor, draw: Tensor, weight: Tensor | None = None) -> Tensor:
    """Number of one of the directions not yet `used` (bits, [E, C]) for each flame, [E, C], int64.

    `draw` is uniform in (0, 1), [E, C]. All are equally likely, or in proportion to `weight`, [E, C, 4].
    """
    left = (used[..., None] >> torch.arange(DIRECTIONS, device=used.device)) & 1 == 0
    if weight is not None:
        chance = (weight * left).cumsum(-1)
        return ((chance > draw[..., None] * chance[..., -1:]) & left).long().argmax(-1)
    order = left.cumsum(-1)
    wanted = (draw * order[..., -1]).long() + 1
    return (left & (order == wanted[..., None])).long().argmax(-1)


def neighbour(cell: Tensor, direction: Tensor, window: int) -> Tensor:
    """Number of the cell next to `cell` in `direction`, [E, C]; -1 next to cell -1, and beyond `window` cells."""
    along_x = direction < 2
    sign = 1 - 2 * (direction % 2)
    place = torch.where(along_x, cell // window, cell) % window + sign
    there = (cell >= 0) & (place >= 0) & (place < window)
    return torch.where(there, cell + sign * torch.where(along_x, window, 1), -1)


def places(cell: Tensor, anchor: Tensor, window: int) -> Tensor:
    """Centres [m], [E, C, 3], world frame, of the cells `cell`, [E, C]; `anchor` of the lattices [m], [E, S, 2]."""
    known = cell.clamp(min=0)
    origin = anchor.gather(1, (known // window**2)[..., None].expand(-1, -1, 2))
    steps = torch.stack([known // window % window, known % window], -1) - window // 2
    return torch.nn.functional.pad(torch.add(origin, steps, alpha=STEP), (0, 1))
