"""Futures in which something is done about the hazard: each copy is what an episode is in which it really is done."""

from __future__ import annotations

import dataclasses
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import torch

from hazard_ms.hazards.fire.dousing import NEVER
from hazard_ms.hazards.fire.fire_state import BURNING, FireState, lit
from hazard_ms.simulation.building import make_world
from hazard_ms.sketch.futures import seats
from hazard_ms.sketch.futures.interventions import OUT, SHUT, Foreseen, Intervention, fire_of, foresee
from hazard_ms.spec import AgentStart, Body, Opening, Partition, Room, SceneSpec, Task
from hazard_ms.tasks.episode.episode import Episode
from hazard_ms.tasks.fire import hazard_fire
from hazard_ms.tasks.flood import hazard_flood

FRAMES = 900


def thing(name: str, x: float, y: float) -> Body:
    return Body(name, "box", "plain_box", (x, y, 0.0), scale=(0.15, 0.15, 0.15), mass=0.4)


# Two seats of fire, each beside a box, 4 m apart; a wall with an open door is between them
ROOM = SceneSpec(
    name="test/seats",
    room=Room(
        (6.0, 4.0),
        openings=(Opening("door", "middle", 2.0, 0.9, 2.0, open=1.0),),
        partitions=(Partition("middle", "y", 3.0),),
    ),
    fixtures=(),
    bodies=(thing("left", 1.3, 2.0), thing("right", 5.3, 2.0)),
    target_categories=("box",),
    fires=((1.0, 2.0), (5.0, 2.0)),
    agent_start=AgentStart((2.0, 0.5)),
)


def running(task: Task, spec: SceneSpec, frames: int = 0) -> Any:
    """An episode without a simulator, as recordings take it, after some frames."""
    world = make_world((spec,), torch.device("cpu"))
    episode = Episode(world, task.hazards, task.safe_place)
    episode.begin(torch.tensor([0]), torch.tensor([3]))
    episode.begin_hazards(torch.tensor([0]))
    for _ in range(frames):
        episode.advance(1.0 / 30.0)
    return SimpleNamespace(world=world, episode=episode, task=task, physics="paper", specs=(spec,))


@pytest.fixture(scope="module")
def fire() -> Task:
    return dataclasses.replace(hazard_fire("paper"), max_frames=FRAMES)


def test_each_copy_is_an_episode_in_which_the_thing_is_done(fire: Task) -> None:
    """The seat on the left put out at 100: the left box stays whole, the right one burns as it does anyway."""
    env = running(fire, ROOM, 40)
    told = foresee(env, [[Intervention(OUT, 0, 100)], [Intervention(OUT, 1, 100)], [Intervention(OUT, 0, FRAMES + 1)]])
    left, right = (env.world.index(0, name) for name in ("left", "right"))
    alone = running(fire, ROOM, FRAMES).episode.damage.frame[0].numpy()
    assert (told.damaged_at[[0, 3]] == alone).all() and min(alone[left], alone[right]) > 100
    assert told.damaged_at[1, left] == -1 and told.damaged_at[2, right] == -1
    for row, seat in ((1, 0), (2, 1)):
        one = running(fire, ROOM, 100)
        seats.put_out(fire_of(one.episode), one.world, 0, seat)  # type: ignore[arg-type]
        for _ in range(FRAMES - 100):
            one.episode.advance(1.0 / 30.0)
        assert (told.damaged_at[row] == one.episode.damage.frame[0].numpy()).all()
    assert np.isinf(told.whole_until()[1, left]) and told.whole_until()[0, right] == alone[right] - 1
    assert told.first == 40 and told.burning.tolist() == [0, 1, 1, 0]
    assert int(env.world.frame[0]) == 40 and bool(lit(fire_of(env.episode), env.world.frame).any())  # type: ignore[arg-type]


def test_both_seats_can_be_put_out_in_one_future(fire: Task) -> None:
    env = running(fire, ROOM)
    told = foresee(env, [[Intervention(OUT, 0, 100), Intervention(OUT, 1, 150)]])
    assert (told.damaged_at[1] == -1).all() and told.burning.tolist() == [0, 2]


def test_what_burns_belongs_to_the_seat_with_the_nearest_flame(fire: Task) -> None:
    env = running(fire, ROOM, FRAMES)
    state = fire_of(env.episode)
    assert isinstance(state, FireState)
    left, right = (env.world.index(0, name) for name in ("left", "right"))
    assert state.status[0, [left, right]].tolist() == [BURNING, BURNING]
    assert seats.things(state, env.world)[0, [left, right]].tolist() == [0, 1]
    seat = seats.flames(state, env.world.frame)[0]
    burns = lit(state, env.world.frame)[0]
    assert (seat[burns] == (state.flame_place[0, burns, 0] > 3.0).long()).all() and (seat[~burns] == -1).all()
    seats.put_out(state, env.world, 0, 0)
    assert state.status[0, left] != BURNING and state.status[0, right] == BURNING
    assert float(state.temperature[0, left]) <= 100.0
    assert (state.flame_birth[0, burns & (seat == 0)] == NEVER).all() and int(lit(state, env.world.frame).sum()) > 0


def test_water_stays_out_of_a_room_whose_door_is_shut() -> None:
    """The water comes from the west; with the door shut at once the level behind it never rises."""
    calm = dataclasses.replace(hazard_flood("paper"), max_frames=600)
    hazards = tuple(dataclasses.replace(h, gain=0.0) for h in calm.hazards)
    spec = dataclasses.replace(ROOM, fires=(), flood_side="west")
    env = running(dataclasses.replace(calm, hazards=hazards), spec)
    told = foresee(env, [[Intervention(SHUT, 0, 0)]])
    left, right = (env.world.index(0, name) for name in ("left", "right"))
    assert told.levels[-1, 0, right] > 0.1 and told.levels[-1, 1, right] <= 0.0
    assert told.levels[-1, 1, left] == pytest.approx(told.levels[-1, 0, left])


def test_things_are_carried_off_once_the_water_is_as_high_as_it_would_be_then() -> None:
    """Levels rise by 0.1 in 10 frames, in the second future half as fast, in the third not at all."""
    frames = np.arange(0, 110, 10)
    rise = np.linspace(0.0, 1.0, 11, dtype=np.float32)[:, None]
    levels = np.stack([rise, rise / 2, 0 * rise], axis=1)
    told = Foreseen(0, np.full((3, 1), -1), np.zeros(3, np.int64), frames, levels)
    assert told.stays_until(np.array([40.0]))[:, 0].tolist() == [40.0, 80.0, np.inf]
    assert told.stays_until(np.array([np.inf]))[:, 0].tolist() == [np.inf] * 3


def test_an_unknown_kind_is_refused(fire: Task) -> None:
    with pytest.raises(ValueError, match="kind must be one of out, shut, open, block, got 'burn'"):
        foresee(running(fire, ROOM), [[Intervention("burn", 0, 1)]])
