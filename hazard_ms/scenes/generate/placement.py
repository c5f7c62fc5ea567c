"""Finds places for furniture by the rules of a layout: nothing touches, doors stay free, windows stay visible."""

from __future__ import annotations

import math

from hazard_ms.scenes.assets.index import asset
from hazard_ms.scenes.assets.rows import Asset
from hazard_ms.scenes.boxes import Box
from hazard_ms.scenes.generate.arrangement import MIN_GAP, RESTING_HEIGHT, YAW_AT_WALL, Arrangement
from hazard_ms.scenes.generate.layout import (
    Against,
    Around,
    Before,
    Corner,
    Either,
    Hanging,
    OnTop,
    Row,
    Rug,
    Rule,
    Standing,
)
from hazard_ms.scenes.generate.support_surfaces import surfaces_of
from hazard_ms.scenes.walls import on_wall, wall_length

ROW_GAP = 0.012  # between pieces of a row [m]
WALL_GAP = 0.015  # between a wall and what stands against it: the skirting is 12 mm thick [m]
TRIES = 25  # draws for one piece


def place(rule: Rule, made: Arrangement) -> bool:
    """Put the pieces that `rule` asks for; False if they find no place."""
    if isinstance(rule, Either):
        return any(place(one, made) for one in made.draw.shuffled(rule.rules))
    if isinstance(rule, Row):
        return _row(rule, made)
    if isinstance(rule, Around):
        return _around(rule, made)
    if isinstance(rule, Hanging) and rule.of:
        return _behind(rule, made)
    model = made.model(rule.category)
    if model is None:
        return False
    for _ in range(TRIES):
        pose = _pose(rule, asset(model), made)
        if pose is not None and made.try_at(rule.category, model, *pose, against=not isinstance(rule, Rug)):
            return True
        model = made.model(rule.category) or model
    return False


def _pose(
    rule: Against | Corner | Standing | Before | OnTop | Rug | Hanging, model: Asset, made: Arrangement
) -> tuple[float, float, float, float] | None:
    """A drawn pose: x, y, z [m], yaw [rad]."""
    if isinstance(rule, Against):
        return _against(rule, model, made)
    if isinstance(rule, Corner):
        return _corner(rule, model, made)
    if isinstance(rule, Before):
        return _before(rule, model, made)
    if isinstance(rule, OnTop):
        return _on_top(rule, model, made)
    if isinstance(rule, Rug):
        return _under(rule, made)
    if isinstance(rule, Hanging):
        x, y, _, yaw = _against(Against(rule.category, rule.walls, (0.1, 0.9)), model, made)
        return x, y, rule.height, yaw
    (left, lower, right, upper), (w, d) = rule.area, made.room.size
    yaw = made.draw.one(rule.yaws) + made.draw.uniform(-rule.sway, rule.sway)
    return made.draw.uniform(left, right) * w, made.draw.uniform(lower, upper) * d, 0.0, math.radians(yaw)


def _against(rule: Against, model: Asset, made: Arrangement) -> tuple[float, float, float, float]:
    wall = made.draw.one(rule.walls)
    length, half = wall_length(made.room, wall), model.extent[0] / 2 + 0.02
    low, high = max(rule.reach[0] * length, half), min(rule.reach[1] * length, length - half)
    x, y, _ = on_wall(made.room, wall, made.draw.uniform(low, max(low, high)), 0.0, -(WALL_GAP + model.extent[1] / 2))
    return x, y, 0.0, math.radians(YAW_AT_WALL[wall])


def _corner(rule: Corner, model: Asset, made: Arrangement) -> tuple[float, float, float, float]:
    back, side = made.draw.one(rule.corners).split("-")
    half = model.extent[0] / 2 + made.draw.uniform(0.03, 0.1)
    along = half if side == "west" else made.room.size[0] - half
    x, y, _ = on_wall(made.room, back, along, 0.0, -(WALL_GAP + model.extent[1] / 2))
    return x, y, 0.0, math.radians(YAW_AT_WALL[back])


def _before(rule: Before, model: Asset, made: Arrangement) -> tuple[float, float, float, float] | None:
    there = made.named(rule.of)
    if not there:
        return None
    box = there[-1][1]
    away = box.half_y + made.draw.uniform(*rule.distance) + model.extent[1] / 2
    x, y = box.world(made.draw.uniform(-0.15, 0.15), -away)
    return x, y, 0.0, box.yaw


def _under(rule: Rug, made: Arrangement) -> tuple[float, float, float, float] | None:
    there = made.named(rule.of)
    if not there:
        return None
    box, draw = there[-1][1], made.draw
    x, y = box.world(draw.uniform(-rule.aside, rule.aside), draw.uniform(-rule.aside, rule.aside))
    return x, y, 0.0, box.yaw + math.radians(draw.uniform(-rule.sway, rule.sway))


def _on_top(rule: OnTop, model: Asset, made: Arrangement) -> tuple[float, float, float, float] | None:
    places = [s for f, b in made.named(rule.of) for s in surfaces_of(f.name, asset(f.asset), f.scale, b)]
    places = [s for s in places if s.headroom >= model.extent[2] + MIN_GAP and s.z > 0.3]
    if not places:
        return None
    place = made.draw.one(places)
    spare_x, spare_y = place.half[0] - model.extent[0] / 2, place.half[1] - model.extent[1] / 2
    if min(spare_x, spare_y) < 0.0:
        return None
    x, y = place.point(made.draw.uniform(-spare_x, spare_x), made.draw.uniform(0.0, spare_y))  # towards the back
    return x, y, place.z + RESTING_HEIGHT, place.box.yaw


def _row(rule: Row, made: Arrangement) -> bool:
    """The pieces of a row, all or none; pieces of one category are the same model."""
    length = wall_length(made.room, rule.wall)
    for _ in range(TRIES):
        kept = len(made.fixtures)
        models = {c: made.model(c) for c in dict.fromkeys(rule.categories)}
        reached, fits = made.draw.uniform(*rule.start), True
        for category in rule.categories:
            model = models[category]
            if model is None:
                continue
            wide, deep, _ = asset(model).extent
            x, y, _ = on_wall(made.room, rule.wall, reached + wide / 2, 0.0, -(WALL_GAP + deep / 2))
            reached += wide + ROW_GAP
            fits = reached <= length and made.try_at(category, model, x, y, 0.0, math.radians(YAW_AT_WALL[rule.wall]))
            if not fits:
                break
        if fits and len(made.fixtures) > kept:
            return True
        del made.fixtures[kept:], made.boxes[kept:]
    return False


def _around(rule: Around, made: Arrangement) -> bool:
    """Pieces at the sides of another, each facing it."""
    model, there = made.model(rule.category), made.named(rule.of)
    if model is None or not there:
        return False
    box, (wide, deep, _) = there[-1][1], asset(model).extent
    wanted, count = made.draw.whole(*rule.count), 0
    for side, along in made.draw.shuffled(_seats(box, wide)):
        half = box.half_y if side in (0, 2) else box.half_x
        away = half + made.draw.uniform(*rule.distance) + deep / 2
        out = math.radians((-90.0, 0.0, 90.0, 180.0)[side])  # direction from the box, in its frame
        x, y = box.world(
            math.cos(out) * away + abs(math.sin(out)) * along, math.sin(out) * away + abs(math.cos(out)) * along
        )
        yaw = box.yaw + out - math.pi / 2 + math.radians(made.draw.uniform(-8.0, 8.0))
        count += count < wanted and made.try_at(rule.category, model, x, y, 0.0, yaw)
    return count >= rule.count[0]


def _behind(rule: Hanging, made: Arrangement) -> bool:
    """Pieces of one model on the wall behind others, back to back with them."""
    model, count = made.model(rule.category), 0
    for _, box in made.named(rule.of) if model is not None else ():
        assert model is not None
        x, y = box.world(0.0, box.half_y - asset(model).extent[1] / 2)
        count += made.try_at(rule.category, model, x, y, rule.height, box.yaw)
    return count > 0


def _seats(box: Box, wide: float) -> list[tuple[int, float]]:
    """Places around a box: side (0 at -y, then anticlockwise) and offset along it [m]."""
    places: list[tuple[int, float]] = []
    for side in range(4):
        half = box.half_x if side in (0, 2) else box.half_y
        number = max(1, int(2 * half // (wide + 0.15)))
        places += [(side, (k + 0.5) * 2 * half / number - half) for k in range(number)]
    return places
