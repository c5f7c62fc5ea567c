"""The places of the pieces of a town around a scene in the open: beside its roads, around it, and behind that.

All of it is a function of the scene's data and name. What stands is outside of the area in which things can be; inside
it, everything is flat on the ground (ground.py), or hangs on fixtures higher than a robot looks (hung.py).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from hazard_ms.effects.streets import cloth, ground, hung, pieces
from hazard_ms.effects.streets.lots import Lots, Strip, strips
from hazard_ms.effects.streets.mesh import Frame
from hazard_ms.effects.streets.town import Town, paint
from hazard_ms.effects.streets.vehicles import vehicle
from hazard_ms.scenes.generate.draw import Draw
from hazard_ms.spec import SceneSpec

VERSION = "town 1"  # goes up whenever the same scene would get another town
CLEAR = 0.4  # from the area in which things can be [m]
AVENUE, ENDS = 34.0, 38.0  # how far houses stand along roads, and where a house ends the view [m]
BACK = 17.0  # of the second row of houses [m]
LEAFY = 0.6, 0.16  # share of lots with trees instead of a house, where there is no road and where there is [ours]
BAY = 2.6  # from one parked vehicle to the next [m]


@dataclass
class _Site:
    """One side of the place: its frame, x along the side and y outwards from the middle [m]."""

    frame: Frame
    half: float  # of the side's length, with the area in which things can be [m]
    edge: float  # from the middle to where things can be no more [m]
    roads: tuple[Strip, ...]


def town_of(spec: SceneSpec) -> Town:
    """The town around the scene `spec`, which must be in the open."""
    town, draw, lots = Town(), Draw(VERSION, spec.name), Lots(spec.room)
    sites = [_site(spec, k) for k in range(4)]
    leafy = LEAFY[any(p.material == "asphalt" for p in spec.room.patches) or spec.room.floor == "asphalt"]
    for site in sites:
        for road in site.roads:
            _avenue(town, site, road, lots, draw)
    for site in sites:
        _ring(town, site, lots, leafy, draw)
    for site in sites:
        _back(town, site, lots, leafy, draw)
    _tower(town, draw.one(sites), draw)
    ground.paint_ground(town, spec, draw)
    hung.hang(town, spec, draw)
    return town


def _site(spec: SceneSpec, k: int) -> _Site:
    (x, y), beyond = spec.room.size, spec.room.beyond
    frame = Frame(x / 2, y / 2, k * math.pi / 2)
    wide, deep = (x, y) if k % 2 == 0 else (y, x)
    edge = deep / 2 + beyond
    return _Site(frame, wide / 2 + beyond, edge, strips(spec.room, frame, edge))


def _avenue(town: Town, site: _Site, road: Strip, lots: Lots, draw: Draw) -> None:
    """Houses or trees on both sides of a road that leads away, lamps, parked vehicles, and a house at its end."""
    for side, turn in ((road.low, math.pi / 2), (road.high, -math.pi / 2)):
        out = -1.0 if turn > 0 else 1.0
        d = site.edge + CLEAR
        while d < site.edge + AVENUE:
            w = draw.uniform(5.6, 8.0)
            number, depth = draw.whole(0, pieces.FRONTS - 1), draw.uniform(6.0, 8.0)
            at = site.frame.moved(side + out * 0.15, d + w / 2, turn)
            if road.paved and lots.take(at, w, depth):
                pieces.house(town, at, w, depth, number, draw)
                if draw.uniform() < 0.5:
                    pieces.bins(town, at.moved(draw.uniform(-0.3, 0.1) * w, -0.45), draw)
                elif draw.uniform() < 0.6:
                    pieces.bicycle(town, at.moved(draw.uniform(-0.2, 0.2) * w, -0.3))
            elif not road.paved:
                pieces.tree(town, site.frame.moved(side + out * 1.2, d + w / 2), draw)
            d += w + (0.0 if draw.uniform() < 0.7 else draw.uniform(1.2, 2.4))
        _kerbside(town, site, road, (side, -out), draw)
    end = site.frame.moved((road.low + road.high) / 2, site.edge + ENDS)
    if road.paved:
        pieces.house(town, end, max(road.high - road.low + 1.0, 8.0), 7.0, draw.whole(0, 15), draw)


def _kerbside(town: Town, site: _Site, road: Strip, rim: tuple[float, float], draw: Draw) -> None:
    """What stands between a road and its houses, and the vehicles that are parked along it."""
    side, inwards = rim
    if road.asphalt is None:
        return
    low, high = road.asphalt
    kerb = low if inwards > 0 else high
    d, k = site.edge + 1.0 + draw.uniform(0.0, 3.0), 0
    while d < site.edge + AVENUE:
        at = site.frame.moved(kerb - 0.35 * inwards, d, 0.0)
        if abs(kerb - side) > 0.8:
            if k % 3 == 0:
                pieces.lamp(town, at.moved(0.0, 0.0, math.pi / 2 * inwards))
            elif k % 3 == 1:
                pieces.tree(town, at, draw)
            else:
                pieces.road_sign(town, at, draw)
        if high - low > 4.0 and draw.uniform() < 0.75:
            turn = math.pi / 2 * inwards + draw.uniform(-0.03, 0.03)
            vehicle(town, site.frame.moved(kerb + 1.05 * inwards, d + 3.2, turn), draw)
        d, k = d + draw.uniform(5.6, 7.5), k + 1


def _ring(town: Town, site: _Site, lots: Lots, leafy: float, draw: Draw) -> None:
    """A row of lots around the place, which face it."""
    s = -site.half - 10.0
    while s < site.half + 10.0:
        w, depth, number = draw.uniform(5.6, 8.2), draw.uniform(5.5, 8.0), draw.whole(0, pieces.FRONTS - 1)
        front = site.frame.moved(s + w / 2, site.edge + CLEAR)
        bays = lots.material(front.moved(0.0, 1.0)) == "asphalt"
        yard = 6.0 if bays else 1.7
        if not lots.take(front, w, yard + depth):
            s += 0.5
            continue
        if bays:
            for k in range(int(w / BAY)):
                if draw.uniform() < 0.65:
                    vehicle(town, front.moved((k + 0.5) * BAY - w / 2, 2.7, draw.one((1.0, -1.0)) * math.pi / 2), draw)
        else:
            pieces.garden(town, front, w, draw)
        if draw.uniform() < leafy:
            _grove(town, front.moved(0.0, yard), w, depth, draw)
        else:
            pieces.house(town, front.moved(0.0, yard), w, depth, number, draw)
            _yard(town, front.moved(0.0, yard), w, draw)
        s += w + (0.0 if draw.uniform() < 0.55 else draw.uniform(1.0, 3.0))


def _yard(town: Town, wall: Frame, width: float, draw: Draw) -> None:
    """What stands before a house."""
    kind = draw.uniform()
    if kind < 0.35:
        pieces.bins(town, wall.moved(-0.42 * width, -0.45), draw)
    elif kind < 0.6:
        pieces.bicycle(town, wall.moved(draw.uniform(-0.2, 0.2) * width, -0.3))


def _grove(town: Town, at: Frame, width: float, depth: float, draw: Draw) -> None:
    """Trees, and sometimes a line with washing before them."""
    if draw.uniform() < 0.45:
        cloth.laundry(town, at.moved(0.0, 0.4, draw.uniform(-0.2, 0.2)), width - 1.6, 1.9, draw)
    for k in range(draw.whole(2, 3)):
        pieces.tree(town, at.moved((k / 2 - 0.5) * (width - 1.5), draw.uniform(1.6, max(depth - 1.5, 1.7))), draw)


def _back(town: Town, site: _Site, lots: Lots, leafy: float, draw: Draw) -> None:
    """A second row, of taller houses and trees, whose roofs are seen above the first."""
    s = -site.half - 22.0
    while s < site.half + 22.0:
        w = draw.uniform(7.0, 10.0)
        at = site.frame.moved(s + w / 2, site.edge + BACK + draw.uniform(0.0, 5.0))
        if not lots.take(at, w, 8.0):
            s += 1.0
            continue
        if draw.uniform() < 0.3 + 0.5 * leafy:
            pieces.tree(town, at.moved(-0.2 * w, 1.0), draw)
            pieces.tree(town, at.moved(0.25 * w, 3.0), draw)
        else:
            pieces.house(town, at, w, 8.0, 3 * draw.whole(0, 5), draw)
        s += w + draw.uniform(0.0, 2.0)


def _tower(town: Town, site: _Site, draw: Draw) -> None:
    """A church tower over the roofs."""
    at, half, high = site.frame.moved(draw.uniform(-12.0, 12.0), site.edge + 26.0), 2.1, 15.0
    town.firm.box(at, (-half, -half, 0.0), (half, half, high), paint("wall_dark"))
    corners = [(-half, -half), (half, -half), (half, half), (-half, half)]
    for (a, b), (c, d) in zip(corners, corners[1:] + corners[:1], strict=True):
        town.firm.quad(
            at, [(a, b, high), (c, d, high), (0.0, 0.0, high + 7.0), (0.0, 0.0, high + 7.0)], paint("roof_slate")
        )
