"""Labels for policies: how much value each option of a decision leads to, found by playing all of them to the end.

Each option is played in a copy of the rescue, and a policy that sees only what an agent sees plays that on to its end.
A copy knows no more than the robot did, so that the mean of many such labels is what the option is worth to an agent:
it leads to no choices that rest on what is hidden.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hazard_ms.agents.learned.set_policy import worthwhile
from hazard_ms.sketch.policies import Policy, play
from hazard_ms.sketch.rescues.features import SketchEncoder
from hazard_ms.sketch.world import Sketch

STRAY = 0.1  # share of the options that are played at random, so that policies also learn where mistakes lead [ours]
SEEDS = 2**31  # seeds are drawn from 0 to this number


@dataclass(frozen=True)
class Labels:
    """M decisions and the value that each of their options led to."""

    features: NDArray[np.float32]  # as of `hazard_ms.skills.options.features`, [M, F]
    mask: NDArray[np.bool_]  # options that were tried, [M, A]
    worth: NDArray[np.float32]  # share of all value that was still rescued after each option, [M, A]; 0 if not tried

    def __add__(self, other: Labels) -> Labels:
        names = ("features", "mask", "worth")
        return Labels(*(np.concatenate([getattr(self, name), getattr(other, name)]) for name in names))


def worth(
    sketch: Sketch, rows: NDArray[np.int64], policy: Policy, chance: np.random.Generator
) -> tuple[NDArray[np.bool_], NDArray[np.float32]]:
    """The options worth trying at `rows` [R], and the value that each leads to if `policy` goes on: [R, A] each.

    The options of a rescue share their luck, which `chance` draws.
    """
    mask = worthwhile(sketch.mask[rows])
    row, option = np.nonzero(mask)
    trial = sketch.fork(rows[row], chance.integers(SEEDS, size=len(rows))[row])
    before = trial.state.score.copy()
    trial.step(option)
    play(trial, policy, int(chance.integers(SEEDS)))
    made = np.zeros(mask.shape, np.float32)
    made[row, option] = trial.state.score - before
    return mask, made


def collect(
    sketch: Sketch,
    encoder: SketchEncoder,
    player: Policy,
    judge: Policy,
    share: float,
    chance: np.random.Generator,
) -> Labels:
    """Play all rescues of `sketch` to their ends, and label every decision.

    `player` chooses a `share` of the options, `judge` the rest but STRAY. `judge` also plays on after each option that
    is tried. `chance` draws all luck.
    """
    made = []
    everyone = np.arange(len(sketch.state.frame))
    while not sketch.state.over.all():
        rows = np.flatnonzero(~sketch.state.over)
        features = encoder.encode(sketch.stack, sketch.state, sketch.slots, sketch.tool)[rows]
        made.append(Labels(features, *worth(sketch, rows, judge, chance)))
        allowed = worthwhile(sketch.mask)
        at_random = (chance.random(allowed.shape) * allowed).argmax(axis=1)
        option = np.where(chance.random(len(everyone)) < share, player(sketch, chance), judge(sketch, chance))
        stray = (chance.random(len(everyone)) < STRAY) | ~allowed[everyone, option]
        sketch.step(np.where(stray, at_random, option))
    return Labels(*(np.concatenate([getattr(part, name) for part in made]) for name in ("features", "mask", "worth")))
