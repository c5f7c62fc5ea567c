"""A saved state brings back all that follows from it, in its own environments alone; without a simulator."""

from __future__ import annotations

from typing import Any

import pytest
import torch

from hazard_ms.tasks.episode import snapshot
from hazard_ms.tasks.episode.episode import Episode
from hazard_ms.tasks.episode.safe_places import BAG, CART
from tests.worlds.fire_worlds import room_world

THINGS = [("book", (2.0, 2.0, 0.0)), ("apple", (3.0, 2.0, 0.0)), ("pan", (1.0, 1.0, 0.0))]
SEED = 123_456_789  # needs more than one of the words in which seeds are kept
ONE, BOTH = torch.tensor([0]), torch.tensor([0, 1])


def played(place: Any = BAG) -> Episode:
    """Two environments; in the first the book is rescued and the apple in the hand."""
    world = room_world(THINGS, copies=2)
    episode = Episode(world, (), place)
    episode.begin(BOTH, torch.tensor([SEED, 5]))
    world.chance.frame[:] = torch.tensor([40, 7])
    episode.rescue.mark(world, torch.tensor([[True, False, False], [False, False, False]]), episode.damage)
    world.away |= episode.rescue.safe & place.carried
    episode.hand.held[0] = 1
    world.held[0, 1] = True
    return episode


def seen(episode: Episode) -> dict[str, list[Any]]:
    world = episode.world
    of_world = {name: getattr(world, name)[0].tolist() for name in ("safe", "away", "held")}
    return {**of_world, "seed": world.chance.seed[0].tolist(), "frame": world.chance.frame[0].tolist()}


@pytest.mark.parametrize("place", [BAG, CART], ids=lambda place: place.name)
def test_what_was_safe_held_and_drawn_is_so_again(place: Any) -> None:
    episode = played(place)
    before, saved = seen(episode), snapshot.save(episode)
    assert before["seed"] == SEED and before["away"] == [place is BAG, False, False]
    episode.begin(BOTH, torch.tensor([9, 9]))
    assert seen(episode) != before
    snapshot.restore(episode, saved, BOTH)
    assert seen(episode) == before


def test_other_environments_stay_as_they_are() -> None:
    episode = played()
    saved = {name: {key: value[:1] for key, value in part.items()} for name, part in snapshot.save(episode).items()}
    episode.begin(BOTH, torch.tensor([9, 11]))
    episode.world.chance.frame[1] = 3
    snapshot.restore(episode, saved, ONE)
    assert episode.world.chance.seed.tolist() == [SEED, 11] and episode.world.chance.frame.tolist() == [40, 3]
    assert episode.world.safe.tolist() == [[True, False, False], [False, False, False]]
