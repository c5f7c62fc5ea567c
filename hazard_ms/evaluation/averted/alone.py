"""Episodes in which nobody acts, played once for each seed and setting and kept beside the results of agents.

They follow from seed and settings alone. A file is used again where it was made with the same versions of this package
and of those that can change an episode; else its episode is played again.
"""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from hazard_ms.agents.latency import OFF
from hazard_ms.evaluation.averted.loss import Loss
from hazard_ms.evaluation.choices import AVERTED
from hazard_ms.evaluation.options import EpisodeOptions, SweepOptions
from hazard_ms.evaluation.result import ALONE, versions
from hazard_ms.evaluation.spread import spread
from hazard_ms.evaluation.workers import SILENCE, Job
from hazard_ms.skills.decision import STOP
from hazard_ms.spec.checks import one_of
from hazard_ms.spec.foreign import plain
from hazard_ms.spec.registry.detectors import TRUTH
from hazard_ms.spec.storage.files import write
from hazard_ms.tasks import task_of

FORMAT = 1  # goes up when a field changes its meaning
LARGEST = 1_000_000  # of a file [bytes] [ours]
NOBODY = "nobody"
AS_TASK, YES, _ = AVERTED


@dataclass(frozen=True)
class Alone:
    """The loss in one episode if nobody acts, and all that decides it."""

    env_id: str
    seed: int
    scene: str | None  # None: that of the seed
    settings: dict[str, Any]
    lost: Loss
    versions: dict[str, str] = field(default_factory=versions)
    format: int = FORMAT


def asked(options: SweepOptions) -> bool:
    """Whether episodes tell what is averted: as `options` say, or as the task declares.

    Raises ValueError for another answer than AVERTED offers.
    """
    if one_of(options.averted, AVERTED, "averted") != AS_TASK:
        return options.averted == YES
    env = options.env
    return task_of(env.env_id, env.physics, list(env.hazards) or None, env.severity).averted


def place(options: SweepOptions, episode: EpisodeOptions) -> Path:
    """The file that tells what is lost in `episode` if nobody acts."""
    path = options.place(_alone(episode, NOBODY))
    return path.with_name(path.stem + ALONE)


def losses(options: SweepOptions, episodes: Sequence[EpisodeOptions]) -> dict[EpisodeOptions, Loss | None]:
    """The loss of each of `episodes` if nobody acts: those that no file tells are played, and written at once.

    None where such an episode broke. Raises ValueError where a file cannot be written.
    """
    files = {episode: place(options, episode) for episode in episodes}
    firsts = {path: episode for episode, path in reversed(files.items())}
    found = {path: read(path, episode) for path, episode in firsts.items()}
    missing = {path: firsts[path] for path, loss in found.items() if loss is None}
    stops = {e: tuple((STOP, None) for _ in e.team or ("",)) for e in missing.values()}
    jobs = {
        path: Job(_alone(e, "random"), SILENCE, stops[e], averted=True, robots=e.team) for path, e in missing.items()
    }
    paths = {id(job): path for path, job in jobs.items()}
    with spread(list(jobs.values()), options.workers, options.backend, options.address) as outcomes:
        for done, (job, outcome) in enumerate(outcomes, 1):
            path = paths[id(job)]
            loss = found[path] = None if outcome.result is None else outcome.result.lost
            what = outcome.error or "its simulation broke"
            if loss is not None:
                e = missing[path]
                write(path, _text(Alone(e.env_id, e.seed, e.scene, e.settings, loss)))
                what = f"{loss.targets:g} of {loss.targets_total:g} of the targets' value is lost"
            print(f"nobody acts, {done}/{len(jobs)}: seed {job.options.seed}: {what}", flush=True)
    return {episode: found[path] for episode, path in files.items()}


def read(path: Path, episode: EpisodeOptions) -> Loss | None:
    """The loss that a file tells of `episode`, None where there is none, a damaged one, or one of other versions."""
    if not path.exists():
        return None
    try:
        found: Alone = plain.made(Alone, plain.read(path, LARGEST), "it")
    except ValueError as error:
        print(f"{error}: its episode is played again", flush=True)
        return None
    wanted = Alone(episode.env_id, episode.seed, episode.scene, json.loads(json.dumps(episode.settings)), found.lost)
    return found.lost if found == wanted else None


def _alone(episode: EpisodeOptions, agent: str) -> EpisodeOptions:
    """The same episode for an agent that neither thinks nor sees: what these are does not matter to it."""
    return replace(episode, agent=agent, clock=OFF, perception=TRUTH)


def _text(alone: Alone) -> str:
    return json.dumps(dataclasses.asdict(alone), indent=1, allow_nan=False) + "\n"
