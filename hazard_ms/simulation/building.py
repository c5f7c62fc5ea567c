"""Builds the SAPIEN actors of a SceneSpec: the room's shell, its furniture, and movable bodies with their true masses.

Scenes are built once per reconfiguration.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import sapien
import torch
from mani_skill.utils.structs import Actor
from mani_skill.utils.structs.pose import Pose
from sapien.physx import PhysxRigidDynamicComponent as Dynamic

from hazard_ms.scenes.assets.index import asset, asset_path
from hazard_ms.scenes.assets.primitives import colour
from hazard_ms.scenes.assets.rows import Asset
from hazard_ms.scenes.shell import shell
from hazard_ms.scenes.solids import extent_of, mass_of
from hazard_ms.simulation.drawing.textured_box import surface_material, textured_box
from hazard_ms.simulation.physx import CpuHandles, GpuHandles
from hazard_ms.simulation.world import World
from hazard_ms.spec import Body, Fixture, Room, SceneSpec
from hazard_ms.spec.names import actor_name

# [-] Coulomb, static and dynamic: wood on wood 0.25-0.5, most household pairs 0.3-0.6 (Engineering ToolBox) [ours]
FRICTION = 0.5
PARTING = 0.5  # highest speed at which things that overlap at the start are driven apart [m/s] [ours]
GLIDE_HEIGHT = 0.03  # a robot's base glides over fixtures lower than this, such as rugs [m] [ours]
SLAB = 1.0  # thickness of the walls that enclose a room: a robot that leans on a thing cannot squeeze it through [m]
BAG_MODEL, BAG_SCALE = "basket_2", 0.8  # the asset that shows the bag, and the factor by which it is scaled
# bits of collision group 2 that ManiSkill gives to what Fetch's wheels and base glide over, for each robot of a team
# (`hazard_ms.robots.team`)
GLIDE_BITS = (30, 31, 27, 28, 24, 25, 21, 22)


def extent_of_bag() -> tuple[float, float, float]:
    """Edge lengths of the bag that the agent carries [m]."""
    x, y, z = (size * BAG_SCALE for size in asset(BAG_MODEL).extent)
    return x, y, z


def make_world(specs: tuple[SceneSpec, ...], device: torch.device, loose: Sequence[frozenset[str]] = ()) -> World:
    """The world of `specs`, not yet connected to a simulator; `loose`: furniture of each that can be set free."""
    things = [s.things for s in specs]
    world = World.of(
        specs, [[extent_of(t) for t in row] for row in things], [[mass_of(t) for t in row] for row in things], device
    )
    for e, names in enumerate(loose):
        world.floats[e, [world.index(e, name) for name in sorted(names)]] = True
    return world


def build_scenes(scene: Any, specs: tuple[SceneSpec, ...], loose: Sequence[frozenset[str]] = ()) -> list[list[Actor]]:
    """Build every scene of `specs` into the sub-scene of the same number; `loose`: furniture that can be set free.

    Returns for each scene the actors of its bodies, then those of its fixtures. Raises ValueError for scenes of one
    batch with different numbers of bodies.
    """
    rows: list[list[Actor]] = []
    for e, spec in enumerate(specs):
        build_shell(scene, spec, e)
        names = loose[e] if loose else frozenset()
        rows.append([build_thing(scene, t, e, t.name in names) for t in spec.things])
    if len(specs) > 1:
        _merge_bodies(scene, specs, rows)
    return rows


def build_shell(scene: Any, spec: SceneSpec, env: int) -> None:
    """Build floor, walls, doors and windows, or the ground.

    What is seen is thin and has no collision; thick slabs that are not seen keep everything inside.
    """
    for i, box in enumerate(shell(spec.room) if scene.can_render() else ()):
        builder = scene.create_actor_builder()
        builder.set_scene_idxs([env])
        builder._procedural_shapes.append(textured_box(box.size, surface_material(box.material)))
        builder.initial_pose = sapien.Pose(list(box.centre))
        builder.build_static(name=actor_name(env, f"shell_{i}_{box.name}"))
    builder = scene.create_actor_builder()
    builder.set_scene_idxs([env])
    for slab in (*_enclosure(spec), *partitions(spec)):
        builder.add_box_collision(sapien.Pose(slab[0]), half_size=slab[1], material=_friction())
    builder.initial_pose = sapien.Pose()
    builder.build_static(name=actor_name(env, "enclosure"))


def _enclosure(spec: SceneSpec) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Middles and half sizes [m] of six thick slabs around the room, or in the open around all that can be reached."""
    low = np.array([-spec.room.beyond, -spec.room.beyond, 0.0])
    high = np.array([*spec.room.size, spec.room.height]) - low
    for axis in range(3):
        half = (high - low) / 2 + SLAB
        half[axis] = SLAB / 2
        for place in (low[axis] - SLAB / 2, high[axis] + SLAB / 2):
            centre = (low + high) / 2
            centre[axis] = place
            yield centre, half


def partitions(spec: SceneSpec) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """The middle and the half size of each piece of the walls inside a room [m], [3] each."""
    names = tuple(f"wall_{p.name}_" for p in spec.room.partitions)
    for box in shell(spec.room) if names else ():
        if box.name.startswith(names):
            yield np.array(box.centre), np.array(box.size) / 2


def wall_pieces(room: Room) -> Iterator[tuple[str, np.ndarray, np.ndarray]]:
    """The wall, the middle and the size of each piece of the walls that are seen [m], [3] each."""
    for box in shell(room):
        if box.kind == "wall":
            yield box.name.rpartition("_")[0], np.array(box.centre), np.array(box.size)


def build_thing(scene: Any, thing: Body | Fixture, env: int, loose: bool = False) -> Actor:
    """Build one body or fixture at its place in the scene; one that is `loose` stands until it is set free."""
    builder = scene.create_actor_builder()
    builder.set_scene_idxs([env])
    kind = asset(thing.asset)
    add_collision(builder, kind, thing.scale, thing.friction if isinstance(thing, Body) else None)
    if kind.visual:
        builder.add_visual_from_file(str(asset_path(kind.visual)), scale=list(thing.scale))
    elif scene.can_render():
        _add_plain_visual(builder, kind, thing)
    builder.initial_pose = sapien.Pose(list(thing.position), list(thing.rotation))
    name = actor_name(env, thing.name)
    if isinstance(thing, Fixture) and not loose:
        fixture = builder.build_static(name=name)
        if thing.position[2] + extent_of(thing)[2] < GLIDE_HEIGHT:
            for bit in GLIDE_BITS:
                fixture.set_collision_group_bit(group=2, bit_idx=bit, bit=1)
        return fixture
    actor = builder.build(name=name)
    _set_inertia(actor, mass_of(thing), extent_of(thing))
    if loose:
        for body in actor._bodies:
            body.kinematic = True
    return actor


def _add_plain_visual(builder: Any, kind: Asset, thing: Body | Fixture) -> None:
    """Draw a shape that has no visual file as its boxes, in the colour of the thing's category."""
    material = sapien.render.RenderMaterial(base_color=[*colour(thing.category), 1.0], roughness=0.7, specular=0.3)
    for box in kind.boxes:
        centre, half = np.array(box[:3]) * thing.scale, np.array(box[3:]) * thing.scale
        builder.add_box_visual(sapien.Pose(centre), half_size=half, material=material)


def build_bags(scene: Any, count: int, number: int = 0) -> list[Actor]:
    """Build the bag of the agent `number`, from 0, of each of `count` environments.

    It is for pictures only: it has no mass and is not in recorded states.
    """
    bags = []
    for env in range(count if scene.can_render() else 0):
        builder = scene.create_actor_builder()
        builder.set_scene_idxs([env])
        builder.add_visual_from_file(str(asset_path(asset(BAG_MODEL).visual)), scale=[BAG_SCALE] * 3)
        builder.initial_pose = sapien.Pose([0.0, 0.0, -5.0])
        bag = builder.build_kinematic(name=actor_name(env, f"rescue_bag{number or ''}"))
        scene.remove_from_state_dict_registry(bag)
        bags.append(bag)
    return bags


def add_collision(builder: Any, kind: Asset, scale: tuple[float, float, float], friction: float | None = None) -> None:
    """Add the asset's convex hulls or boxes as collision shapes, with `friction` [-], by default FRICTION."""
    rough = _friction(friction)
    for cx, cy, cz, hx, hy, hz in kind.boxes:
        centre = [c * s for c, s in zip((cx, cy, cz), scale, strict=True)]
        half = [h * s for h, s in zip((hx, hy, hz), scale, strict=True)]
        builder.add_box_collision(sapien.Pose(centre), half_size=half, material=rough)
    if kind.hulls:
        builder.add_multiple_convex_collisions_from_file(str(asset_path(kind.hulls)), scale=list(scale), material=rough)


def connect(
    scene: Any, specs: tuple[SceneSpec, ...], rows: list[list[Actor]], device: torch.device
) -> CpuHandles | GpuHandles:
    """Handles of the moving bodies of `rows`; the simulator must have been set up."""
    entities = [[actor._objs[0] for actor in row[: len(spec.bodies)]] for row, spec in zip(rows, specs, strict=True)]
    if scene.gpu_sim_enabled:
        return GpuHandles(scene.px, entities, scene.scene_offsets, device)
    still = [a._objs[0] for a in rows[0][len(specs[0].bodies) :]]
    moving = {b: e for b, e in enumerate(still, len(specs[0].bodies)) if e.find_component_by_type(Dynamic)}
    return CpuHandles(entities[0], moving)


def _set_inertia(actor: Actor, mass: float, extent: tuple[float, float, float]) -> None:
    """Give the actor the mass [kg] and inertia of a homogeneous box of `extent` [m], whatever its hulls are like."""
    x, y, z = extent
    for body in actor._bodies:
        body.set_mass(mass)
        body.set_cmass_local_pose(sapien.Pose([0.0, 0.0, z / 2]))
        body.set_max_depenetration_velocity(PARTING)
        body.set_inertia([mass / 12 * (y * y + z * z), mass / 12 * (x * x + z * z), mass / 12 * (x * x + y * y)])


def _merge_bodies(scene: Any, specs: tuple[SceneSpec, ...], rows: list[list[Actor]]) -> None:
    """Merge the bodies of all scenes into one batched actor per index along B, [E, 13] each in ManiSkill's state.

    Raises ValueError for scenes with different numbers of bodies.
    """
    counts = {len(s.bodies) for s in specs}
    if len(counts) != 1:
        raise ValueError(f"scenes of one batch must have the same number of movable things, got {sorted(counts)}")
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
    """Places x, y [m] of the lamps under the ceiling: the middle of each part of the room."""
    (x, y), walls = room.size, room.partitions
    across = [sorted([0.0, length, *(p.at for p in walls if p.axis == axis)]) for axis, length in (("y", x), ("x", y))]
    xs, ys = ([(low + high) / 2 for low, high in itertools.pairwise(ends)] for ends in across)
    return [(a, b) for a in xs for b in ys]
