"""Pictures of decisions are those that the agent could see, and only as far as the replay is the same episode."""

from __future__ import annotations

import base64
import dataclasses
import io
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.evaluation.runner import play
from hazard_ms.evaluation.watchers import Watcher
from hazard_ms.pictures.decision_pictures import EDGE, MAP_WIDTH, DecisionPictures, decision_pictures
from hazard_ms.skills.decision import Action, Decision, Images
from hazard_ms.tasks import task_of
from tests.worlds.playground import Playground


class Seen(Watcher):
    """Keeps what the agent saw at each decision."""

    def __init__(self) -> None:
        self.pictures: dict[int, NDArray[np.uint8]] = {}

    def decided(self, decision: Decision, action: Action, note: str) -> None:
        assert decision.images is not None
        self.pictures[decision.frame] = decision.images.rgb


def opened(url: str) -> Image.Image:
    kind, _, data = url.partition(",")
    assert kind == "data:image/jpeg;base64" and len(data) < 60_000
    return Image.open(io.BytesIO(base64.b64decode(data)))


def test_pictures_are_kept_of_the_decisions_that_are_asked_for() -> None:
    """Two edges of a picture twice as large as those kept, and a map that grows with what was seen."""
    watcher, ground = DecisionPictures({0, 60}), Playground({"mug": (2.0, 0.0)}, {"mug": 1.0})
    env: Any = SimpleNamespace(base=SimpleNamespace(task=task_of("HazardFire-v1", "paper")))
    rgb = np.full((2 * EDGE, 2 * EDGE, 3), (200, 100, 50), np.uint8)
    images = Images(rgb, np.ones((1, 1), np.float32), None, np.zeros((1, 16, 16), np.float32))
    watcher.begin(env, ground.decision())
    for action in (Action("explore"), Action("walk_to", "mug"), Action("pick_up", "mug")):
        watcher.decided(dataclasses.replace(ground.decision(), images=images), action, "")
        ground.do(action)
    assert list(watcher.views) == [0, 60]
    heads, plans = zip(*(map(opened, views) for views in watcher.views.values()), strict=True)
    assert {head.size for head in heads} == {(EDGE, EDGE)} and {plan.size for plan in plans} == {(MAP_WIDTH, EDGE)}
    assert np.abs(np.asarray(heads[0], float) - (200, 100, 50)).max() < 8.0  # [of 255] a JPEG's loss
    assert np.asarray(plans[0]).tolist() != np.asarray(plans[1]).tolist()


@pytest.mark.render
@pytest.mark.long
def test_pictures_are_what_was_seen_as_long_as_the_replay_is_the_same() -> None:
    seen = Seen()
    record = play(EpisodeOptions(agent="tests/examples/stopping.py:Stopping", seed=1), [seen])
    first, last = seen.pictures
    made = decision_pictures(record, {first, last, 7})
    assert list(made) == [first, last], "there is no decision at frame 7"
    for frame, (head, plan) in made.items():
        picture = opened(head)
        wanted = Image.fromarray(seen.pictures[frame])
        wanted.thumbnail((EDGE, EDGE))
        assert np.abs(np.asarray(picture, float) - np.asarray(wanted, float)).mean() < 4.0  # [of 255] a JPEG's loss
        assert opened(plan).size == (MAP_WIDTH, EDGE)
    assert np.asarray(opened(made[first][1])).tolist() != np.asarray(opened(made[last][1])).tolist()
    other = [link if link.frame == first else dataclasses.replace(link, sha256="other") for link in record.links]
    assert list(decision_pictures(dataclasses.replace(record, links=tuple(other)), {first, last})) == [first]
