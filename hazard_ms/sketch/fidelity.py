"""Compares the sketch with the real environment: the same agents in the same scenes, score by score."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy import stats

from hazard_ms.sketch.policies import POLICIES, play
from hazard_ms.sketch.rescues.scene import Floats, SketchScene
from hazard_ms.sketch.skill_times import SkillTimes
from hazard_ms.sketch.world import Sketch

TRIALS = 64  # rescues in the sketch for each real one: their mean is known to about 0.025 [ours]
# what is required of the sketch (hazard-ms sketch check)
MOST_VALUE_GAP = 0.05  # difference of mean Values
LEAST_CORRELATION = 0.6  # Spearman's, of the mean Values of scenes
DIGITS = 9  # of mean Values, so that sums in another order are equal
MOST_FRAMES_GAP = 0.10  # relative difference of mean frames for each rescue


@dataclass(frozen=True)
class SceneScore:
    """The score of an agent in one scene, or the mean of several tries there."""

    scene: str
    seed: int
    value: float  # rescued, as a share of all
    last: float  # frame of the last rescue; 0 if there was none
    rescued: float  # number of targets


@dataclass(frozen=True)
class Fidelity:
    """The sketch beside the real environment for one agent."""

    agent: str
    episodes: int
    real_value: float
    sketch_value: float
    correlation: float  # Spearman's, of the mean Values of scenes; NaN where those of either are all the same
    real_frames: float  # for each rescue; NaN without any
    sketch_frames: float

    @property
    def good(self) -> bool:
        """Whether the sketch is as close as required."""
        frames = abs(self.sketch_frames / self.real_frames - 1.0) <= MOST_FRAMES_GAP
        return (
            abs(self.sketch_value - self.real_value) <= MOST_VALUE_GAP
            and self.correlation >= LEAST_CORRELATION
            and frames
        )


def sketched(
    agent: str, scenes: Sequence[SketchScene], seeds: Sequence[int], times: SkillTimes, trials: int = TRIALS
) -> list[SceneScore]:
    """The mean of `trials` rescues of an agent of POLICIES in each of `scenes`, with the seed of the same number."""
    rows = np.repeat(np.arange(len(scenes)), trials)
    sketch = Sketch(scenes, times, len(rows))
    sketch.reset(rows, np.asarray(seeds)[rows] * trials + np.tile(np.arange(trials), len(scenes)))
    play(sketch, POLICIES[agent])

    def mean(of_rescues: Floats) -> Floats:
        return of_rescues.reshape(len(scenes), trials).mean(axis=1)

    saved = sketch.state.rescued_at
    last, rescued = mean(saved.max(axis=1, initial=0).astype(np.float64)), mean((saved >= 0).sum(axis=1) * 1.0)
    value = mean(sketch.state.score)
    return [
        SceneScore(scene.name, int(seed), float(value[n]), float(last[n]), float(rescued[n]))
        for n, (scene, seed) in enumerate(zip(scenes, seeds, strict=True))
    ]


def compared(agent: str, real: Sequence[SceneScore], sketch: Sequence[SceneScore]) -> Fidelity:
    """The two outcomes of the same episodes beside each other. Raises ValueError for different episodes, or none.

    An agent whose choices are drawn should play each scene several times: one rescue tells little of a scene.
    """
    if [(p.scene, p.seed) for p in real] != [(p.scene, p.seed) for p in sketch] or not real:
        raise ValueError(f"real and sketch must be scores of the same episodes, got {len(real)} and {len(sketch)}")
    values = np.array([[p.value for p in real], [p.value for p in sketch]])
    scenes = [p.scene for p in real]
    means_of = [values[:, [scene == each for scene in scenes]].mean(axis=1) for each in sorted(set(scenes))]
    of_scenes = np.array(means_of).T.round(DIGITS)
    same = (of_scenes == of_scenes[:, :1]).all(axis=1).any()
    correlation = float("nan") if same else float(stats.spearmanr(*of_scenes).statistic)
    means = values.mean(axis=1)
    return Fidelity(agent, len(real), float(means[0]), float(means[1]), correlation, _frames(real), _frames(sketch))


def _frames(played: Sequence[SceneScore]) -> float:
    """Mean frames for each rescue."""
    rescued = sum(p.rescued for p in played)
    return sum(p.last for p in played) / rescued if rescued else float("nan")


def same_order(found: Sequence[Fidelity]) -> bool:
    """Whether the sketch ranks the agents by Value as the real environment does."""
    real = sorted(found, key=lambda each: each.real_value)
    return real == sorted(found, key=lambda each: each.sketch_value)


def table(found: Mapping[str, Sequence[Fidelity]]) -> str:
    """A table of the agents of each task."""
    lines = [
        "task               agent     n   Value: real  sketch   gap  Spearman  frames a rescue: real  sketch  good"
    ]
    for task, rows in found.items():
        for row in rows:
            values = f"{row.real_value:13.3f} {row.sketch_value:7.3f} {row.sketch_value - row.real_value:+.3f}"
            rest = f"{row.correlation:9.2f} {row.real_frames:22.0f} {row.sketch_frames:7.0f}  {_yes(row.good)}"
            lines.append(f"{task:18s} {row.agent:8s} {row.episodes:3d} {values} {rest}")
        lines.append(f"{task:18s} agents in the same order: {_yes(same_order(rows))}")
    return "\n".join(lines)


def _yes(good: bool) -> str:
    return "yes" if good else "no"
