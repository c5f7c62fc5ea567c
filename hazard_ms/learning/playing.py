"""Policies play in the sketch: options of the highest logit, and actions drawn from the six."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import torch

from hazard_ms.agents.learned.map_policy import MapPolicy
from hazard_ms.agents.learned.set_policy import SetPolicy, worthwhile
from hazard_ms.sketch.paper.maps import MapMaker
from hazard_ms.sketch.paper.moves import COUNT, SixSketch
from hazard_ms.sketch.rescues.features import SketchEncoder
from hazard_ms.sketch.rescues.scene import Floats, Ints, SketchScene
from hazard_ms.sketch.rescues.state import AGAIN, Domain
from hazard_ms.sketch.skill_times import SkillTimes
from hazard_ms.sketch.world import Sketch

TRIALS = 8  # rescues in each scene for a score [ours]
AT_ONCE = 256  # decisions that a network sees at once: so few stay in the processor's cache [ours]
SixPolicy = Callable[[SixSketch, np.random.Generator], Ints]


class Player:
    """Plays the options that a policy likes best."""

    def __init__(self, policy: SetPolicy) -> None:
        """Take a `policy`, which may go on learning."""
        self.policy, self.encoder = policy, SketchEncoder(policy.shape.ranges, policy.shape.measures)

    def play(self, sketch: Sketch, chance: np.random.Generator) -> Ints:
        """The options that it chooses for all rescues, [N]; for those that are over, any. Nothing is drawn."""
        del chance
        made, rows = np.zeros(len(sketch.state.frame), np.int64), np.flatnonzero(~sketch.state.over)
        seen = torch.from_numpy(self.encoder.encode(sketch.stack, sketch.state, sketch.slots, sketch.tool)[rows])
        allowed = torch.from_numpy(worthwhile(sketch.mask[rows]))
        parts = zip(seen.split(AT_ONCE), allowed.split(AT_ONCE), strict=True)
        made[rows] = torch.cat([self.policy.choose(*part) for part in parts]).numpy()
        return made


class MapPlayer:
    """Draws actions as likely as a policy wants them: the likeliest one again and again would often lead nowhere."""

    def __init__(self, policy: MapPolicy) -> None:
        """Take a `policy`, which may go on learning."""
        self.policy, self._maker = policy, MapMaker(policy.shape.ranges)

    def play(self, sketch: SixSketch, chance: np.random.Generator) -> Ints:
        """The actions that it chooses for all rescues, [N]; for those that are over, any."""
        made, rows = np.zeros(len(sketch.state.frame), np.int64), np.flatnonzero(~sketch.state.over)
        drawn = torch.from_numpy(chance.random(len(made)).astype(np.float32))
        maps, mask = self._maker.draw(sketch), np.ones((len(made), COUNT), bool)
        if self.policy.shape.masked:
            mask = sketch.possible()
        seen, allowed = torch.from_numpy(maps[rows]), torch.from_numpy(mask[rows])
        made[rows] = self.policy.draw(seen, allowed, drawn[rows]).numpy()
        return made


def at_random(sketch: SixSketch, chance: np.random.Generator) -> Ints:
    """One of the six actions in each rescue, whether or not it can be done, [N]."""
    return chance.integers(COUNT, size=len(sketch.state.frame))


def possible_at_random(sketch: SixSketch, chance: np.random.Generator) -> Ints:
    """One of the actions that can be done in each rescue, [N]."""
    return np.asarray((chance.random((len(sketch.state.frame), COUNT)) * sketch.possible()).argmax(axis=1))


def six_scores(scenes: Sequence[SketchScene], times: SkillTimes, policy: SixPolicy) -> Floats:
    """The Values of TRIALS rescues in each of `scenes`, with the seeds 0, 1, ..., by the six actions: [TRIALS, W]."""
    seeds, chance = np.arange(TRIALS * len(scenes)), np.random.default_rng(0)
    sketch = SixSketch(scenes, times, len(seeds), Domain(again=AGAIN))
    sketch.reset(seeds % len(scenes), seeds)
    while not sketch.state.over.all():
        sketch.act(policy(sketch, chance))
    return sketch.state.score.reshape(TRIALS, len(scenes))
