"""SceneSpec -> SAPIEN actors: the room's shell, furniture, movable bodies with their true masses. Built once per reconfiguration."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from typing import Any

import numpy as np
import sapien
import torch
from mani_skill.utils.sapien_utils import look_at
from mani_skill.utils.structs import Actor
from mani_skill.utils.structs.pose import Pose

from hazard_ms.assets import Asset, asset, asset_path
from hazard_ms.plain import colour
from hazard_ms.scenes.boxes import Box, box_of
from hazard_ms.scenes.shell import shell
from hazard_ms.simulator import CpuHandles, GpuHandles
from hazard_ms.spec import Body, Fixture, Room, SceneSpec
from hazard_ms.surfaces import surface_material, textured_box
from hazard_ms.world import World

FRICTION = 0.5  # [-] Coulomb, static and dynamic: wood on wood 0.25-0.5, most household pairs 0.3-0.6 (Engineering ToolBox) [ours]
PARTING = 0.5  # at most, of things that start inside each other [m/s]: they part instead of exploding [ours]
FLAT = 0.03  # a robot's base glides over what lies lower on the floor: rugs [m] [ours]
SLAB = 1.0  # thickness of what encloses a room [m]: a robot that leans on a thing cannot squeeze it through
BAG, BAG_SCALE = "basket_2", 0.8  # the model that shows the bag, and its size
TALL, BESIDE = 1.3, 0.4  # what is this high hides what lies behind it, and so much to its sides, from a camera [m] [ours]
HIDING = 12.0  # for this much more distance the third person puts up with one thing in the view [m] [ours]
EYES_OUTDOORS = 6.0  # height of the third person's eyes in the open [m] [ours]
GLIDE_BITS = (30, 31)  # of collision group 2: ManiSkill's bits for what Fetch's wheels and base do not collide with


def extent_of(thing: Body | Fixture) -> tuple[float, float, float]:
    """Edge lengths of the thing's box along its own axes [m]."""
    x, y, z = (size * factor for size, factor in zip(asset(thing.asset).extent, thing.scale, strict=True))
    return x, y, z


def extent_of_bag() -> tuple[float, float, float]:
    """Edge lengths of the bag that the agent carries [m]."""
    x, y, z = (size * BAG_SCALE for size in asset(BAG).extent)
    return x, y, z


def mass_of(thing: Body | Fixture) -> float:
    """Mass [kg]: the scene's word, else the asset's, scaled with its volume."""
    if isinstance(thing, Body) and thing.mass is not None:
        return thing.mass
    return asset(thing.asset).mass * float(np.prod(thing.scale))


def make_world(specs: tuple[SceneSpec, ...], device: torch.device) -> World:
    """The world of `specs`, not yet tied to a simulator."""
    things = [s.things for s in specs]
    return World.of(specs, [[extent_of(t) for t in row] for row in things], [[mass_of(t) for t in row] for row in things], device)


def build_scenes(scene: Any, specs: tuple[SceneSpec, ...]) -> list[list[Actor]]:
    """Build every scene of `specs` into the sub-scene of the same number; per scene: the actors of its bodies, then of its fixtures."""
    rows: list[list[Actor]] = []
    for e, spec in enumerate(specs):
        build_shell(scene, spec, e)
        rows.append([build_thing(scene, t, e) for t in spec.things])
    if len(specs) > 1:
        _merge_bodies(scene, specs, rows)
    return rows


def build_shell(scene: Any, spec: SceneSpec, env: int) -> None:
    """Floor, walls, doors and windows, or ground: what is seen, and the thick slabs through which nothing can be pushed."""
    for i, box in enumerate(shell(spec.room) if scene.can_render() else ()):
        builder = scene.create_actor_builder()
        builder.set_scene_idxs([env])
        builder._procedural_shapes.append(textured_box(box.size, surface_material(box.material)))
        builder.initial_pose = sapien.Pose(list(box.centre))
        builder.build_static(name=f"{env}/shell_{i}_{box.name}")
    builder = scene.create_actor_builder()
    builder.set_scene_idxs([env])
    for slab in (*_enclosure(spec), *_partitions(spec)):
        builder.add_box_collision(sapien.Pose(slab[0]), half_size=slab[1], material=_friction())
    builder.initial_pose = sapien.Pose()
    builder.build_static(name=f"{env}/enclosure")


def _enclosure(spec: SceneSpec) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Middles and half sizes of six thick slabs around everything, in the open at the ends of what can be reached [m]."""
    low = np.array([-spec.room.beyond, -spec.room.beyond, 0.0])
    high = np.array([*spec.room.size, spec.room.height]) - low
    for axis in range(3):
        half = (high - low) / 2 + SLAB
        half[axis] = SLAB / 2
        for place in (low[axis] - SLAB / 2, high[axis] + SLAB / 2):
            centre = (low + high) / 2
            centre[axis] = place
            yield centre, half


def _partitions(spec: SceneSpec) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Middles and half sizes of the walls inside a room [m]."""
    names = tuple(f"wall_{p.name}_" for p in spec.room.partitions)
    for box in shell(spec.room) if names else ():
        if box.name.startswith(names):
            yield np.array(box.centre), np.array(box.size) / 2


def build_thing(scene: Any, thing: Body | Fixture, env: int) -> Actor:
    """One body or fixture, at its place."""
    builder = scene.create_actor_builder()
    builder.set_scene_idxs([env])
    kind = asset(thing.asset)
    add_collision(builder, kind, thing.scale, thing.friction if isinstance(thing, Body) else None)
    if kind.visual:
        builder.add_visual_from_file(str(asset_path(kind.visual)), scale=list(thing.scale))
    elif scene.can_render():
        _add_plain_visual(builder, kind, thing)
    builder.initial_pose = sapien.Pose(list(thing.position), list(thing.rotation))
    name = f"{env}/{thing.name}"
    if isinstance(thing, Fixture):
        fixture = builder.build_static(name=name)
        if thing.position[2] + extent_of(thing)[2] < FLAT:
            for bit in GLIDE_BITS:
                fixture.set_collision_group_bit(group=2, bit_idx=bit, bit=1)
        return fixture
    actor = builder.build(name=name)
    _set_inertia(actor, mass_of(thing), extent_of(thing))
    return actor


def _add_plain_visual(builder: Any, kind: Asset, thing: Body | Fixture) -> None:
    """What a shape without a file looks like: its boxes in the colour of the thing's category."""
    material = sapien.render.RenderMaterial(base_color=[*colour(thing.category), 1.0], roughness=0.7, specular=0.3)
    for box in kind.boxes:
        centre, half = np.array(box[:3]) * thing.scale, np.array(box[3:]) * thing.scale
        builder.add_box_visual(sapien.Pose(centre), half_size=half, material=material)


def build_bags(scene: Any, count: int) -> list[Actor]:
    """The bag that each agent carries: a picture only, without weight or collision, and no part of the simulation's state."""
    bags = []
    for env in range(count if scene.can_render() else 0):
        builder = scene.create_actor_builder()
        builder.set_scene_idxs([env])
        builder.add_visual_from_file(str(asset_path(asset(BAG).visual)), scale=[BAG_SCALE] * 3)
        builder.initial_pose = sapien.Pose([0.0, 0.0, -5.0])
        bag = builder.build_kinematic(name=f"{env}/rescue_bag")
        scene.remove_from_state_dict_registry(bag)
        bags.append(bag)
    return bags


def add_collision(builder: Any, kind: Asset, scale: tuple[float, float, float], friction: float | None = None) -> None:
    """The asset's convex hulls or hand-made boxes; `friction` [-]: None for the usual one."""
    rough = _friction(friction)
    for cx, cy, cz, hx, hy, hz in kind.boxes:
        centre = [c * s for c, s in zip((cx, cy, cz), scale, strict=True)]
        half = [h * s for h, s in zip((hx, hy, hz), scale, strict=True)]
        builder.add_box_collision(sapien.Pose(centre), half_size=half, material=rough)
    if kind.hulls:
        builder.add_multiple_convex_collisions_from_file(str(asset_path(kind.hulls)), scale=list(scale), material=rough)


def connect(scene: Any, specs: tuple[SceneSpec, ...], rows: list[list[Actor]], device: torch.device) -> CpuHandles | GpuHandles:
    """Handles of the moving bodies, after the simulator has been set up."""
    entities = [[actor._objs[0] for actor in row[: len(spec.bodies)]] for row, spec in zip(rows, specs, strict=True)]
    if scene.gpu_sim_enabled:
        return GpuHandles(scene.px, entities, scene.scene_offsets, device)
    return CpuHandles(entities[0])


def _set_inertia(actor: Actor, mass: float, extent: tuple[float, float, float]) -> None:
    """Mass and inertia of a homogeneous box, centred: they come from the scene, not from the hulls' volumes."""
    x, y, z = extent
    for body in actor._bodies:
        body.set_mass(mass)
        body.set_cmass_local_pose(sapien.Pose([0.0, 0.0, z / 2]))
        body.set_max_depenetration_velocity(PARTING)
        body.set_inertia([mass / 12 * (y * y + z * z), mass / 12 * (x * x + z * z), mass / 12 * (x * x + y * y)])


def _merge_bodies(scene: Any, specs: tuple[SceneSpec, ...], rows: list[list[Actor]]) -> None:
    """One batched actor per place along B, so that ManiSkill's state holds [E, 13] for each; needs scenes of equal size."""
    counts = {len(s.bodies) for s in specs}
    if len(counts) != 1:
        raise ValueError(f"scenes of one batch have {sorted(counts)} movable things; one number for all is allowed")
    for b in range(counts.pop()):
        for row in rows:
            scene.remove_from_state_dict_registry(row[b])
        scene.add_to_state_dict_registry(Actor.merge([row[b] for row in rows], name=f"body_{b}"))


def _friction(friction: float | None = None) -> sapien.physx.PhysxMaterial:
    number = FRICTION if friction is None else friction
    return sapien.physx.PhysxMaterial(number, number, 0.0)


def pose_of(position: tuple[float, float, float], heading: float) -> Pose:
    """A pose on the floor, turned about z by `heading` [rad]."""
    return Pose.create_from_pq([*position], [np.cos(heading / 2), 0.0, 0.0, np.sin(heading / 2)])


def lamp_places(room: Room) -> list[tuple[float, float]]:
    """Where lamps hang under the ceiling: in the middles of the parts of a room [m]."""
    (x, y), walls = room.size, room.partitions
    across = [sorted([0.0, length, *(p.at for p in walls if p.axis == axis)]) for axis, length in (("y", x), ("x", y))]
    xs, ys = ([(low + high) / 2 for low, high in itertools.pairwise(ends)] for ends in across)
    return [(a, b) for a in xs for b in ys]


def corner_view(spec: SceneSpec) -> sapien.Pose:
    """Camera pose in an upper corner, or over a side in the open: far from the agent's start, looking at the middle past what is tall."""
    (x, y), z = spec.room.size, EYES_OUTDOORS if spec.room.open_air else spec.room.height
    start = np.array(spec.agent_start.position)
    sides = [(0.15, size / 2, size - 0.15) if spec.room.open_air else (0.15, size - 0.15) for size in (x, y)]
    eyes = [np.array([a, b, z - 0.15]) for a in sides[0] for b in sides[1] if (a, b) != (x / 2, y / 2)]
    target = np.array([x / 2, y / 2, 0.1]) * 0.8 + np.array([*start, 0.1]) * 0.2
    tall = [box for f in spec.fixtures if (box := box_of(f, asset(f.asset).extent)).high > TALL]
    eye = max(eyes, key=lambda e: np.linalg.norm(e[:2] - start) - HIDING * _hidden(e, target, tall))
    return look_at(eye, target).sp


def _hidden(eye: np.ndarray, target: np.ndarray, boxes: list[Box]) -> float:
    """How much of the way from `eye` to `target` lies in or close behind `boxes`, in boxes; what is near to the eye hides most."""
    share = np.linspace(0.0, 0.8, 30)[:, None]
    points = eye + share * (target - eye)
    inside = [(b.distance(points[:, 0], points[:, 1]) < BESIDE) & (points[:, 2] < b.high + BESIDE) for b in boxes]
    return float(sum((i * (1.0 - share[:, 0])).max(initial=0.0) for i in inside))
