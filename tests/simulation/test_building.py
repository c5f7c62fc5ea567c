"""What is built of a scene: weight, balance and friction of its bodies, and what holds on to what."""

from __future__ import annotations

import functools
import itertools

import pytest
import torch
from sapien.physx import PhysxRigidDynamicComponent

from hazard_ms.scenes.assets.index import asset, asset_ids
from hazard_ms.simulation.bare_scene import PHYSICS_RATE, Standalone, build
from hazard_ms.spec.scene import AgentStart, Body, Room, SceneSpec

BOX = asset_ids(category="box")[0]
HEIGHT = asset(BOX).extent[2]  # [m]
SECOND = PHYSICS_RATE  # [steps]


def scene_of(*bodies: Body) -> SceneSpec:
    return SceneSpec("room/00", Room((4.0, 4.0)), (), bodies, ("box",), (), AgentStart((0.5, 0.5)))


def body_of(built: Standalone, number: int) -> PhysxRigidDynamicComponent:
    return built.world.handles.bodies[number]  # type: ignore[union-attr]


def steps(built: Standalone, count: int) -> None:
    for _ in range(count):
        built.step()
    built.world.read()


def hold(built: Standalone, held: list[bool], x: float) -> None:
    """Keep bodies at `x` [m], as a hand does."""
    base = built.world.base_of(built.world.position, built.world.rotation, built.world.extent)
    base[..., 0] = x
    built.world.freeze(torch.tensor([held]), base, built.world.rotation)


@functools.cache
def plain() -> Standalone:
    return build(scene_of(Body("box_1", "box", BOX, (2.0, 2.0, 0.001))))


def test_twice_as_large_is_eight_times_as_heavy_unless_the_scene_says() -> None:
    large = Body("box_1", "box", BOX, (1.0, 1.0, 0.001), scale=(2.0, 2.0, 2.0))
    given = Body("box_2", "box", BOX, (3.0, 3.0, 0.001), scale=(2.0, 2.0, 2.0), mass=0.7)
    built = build(scene_of(large, given))
    assert body_of(built, 0).mass == pytest.approx(8.0 * asset(BOX).mass)
    assert body_of(built, 1).mass == pytest.approx(0.7)
    assert built.world.mass[0].tolist() == pytest.approx([8.0 * asset(BOX).mass, 0.7])


def test_a_body_is_balanced_about_its_middle() -> None:
    body = body_of(plain(), 0)
    assert body.cmass_local_pose.p.tolist() == pytest.approx([0.0, 0.0, HEIGHT / 2])
    x, y, _ = asset(BOX).extent
    assert body.inertia[2] == pytest.approx(body.mass / 12 * (x**2 + y**2), rel=1e-4)  # of a homogeneous box


def test_friction_is_the_scene_s_own() -> None:
    smooth = Body("box_1", "box", BOX, (1.0, 1.0, 0.001), friction=0.05)
    built = build(scene_of(smooth, Body("box_2", "box", BOX, (3.0, 3.0, 0.001))))
    shapes = [body_of(built, number).collision_shapes[0] for number in (0, 1)]
    assert [s.physical_material.dynamic_friction for s in shapes] == pytest.approx([0.05, 0.5])


def test_what_stood_on_a_thing_that_is_taken_away_falls() -> None:
    below = Body("box_1", "box", BOX, (2.0, 2.0, 0.0))
    built = build(scene_of(below, Body("box_2", "box", BOX, (2.0, 2.0, HEIGHT + 0.001))))
    steps(built, 4 * SECOND)
    assert body_of(built, 1).is_sleeping  # a sleeping body has to be woken
    hold(built, [True, False], x=0.5)
    steps(built, SECOND)
    assert float(built.world.position[0, 1, 2]) == pytest.approx(HEIGHT / 2, abs=0.02)


def test_what_is_in_a_hand_hits_nothing() -> None:
    built = build(scene_of(*(Body(f"box_{x}", "box", BOX, (float(x), 2.0, 0.001)) for x in (1, 3))))
    steps(built, SECOND)
    start = float(built.world.position[0, 1, 0])
    for x in itertools.accumulate([0.02] * 100, initial=1.0):  # through the other and beyond
        hold(built, [True, False], x)
        body_of(built, 1).wake_up()  # what sleeps does not feel what is put beside it
        built.step()
    steps(built, SECOND)
    assert float(built.world.position[0, 1, 0]) == pytest.approx(start, abs=0.001)
