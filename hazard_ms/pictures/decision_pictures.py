"""Pictures of the decisions of a recorded episode: what the head camera showed, and a map of what had been seen.

Results hold no pictures, so the episode is played again. Where that goes differently from the record, as it may on
another kind of processor, there are no pictures from then on.
"""

from __future__ import annotations

import base64
from collections.abc import Collection

import numpy as np
from PIL import Image

from hazard_ms.evaluation.attempts import Recorded
from hazard_ms.evaluation.replay import job_of
from hazard_ms.evaluation.result import EpisodeResult
from hazard_ms.evaluation.runner import play
from hazard_ms.evaluation.watchers import Watcher
from hazard_ms.pictures.drawing import Pixels
from hazard_ms.pictures.files import encoded
from hazard_ms.pictures.panels import MapPanel
from hazard_ms.skills.decision import Action, Decision
from hazard_ms.skills.executor import SkillEnv

EDGE = 256  # of the head camera's picture at most, and height of the map [px]
MAP_WIDTH = 384  # [px]
MOST = 200  # decisions of which pictures are kept: some 20 kB each, 4 MB in all [ours]

Views = dict[int, tuple[str, str]]  # by frame: the head camera's picture and the map, as data URLs


def decision_pictures(record: EpisodeResult, frames: Collection[int], load: tuple[str, ...] = ()) -> Views:
    """The pictures of the decisions at `frames` of an episode, which is played again; of the first MOST at most.

    `load`: modules that the episode needs. Raises ValueError for an episode that cannot be played.
    """
    job = job_of(record, load)
    watcher = DecisionPictures(sorted(frames)[:MOST])
    played = play(job.options, [watcher], Recorded(job.actions or (), job.options.agent, job.waits))
    same = -1  # the last frame at which both are known to be the same
    for before, now in zip(record.links, played.links, strict=False):
        if before != now:
            break
        same = before.frame
    return {frame: views for frame, views in watcher.views.items() if frame <= same}


class DecisionPictures(Watcher):
    """Keeps the pictures of the decisions at some frames, in `views`."""

    colours = True

    def __init__(self, frames: Collection[int]) -> None:
        self._frames = frozenset(frames)
        self._path: list[tuple[float, float]] = []
        self.views: Views = {}

    def begin(self, env: SkillEnv, decision: Decision) -> None:
        """Make the map for the hazards of the episode."""
        self._map = MapPanel(MAP_WIDTH, EDGE, tuple(hazard.shown_level for hazard in env.base.task.hazards))

    def decided(self, decision: Decision, action: Action, note: str) -> None:
        """Take the pictures of a decision, as it was when the agent was asked."""
        self._path.append(decision.agent_position)
        picture = None if decision.images is None else decision.images.rgb
        if decision.frame in self._frames and picture is not None:
            agent = (*decision.agent_position, decision.agent_heading)
            plan = self._map.draw(decision.map, decision.targets, decision.names, agent, self._path, action.target)
            self.views.setdefault(decision.frame, (_url(_small(picture)), _url(plan)))


def _small(picture: Pixels) -> Pixels:
    """The picture, [H, W, 3], with edges of EDGE pixels at most."""
    image = Image.fromarray(picture)
    image.thumbnail((EDGE, EDGE))
    return np.asarray(image)


def _url(picture: Pixels) -> str:
    """A picture, [H, W, 3], as the data URL of a JPEG."""
    return "data:image/jpeg;base64," + base64.b64encode(encoded(picture, ".jpg")).decode("ascii")
