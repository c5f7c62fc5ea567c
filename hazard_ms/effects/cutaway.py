"""A home as a doll's house, for spectators: without its ceiling, and with its walls cut at the height of a table.

While it is cut, walls, doors and windows stand only up to CUT, with dark tops as plans show cut walls.
What hangs higher, and soot, which lies on what is taken off, are not drawn. Nothing but the picture changes, and the
robot's own eyes never see it so.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import sapien
from sapien.render import RenderBodyComponent, RenderMaterial

from hazard_ms.effects.soot import SHEET
from hazard_ms.scenes.shell import ShellBox, leaf, shell
from hazard_ms.simulation.drawing.textured_box import surface_material, textured_box
from hazard_ms.spec import SceneSpec
from hazard_ms.spec.names import plain_name

CUT = 1.1  # height at which walls are cut [m] [ours: above tables, below the handles of cupboards]
TOP = 0.02  # thickness of the dark top of a cut wall [m] [ours]
TABLE = (80.0, 0.1, -0.4)  # edge, thickness and height of the dark ground that a home is seen on [m] [ours]
DARK = (0.004, 0.005, 0.007, 1.0)  # of the tops and the ground: linear red, green, blue, opacity [ours]
DOOR_TOP = (0.60, 0.22, 0.04, 1.0)  # of the tops of doors, which stand out from those of walls [ours]
SOLID = ("floor", "enclosure")  # kinds of boxes that stay

Part = tuple[sapien.Entity, sapien.Entity, sapien.Pose]  # a leaf, a part of a lower one, its place in the leaf's frame


class Cutaway:
    """A home that is cut open between `__enter__` and `__exit__`: take pictures of spectators within."""

    def __init__(self, scene: sapien.Scene, spec: SceneSpec) -> None:
        """Prepare to cut open the home `spec`, which stands in `scene`."""
        boxes = {f"shell_{i}_{box.name}": box for i, box in enumerate(shell(spec.room))}
        names = {name for name, box in boxes.items() if box.kind not in SOLID and _top(box) > CUT}
        names |= {fixture.name for fixture in spec.fixtures if fixture.position[2] > CUT}
        self._whole = [b for e in scene.entities if plain_name(e.name) in names for b in _bodies(e)]
        self._soot = [b for e in scene.entities if e.name.startswith(SHEET) for b in _bodies(e)]
        dark = RenderMaterial(base_color=list(DARK), roughness=0.9, specular=0.0)
        edge, thick, high = TABLE
        x, y = spec.room.size
        self._cut = [_box(scene, (edge, edge, thick), (x / 2, y / 2, high), dark)]
        for name in sorted(names & boxes.keys()):
            box = boxes[name]
            low = box.centre[2] - box.size[2] / 2
            if low < CUT - TOP:
                (a, b, _), (wide, deep, _) = box.centre, box.size
                material = surface_material(box.material)
                self._cut.append(_box(scene, (wide, deep, CUT - TOP - low), (a, b, (low + CUT - TOP) / 2), material))
                self._cut.append(_box(scene, (wide, deep, TOP), (a, b, CUT - TOP / 2), dark))
        self._leaves = list(self._doors(scene, spec))
        self.__exit__()

    def _doors(self, scene: sapien.Scene, spec: SceneSpec) -> Iterator[Part]:
        """Note the leaves of doors and build lower ones: each leaf, each part of a lower one, and its place there."""
        top = RenderMaterial(base_color=list(DOOR_TOP), roughness=0.9, specular=0.0)
        found = {plain_name(e.name): e for e in scene.entities}
        for number, opening in enumerate(spec.room.openings):
            entity = found.get(f"leaf_{number}")
            if entity is None:
                continue
            self._whole += _bodies(entity)
            box = leaf(spec.room, opening)
            low, middle = box.centre[2] - box.size[2] / 2, box.centre[2]
            for (bottom, high), material in (
                ((low, CUT - TOP), surface_material(box.material)),
                ((CUT - TOP, CUT), top),
            ):
                body = _box(scene, (*box.size[:2], high - bottom), (0.0, 0.0, 0.0), material)
                self._cut.append(body)
                yield entity, body.entity, sapien.Pose([0.0, 0.0, (bottom + high) / 2 - middle])

    def __enter__(self) -> Cutaway:
        for entity, part, place in self._leaves:
            part.set_pose(entity.pose * place)
        self._show(whole=0.0, cut=1.0)
        return self

    def __exit__(self, *_: Any) -> None:
        self._show(whole=1.0, cut=0.0)

    def _show(self, whole: float, cut: float) -> None:
        for bodies, seen in ((self._whole, whole), (self._soot, whole), (self._cut, cut)):
            for body in bodies:
                body.visibility = seen


def _top(box: ShellBox) -> float:
    return box.centre[2] + box.size[2] / 2


def _bodies(entity: sapien.Entity) -> Iterator[RenderBodyComponent]:
    body = entity.find_component_by_type(RenderBodyComponent)
    if body is not None:
        yield body


def _box(
    scene: sapien.Scene, size: tuple[float, float, float], centre: tuple[float, float, float], material: RenderMaterial
) -> RenderBodyComponent:
    """A box without collision and label, of edge lengths and with its middle at [m]."""
    body = RenderBodyComponent()
    body.attach(textured_box(size, material))
    body.disable_render_id()
    entity = sapien.Entity()
    entity.name = "cutaway"
    entity.add_component(body)
    entity.set_pose(sapien.Pose(list(centre)))
    scene.add_entity(entity)
    return body
