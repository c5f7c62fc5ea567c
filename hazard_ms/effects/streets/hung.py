"""Things on a scene's own fixtures: pennants on carts, banners on lamps, flags and signs on houses, bunting.

It is higher than a robot looks, or above the fixture that carries it, so it hides nothing from a robot's camera.
"""

from __future__ import annotations

import math

from hazard_ms.effects.streets import cloth
from hazard_ms.effects.streets.mesh import Frame
from hazard_ms.effects.streets.town import Town, paint
from hazard_ms.scenes.generate.draw import Draw
from hazard_ms.scenes.solids import extent_of
from hazard_ms.spec import Fixture, SceneSpec

ABOVE = 2.2  # what hangs in the area where things can be is at least as high [m]: robots look from 1.1 m
MAST = 2.95  # height of a pennant on a cart [m]
APART = 9.5  # greatest distance of two lamps with bunting between them [m]


def hang(town: Town, spec: SceneSpec, draw: Draw) -> None:
    """Hang things on the fixtures of the scene `spec`."""
    lee = math.atan2(spec.wind[1], spec.wind[0])
    lamps = []
    for fixture in spec.fixtures:
        if fixture.category == "cart":
            _mast(town, fixture, lee)
        elif fixture.category == "street_lamp":
            lamps.append(fixture)
            _banner(town, fixture, draw)
        elif fixture.category == "house":
            _front(town, fixture, draw)
    for a, b in zip(lamps[:-1], lamps[1:], strict=True):
        across = b.position[0] - a.position[0], b.position[1] - a.position[1]
        length = math.hypot(*across)
        if 2.0 < length < APART:
            start = Frame(a.position[0], a.position[1], math.atan2(across[1], across[0]))
            cloth.bunting(town, start, length, 3.1, draw)


def frame_of(fixture: Fixture) -> Frame:
    """The frame of a fixture that stands upright on the ground."""
    w, _, _, z = fixture.rotation
    return Frame(fixture.position[0], fixture.position[1], 2.0 * math.atan2(z, w))


def _mast(town: Town, cart: Fixture, lee: float) -> None:
    """A pennant over a cart, by which it is seen from afar: what is rescued goes there."""
    at, (_, deep, high) = frame_of(cart), extent_of(cart)
    foot = at.moved(0.0, 0.42 * deep)
    town.firm.box(foot, (-0.012, -0.012, high - 0.03), (0.012, 0.012, MAST), paint("white"))
    cloth.pennant(town, Frame(foot.x, foot.y, lee), MAST, 0.62, 0.38, "cloth_5")


def _banner(town: Town, lamp: Fixture, draw: Draw) -> None:
    """A banner on the post of a lamp."""
    at = frame_of(lamp).moved(0.0, 0.0, draw.one((0.0, math.pi / 2)))
    cell = paint(draw.one(("cloth_0", "cloth_1", "cloth_3", "teal")))
    town.loose.quad(
        at,
        [(0.06, 0, ABOVE + 0.05), (0.5, 0, ABOVE + 0.05), (0.5, 0, 3.0), (0.06, 0, 3.0)],
        cell,
        (0.0, 0.3 * cloth.FLUTTER, 0.3 * cloth.FLUTTER, 0.0),
    )


def _front(town: Town, house: Fixture, draw: Draw) -> None:
    """A flag or a sign on the front of a house."""
    at, (wide, deep, _) = frame_of(house), extent_of(house)
    wall = at.moved(draw.uniform(-0.35, 0.35) * wide, -0.42 * deep)
    if draw.uniform() < 0.6:
        cloth.flag(town, wall, ABOVE + 0.5, draw, 0.9)
    else:
        cloth.hanging_sign(town, wall, ABOVE + 0.1, draw)
