"""Furnishes an outdoor region by its rules; nothing touches, and what does not fit is left out."""

from __future__ import annotations

import math

from hazard_ms.scenes import boxes
from hazard_ms.scenes.assets.index import asset
from hazard_ms.scenes.boxes import Box
from hazard_ms.scenes.generate.arrangement import Arrangement, models_of
from hazard_ms.scenes.generate.draw import Draw
from hazard_ms.scenes.generate.regions import BEYOND, REGION_SIZE, SKY, Area, Fronts, Line, Region, Rule, Some
from hazard_ms.spec import Fixture, Patch, Room, Vec2

PIECE_GAP = 0.06  # between any two pieces [m]
LINE_GAP = 0.005  # between pieces of one line [m]
RIM_GAP = 0.05  # from the rim of the square [m]
TRIES = 25  # draws for one piece


def lay_out(region: Region, draw: Draw) -> Arrangement:
    """A furnished region, turned by a random number of quarter turns."""
    turns = draw.whole(0, 3)
    patches = tuple(Patch(g.material, *_turned_area(g.area, turns)) for g in region.grounds)
    room = Room((REGION_SIZE, REGION_SIZE), SKY, region.base, "plaster", patches=patches, open_air=True, beyond=BEYOND)
    made = Arrangement(room, draw)
    for rule in region.rules:
        _follow(rule, made, turns)
    return made


def _follow(rule: Rule, made: Arrangement, turns: int) -> None:
    if isinstance(rule, Some):
        _some(rule, made, turns)
    elif isinstance(rule, Line):
        _line(rule, made, turns)
    else:
        _fronts(rule, made, turns)


def _some(rule: Some, made: Arrangement, turns: int) -> None:
    """Each piece gets a number of tries; crowded places get fewer pieces."""
    draw, (left, lower, right, upper) = made.draw, rule.area
    categories = [c for c in rule.categories if models_of(c)]
    for _ in range(draw.whole(*rule.count) if categories else 0):
        category = draw.one(categories)
        model = draw.one(models_of(category))
        for _ in range(TRIES):
            yaw = draw.one(rule.yaws) + draw.uniform(-rule.sway, rule.sway)
            if _put(made, category, model, (draw.uniform(left, right), draw.uniform(lower, upper)), yaw, turns):
                break


def _line(rule: Line, made: Arrangement, turns: int) -> None:
    draw = made.draw
    categories = [c for c in rule.categories if models_of(c)]
    if not categories:
        return
    category = draw.one(categories)
    model = draw.one(models_of(category))
    length = math.dist(rule.start, rule.end)
    step = rule.every or asset(model).extent[0] + LINE_GAP
    places = math.floor(length / step + (1.0 if rule.every else 0.0) + 1e-9)
    left_out = math.ceil(rule.open / step)
    entrance = draw.whole(0, max(places - left_out, 0))
    for k in range(places):
        if entrance <= k < entrance + left_out or (rule.share < 1.0 and draw.uniform() >= rule.share):
            continue
        share = (k + (0.0 if rule.every else 0.5)) * step / max(length, 1e-9)
        x, y = (a + (b - a) * share for a, b in zip(rule.start, rule.end, strict=True))
        chosen = draw.one(models_of(category)) if rule.every else model  # a fence is of one kind
        _put(made, category, chosen, (x, y), rule.yaw, turns, PIECE_GAP if rule.every else 0.0)


def _fronts(rule: Fronts, made: Arrangement, turns: int) -> None:
    """Houses one beside the other, the next one begins where the last one ends."""
    draw, models = made.draw, models_of("house")
    length = math.dist(rule.start, rule.end)
    along = ((rule.end[0] - rule.start[0]) / length, (rule.end[1] - rule.start[1]) / length)
    yaw = math.radians(rule.yaw)
    behind = (-math.sin(yaw), math.cos(yaw))  # away from where they face
    at = 0.0
    while models:
        model = draw.one(models)
        wide, deep, _ = asset(model).extent
        if at + wide > length:
            break
        x, y = (rule.start[k] + along[k] * (at + wide / 2) + behind[k] * deep / 2 for k in (0, 1))
        _put(made, "house", model, (x, y), rule.yaw, turns, anywhere=True)
        at += wide + draw.uniform(*rule.between)


def _put(
    made: Arrangement,
    category: str,
    model: str,
    place: Vec2,
    yaw: float,
    turns: int,
    gap: float = PIECE_GAP,
    anywhere: bool = False,
) -> bool:
    """Put a piece there if it fits: within the square, or `anywhere` within reach of the wind."""
    x, y = _turned(place, turns)
    number = 1 + sum(f.category == category for f in made.fixtures)
    piece = Fixture(
        f"{category}_{number}",
        category,
        model,
        (round(x, 4), round(y, 4), 0.0),
        boxes.turned(math.radians(yaw + 90.0 * turns)),
    )
    box = boxes.box_of(piece, asset(model).extent)
    if not _within(box, -BEYOND if anywhere else RIM_GAP) or not boxes.free_of(box, boxes.rows(made.boxes), gap):
        return False
    made.fixtures.append(piece)
    made.boxes.append(box)
    return True


def _within(box: Box, edge: float) -> bool:
    return all(edge <= x <= REGION_SIZE - edge and edge <= y <= REGION_SIZE - edge for x, y in box.corners())


def _turned(place: Vec2, turns: int) -> Vec2:
    """`place` after this many quarter turns about the middle of the square."""
    x, y = place[0] - REGION_SIZE / 2, place[1] - REGION_SIZE / 2
    for _ in range(turns % 4):
        x, y = -y, x
    return x + REGION_SIZE / 2, y + REGION_SIZE / 2


def _turned_area(area: Area, turns: int) -> tuple[Vec2, Vec2]:
    (ax, ay), (bx, by) = _turned(area[:2], turns), _turned(area[2:], turns)
    return (round(min(ax, bx), 4), round(min(ay, by), 4)), (round(max(ax, bx), 4), round(max(ay, by), 4))
