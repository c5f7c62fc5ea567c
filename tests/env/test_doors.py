"""Doors between rooms in the simulator: what is open of them is free for bodies, and states with them are restored."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import gymnasium as gym
import pytest
import sapien
import torch

import hazard_ms  # noqa: F401 registers the environments
from hazard_ms.scenes import floor
from hazard_ms.scenes.schema import to_json
from hazard_ms.scenes.splits import scene
from hazard_ms.simulation.mitigation import hinges

FLAT = scene("flat_a/00")
HOLES = tuple(dataclasses.replace(o, kind="door") if o.kind == "doorway" else o for o in FLAT.room.openings)
NUMBER = next(k for k, o in enumerate(HOLES) if o.wall == FLAT.room.partitions[0].name)
ROOM = dataclasses.replace(FLAT.room, openings=HOLES)
ONE = torch.arange(1)


@pytest.fixture(scope="module")
def env(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    """A flat whose doorway has a door."""
    path: Path = tmp_path_factory.mktemp("scenes") / "doors.json"
    path.write_text(to_json(dataclasses.replace(FLAT, name="test/doors", room=ROOM)))
    made = gym.make("HazardFire-v1", obs_mode="state", render_backend="none", scenes=str(path))
    made.reset(seed=0)
    yield made.unwrapped
    made.close()


def thrown(env: Any, share: float) -> float:
    """How far behind the wall a thing is that flew at the middle of the door at 4 m/s, after 0.3 s [m]."""
    env.world.openings.set_open(ONE, NUMBER, share)
    env.leaves.move()
    wall, opening, body = FLAT.room.partitions[0], HOLES[NUMBER], env.actors[0][0]
    body.set_pose(sapien.Pose([wall.at - 0.4, opening.centre, 1.0]))
    body.set_linear_velocity([4.0, 0.0, 0.0])
    for _ in range(round(0.3 * env.sim_freq)):
        env.scene.px.step()
    return float(body.pose.p[0, 0]) - wall.at


def test_a_closed_door_stops_bodies_and_an_open_or_broken_one_does_not(env: Any) -> None:
    assert thrown(env, 0.0) < 0.0 < 0.3 < thrown(env, 1.0)
    env.world.openings.state.broken[0, NUMBER] = True
    assert thrown(env, 0.0) > 0.3
    env.world.openings.state.broken[0, NUMBER] = False


def test_a_leaf_hangs_at_the_lower_end_and_turns_as_far_as_its_door_is_open(env: Any) -> None:
    """A leaf that is open by 1 - cos 60 degrees stands at 60 degrees, to the west; its handle moves with it."""
    wall, opening = FLAT.room.partitions[0], HOLES[NUMBER]
    assert wall.axis == "y"
    low, half = opening.centre - opening.width / 2, opening.width / 2
    for share, degrees in ((0.0, 0.0), (0.5, 60.0), (1.0, 90.0)):
        env.world.openings.set_open(ONE, NUMBER, share)
        env.leaves.move()
        turn = math.radians(degrees)
        place = [wall.at - half * math.sin(turn), low + half * math.cos(turn), opening.height / 2]
        places, turns = env.leaves.poses()
        assert places[0].tolist() == pytest.approx(place, abs=1e-5)
        assert turns[0].tolist() == pytest.approx([math.cos(turn / 2), 0.0, 0.0, math.sin(turn / 2)], abs=1e-5)
    far = opening.width - 0.07
    handle = hinges.handle(ROOM, opening, math.pi / 2)
    assert handle.tolist() == pytest.approx([wall.at - far, low, 1.0], abs=1e-6)
    (shape,) = [s for s in leaf_shapes(env) if min(s.half_size) < 0.02 and max(s.half_size) < 0.1]
    assert shape.local_pose.p.tolist() == pytest.approx([0.0, half - 0.07, 1.0 - opening.height / 2], abs=1e-5)


def leaf_shapes(env: Any) -> list[Any]:
    """Collision shapes of the leaf of the door."""
    (leaf,) = [e for e in env.scene.sub_scenes[0].entities if e.name.endswith(f"leaf_{NUMBER}")]
    return list(leaf.find_component_by_type(sapien.physx.PhysxRigidDynamicComponent).collision_shapes)


def test_states_hold_doors_and_put_them_back(env: Any) -> None:
    env.world.openings.set_open(ONE, NUMBER, 0.25)
    saved = env.get_state_dict()
    assert float(saved["hazard_ms"]["openings"]["open"][0, NUMBER]) == 0.25
    env.world.openings.set_open(ONE, NUMBER, 1.0)
    env.set_state_dict(saved)
    assert float(env.world.openings.share[0, NUMBER]) == 0.25
    flat = env.get_state()
    env.world.openings.set_open(ONE, NUMBER, 1.0)
    env.set_state(flat)
    assert float(env.world.openings.share[0, NUMBER]) == 0.25
    wrong = {**saved["hazard_ms"]["openings"], "open": saved["hazard_ms"]["openings"]["open"] + 1.0}
    with pytest.raises(ValueError, match=r"openings\.open must hold numbers from 0 to 1"):
        env.set_state_dict({**saved, "hazard_ms": {**saved["hazard_ms"], "openings": wrong}})


def test_the_floor_in_a_closed_door_is_not_free() -> None:
    opening, wall = HOLES[NUMBER], FLAT.room.partitions[0]
    cell = floor.cell_of((wall.at, opening.centre))
    for share, free in ((0.0, False), (0.2, False), (1.0, True)):
        holes = tuple(dataclasses.replace(o, open=share) if k == NUMBER else o for k, o in enumerate(HOLES))
        room = dataclasses.replace(ROOM, openings=holes)
        assert bool(floor.free_for(room, (), (), 0.2)[cell]) is free
