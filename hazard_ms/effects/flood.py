"""The effects of a flood: its surface, the water that is looked through, and wet things, all driven by its state.

The surface is a mesh over every part of the room that water can reach; each corner knows its path length from the
source wall, and the pose of the one entity tells the level there and the slope. So it is the hazard's own surface, and
nothing is built or sent anew as it rises.
"""

from __future__ import annotations

import itertools
import math
from typing import ClassVar

import numpy as np
import sapien
import torch
from sapien.render import RenderMaterial, RenderShapeTriangleMesh
from torch import Tensor

from hazard_ms.effects.entities import FRAMES_PER_SECOND, Effect, dry_ior, entities_of, make_effect, materials
from hazard_ms.effects.scene_effects import Place, SceneEffects
from hazard_ms.effects.shaders.common import WATER
from hazard_ms.effects.shaders.water import WET_IOR
from hazard_ms.effects.surroundings import Surroundings
from hazard_ms.effects.textures import ripple_texture
from hazard_ms.hazards.flood import flow_paths
from hazard_ms.hazards.flood.flood import FloodState
from hazard_ms.hazards.flood.realistic import floor_plan
from hazard_ms.hazards.flood.realistic.inundation_state import InundationState
from hazard_ms.simulation.world import World
from hazard_ms.spec import SceneSpec

MESH_CELL = 0.25  # of the surface's mesh where water goes around corners [m] [ours]
INSIDE = 1e-4  # by which a corner of the mesh lies in its own part of the room [m]
SOAKED_AT = 0.3  # share of a thing under water at which it is wet all over [ours]


class _SceneFlood:
    """The flood of one scene."""

    def __init__(self, scene: sapien.Scene, spec: SceneSpec, names: tuple[str, ...], around: Surroundings) -> None:
        self._scene, self._spec, self._around = scene, spec, around
        self._surface: Effect | None = None
        self.lead(paths_of(spec))
        self._things = [materials(e) for e in entities_of(scene, names)]
        self._wet = [0.0] * len(names)

    def lead(self, paths: flow_paths.FlowPaths) -> None:
        """Let the water come along `paths`, [1, ...], from now on."""
        self.reached = paths.doorway_distance[0].tolist()
        self._path_length = _path_lengths(paths, self._around.places)[0]
        if self._surface is not None:
            self._scene.remove_entity(self._surface.entity)
        spec = self._spec
        self._surface = make_effect(
            self._scene, ripple_texture(), lambda material: surface_mesh(spec, paths, material), 0
        )
        if self._surface is not None:
            material = self._surface.material
            material.transmission_texture = self._around.texture
            material.transmission = 1.0

    def show(self, level: float, slope: float, time: float, surface: np.ndarray | None, size: tuple[int, int]) -> None:
        """Show water at `level` [m] at its source, with a surface slope.

        `surface` gives its height on a grid of `size` cells, [N] [m], unless it is a plane; it is drawn at its mean.
        """
        if surface is None:
            self._around.water(level - slope * self._path_length, time)
        else:
            self._around.water(surface[floor_plan.cells_at(self._around.places, size)], time)
        if self._surface is None:
            return
        half = math.atan(slope) / 2
        if level > 0.0:
            self._surface.show(sapien.Pose([0.0, 0.0, level], [math.cos(half), 0.0, 0.0, math.sin(half)]), 1.0, time)
        else:
            self._surface.hide()

    def wet(self, shares: np.ndarray) -> None:
        """Show how wet things are, 0..1, [B]."""
        for k, parts in enumerate(self._things):
            share = round(float(shares[k]), 3)
            if share != self._wet[k]:
                for material in parts:
                    material.ior = dry_ior(material) + WET_IOR * share
                self._wet[k] = share


class FloodEffects(SceneEffects):
    """The effects of a flood in each of E scenes. The mode `fast` shows no ripples of light on the ground."""

    layer: ClassVar[int] = 0  # below all that burns and flies: smoke in front of it would cut holes into it

    @classmethod
    def of_scene(cls, place: Place) -> _SceneFlood:
        assert place.around is not None  # a flood fills the space of its scene
        return _SceneFlood(place.scene, place.spec, place.names, place.around)

    def show(self, world: World, flood: FloodState, frame: Tensor) -> None:
        wet = torch.maximum(flood.fraction / SOAKED_AT, flood.soaked).clamp(max=1.0).cpu().numpy()
        level, slope, time = (t.cpu().tolist() for t in (flood.level, flood.surface_slope, frame / FRAMES_PER_SECOND))
        surface = flood.surface.cpu().numpy() if isinstance(flood, InundationState) else None
        size = floor_plan.size_of([spec.room for spec in world.specs])
        for e, scene in enumerate(self._scenes):
            if surface is None and world.openings.inner and scene.reached != flood.doorway_distance[e].tolist():
                scene.lead(_paths_in(flood, e))  # a door was opened or shut
            scene.show(level[e], slope[e], time[e], None if surface is None else surface[e], size)
            scene.wet(wet[e])


def surface_corners(spec: SceneSpec, paths: flow_paths.FlowPaths) -> tuple[np.ndarray, np.ndarray]:
    """The surface of the water over the floor of a room as Q quads, as far as it gets along `paths`, [1, ...].

    Returns the places of their corners [m], [Q, 4, 2], and what these carry, [Q, 4, 3]: path length of the water [m],
    its direction [rad], kind.
    """
    room = spec.room
    low, high = -room.beyond, (room.size[0] + room.beyond, room.size[1] + room.beyond)
    cuts = [sorted([low, high[k], *(p.at for p in room.partitions if p.axis == "yx"[k])]) for k in (0, 1)]
    corners = []
    for (x0, x1), (y0, y1) in itertools.product(*(itertools.pairwise(c) for c in cuts)):
        bent = room.partitions or spec.second_flood_side is not None  # else the surface is one plane
        count = [math.ceil((b - a) / MESH_CELL) if bent else 1 for a, b in ((x0, x1), (y0, y1))]
        xs, ys = (
            np.linspace(a + INSIDE, b - INSIDE, n + 1) for (a, b), n in zip(((x0, x1), (y0, y1)), count, strict=True)
        )
        at = np.stack(np.meshgrid(xs, ys), -1)
        corners.append(np.stack([at[:-1, :-1], at[:-1, 1:], at[1:, 1:], at[1:, :-1]], 2).reshape(-1, 4, 2))
    place = np.concatenate(corners)
    length, turn = _path_lengths(paths, place)
    reached = length.max(axis=1) < flow_paths.NEVER / 2
    return place[reached], np.stack([length, turn, np.full_like(length, WATER)], -1)[reached]


def surface_mesh(
    spec: SceneSpec, paths: flow_paths.FlowPaths, material: RenderMaterial
) -> RenderShapeTriangleMesh | None:
    """The mesh of `surface_corners`, whose vertices coincide; None if water gets nowhere."""
    place, data = (c.reshape(-1, c.shape[-1]).astype(np.float32) for c in surface_corners(spec, paths))
    if len(place) == 0:
        return None
    first = 4 * np.arange(len(place) // 4)[:, None]
    faces = (first + np.array([[0, 1, 2, 0, 2, 3, 2, 1, 0, 3, 2, 0]])).reshape(-1, 3)  # both sides
    return RenderShapeTriangleMesh(
        np.zeros((len(place), 3), np.float32), faces.astype(np.uint32), data, place, material
    )


def _paths_in(flood: FloodState, e: int) -> flow_paths.FlowPaths:
    """The paths of the water in environment `e` as they are now, [1, ...]."""
    return flow_paths.FlowPaths(*(getattr(flood, name)[e : e + 1].cpu() for name in flow_paths.FlowPaths._fields))


def paths_of(spec: SceneSpec) -> flow_paths.FlowPaths:
    """The paths of water from the source walls of the scene's room at its start, [1, ...]."""
    counts = flow_paths.sizes((spec,))
    made = flow_paths.paths_of(spec, counts["W"], counts["D"])
    shapes = {"partition": (1, counts["W"], 2), "doorway": (1, counts["D"], 4), "doorway_part": (1, counts["D"], 2)}
    whole = ("source_part", "doorway_part")
    return flow_paths.FlowPaths(
        **{
            name: torch.tensor([made[name]], dtype=torch.int64 if name in whole else torch.float32).reshape(
                shapes.get(name, (1, *np.shape(made[name])))
            )
            for name in flow_paths.FlowPaths._fields
        }
    )


def _path_lengths(paths: flow_paths.FlowPaths, place: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The path length of the water [m] and its direction [rad from +x] at `place` [m], [..., 2]: [...] each."""
    flat = torch.from_numpy(place.reshape(1, -1, 2)).float()
    far, toward = flow_paths.path_lengths(paths, torch.nn.functional.pad(flat, (0, 1)))
    turn = torch.atan2(toward[..., 1], toward[..., 0])
    return far.numpy().reshape(place.shape[:-1]), turn.numpy().reshape(place.shape[:-1])
