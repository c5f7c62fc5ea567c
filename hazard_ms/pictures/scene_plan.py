"""Pictures of a scene: a labelled plan as seen from above, and a view from a corner."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from hazard_ms.pictures.files import save as save_picture
from hazard_ms.scenes.boxes import Box
from hazard_ms.scenes.floor import OVERHEAD_HEIGHT, RUG_HEIGHT, boxes_of
from hazard_ms.scenes.materials import MATERIALS
from hazard_ms.scenes.shell import ShellBox, shell
from hazard_ms.simulation.bare_scene import build
from hazard_ms.simulation.drawing.viewpoint import corner_view
from hazard_ms.spec import SceneSpec

WIDTH, HEIGHT, FIELD_OF_VIEW = 640, 480, 1.15  # of the view [pixels], [rad]
SCALE = 110  # of the plan of a room [pixels per m]
LARGEST = 1600  # longer edge of a plan, at most [pixels]
EDGE = 0.3  # around the plan [m]
QUALITY = 95  # of a JPEG, of 100: thin lines and small letters [ours]
INK, FURNITURE, RUG = (40, 40, 40), (196, 182, 160), (214, 180, 176)
THING, TARGET, FIRE, AGENT, WATER = (120, 150, 190), (215, 60, 50), (255, 140, 0), (30, 130, 60), (60, 120, 220)

Image = NDArray[np.uint8]


class Plan:
    """A sheet of paper with a scale: draws what is given in metres."""

    def __init__(self, spec: SceneSpec) -> None:
        w, d = spec.room.size
        self.scale = min(SCALE, LARGEST / (max(w, d) + 2 * EDGE))
        self.height = d + 2 * EDGE
        self.image: Image = np.full(
            (round(self.height * self.scale), round((w + 2 * EDGE) * self.scale), 3), 255, np.uint8
        )

    def at(self, x: float, y: float) -> tuple[int, int]:
        """The pixel of a point of the floor."""
        return round((x + EDGE) * self.scale), round((self.height - EDGE - y) * self.scale)

    def area(self, box: Box, colour: tuple[int, int, int], outline: bool = False) -> None:
        """The footprint of a box, or its outline only."""
        corners = np.array([self.at(x, y) for x, y in box.corners()])
        if not outline:
            cv2.fillPoly(self.image, [corners], colour, cv2.LINE_AA)
        cv2.polylines(self.image, [corners], True, INK, 1, cv2.LINE_AA)

    def write(self, text: str, x: float, y: float, size: float = 0.33) -> None:
        """Words centred on a point."""
        (w, h), _ = cv2.getTextSize(text, cv2.FONT_HERSHEY_SIMPLEX, size, 1)
        px, py = self.at(x, y)
        cv2.putText(self.image, text, (px - w // 2, py + h // 2), cv2.FONT_HERSHEY_SIMPLEX, size, INK, 1, cv2.LINE_AA)


def plan(spec: SceneSpec) -> Image:
    """The scene from above, [H, W, 3], RGB: furniture and targets by name, other things, fires, start, water."""
    sheet = Plan(spec)
    for part in shell(spec.room):
        if part.kind in ("floor", "wall", "door", "window"):
            sheet.area(_flat(part), _colour(part))
    furniture, things = boxes_of(spec)
    for box in sorted(furniture, key=lambda box: box.high):
        colour = RUG if box.high - box.low < RUG_HEIGHT else FURNITURE
        sheet.area(box, colour, outline=box.low > OVERHEAD_HEIGHT)
    for b, box in zip(spec.bodies, things, strict=True):
        sheet.area(box, TARGET if b.category in spec.target_categories else THING)
    for f in spec.fixtures:
        if f.position[2] <= OVERHEAD_HEIGHT:
            sheet.write(f.name, *f.position[:2])
    for t in spec.targets:
        sheet.write(t.name, t.position[0], t.position[1] - 0.14, 0.36)
    _marks(sheet, spec)
    return sheet.image


def _marks(sheet: Plan, spec: SceneSpec) -> None:
    """Fires, the agent's start with its heading, and the side of the flood."""
    for x, y in spec.fires:
        cv2.circle(sheet.image, sheet.at(x, y), round(0.1 * sheet.scale), FIRE, -1, cv2.LINE_AA)
        sheet.write("fire", x, y)
    x, y = spec.agent_start.position
    dx, dy = np.cos(spec.agent_start.heading), np.sin(spec.agent_start.heading)
    cv2.circle(sheet.image, sheet.at(x, y), round(0.29 * sheet.scale), AGENT, 2, cv2.LINE_AA)
    cv2.arrowedLine(sheet.image, sheet.at(x, y), sheet.at(x + 0.5 * dx, y + 0.5 * dy), AGENT, 2, cv2.LINE_AA)
    (w, d), out = spec.room.size, EDGE / 2
    ends = {
        "south": ((0, -out), (w, -out)),
        "north": ((0, d + out), (w, d + out)),
        "west": ((-out, 0), (-out, d)),
        "east": ((w + out, 0), (w + out, d)),
    }
    for side in filter(None, (spec.flood_side, spec.second_flood_side)):
        start, end = ends[side]
        cv2.line(sheet.image, sheet.at(*start), sheet.at(*end), WATER, 4, cv2.LINE_AA)


def view(spec: SceneSpec) -> Image:
    """The scene from the corner in which the third person stands, [HEIGHT, WIDTH, 3], RGB.

    Raises ValueError where nothing draws.
    """
    scene: Any = build(spec, draw=True).scene
    camera = scene.sub_scenes[0].add_camera("view", WIDTH, HEIGHT, FIELD_OF_VIEW, 0.05, 100.0)
    camera.entity.set_pose(corner_view(spec))
    scene.sub_scenes[0].update_render()
    camera.take_picture()
    seen = camera.get_picture("Color")[..., :3]
    return (np.clip(seen, 0.0, 1.0) * 255).astype(np.uint8)


def sheet(spec: SceneSpec) -> Image:
    """Plan and view side by side, [H, W, 3], RGB, under the scene's name."""
    left, right = plan(spec), view(spec)
    tall = max(left.shape[0], right.shape[0])
    sides = [np.concatenate([p, np.full((tall - len(p), p.shape[1], 3), 255, np.uint8)]) for p in (left, right)]
    title = np.full((26, sum(s.shape[1] for s in sides), 3), 255, np.uint8)
    targets = ", ".join(spec.target_categories)
    water = " and ".join(filter(None, (spec.flood_side, spec.second_flood_side)))
    words = f"{spec.name} ({spec.split}): {len(spec.bodies)} things, targets {targets}; water from {water}"
    cv2.putText(title, words, (6, 18), cv2.FONT_HERSHEY_SIMPLEX, 0.45, INK, 1, cv2.LINE_AA)
    return np.concatenate([title, np.concatenate(sides, axis=1)])


def save(spec: SceneSpec, path: Path) -> None:
    """Write plan and view of `spec` as a picture. Raises ValueError when the file cannot be written."""
    if path.suffix.lower() not in (".png", ".jpg", ".jpeg"):
        raise ValueError(f"output must end in .png, .jpg or .jpeg, got {path.suffix!r}")
    if not path.parent.is_dir():
        raise ValueError(f"output must be in a folder that exists, got {path}: there is no folder {path.parent}")
    save_picture(path, sheet(spec), QUALITY)


def _flat(b: ShellBox) -> Box:
    return Box(b.centre[0], b.centre[1], b.size[0] / 2, b.size[1] / 2, 0.0, 0.0, 0.0)


def _colour(b: ShellBox) -> tuple[int, int, int]:
    """A light shade of a material's colour; walls are dark."""
    if b.kind == "wall":
        return (110, 110, 110)
    r, g, blue = (round(255 * (0.65 + 0.35 * c**0.45)) for c in MATERIALS[b.material])
    return r, g, blue
