"""`hazard-ms regret`: simulates recorded episodes again, judges each decision, and writes a file beside each result."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import torch

from hazard_ms.agents.base import PrivilegedAgent
from hazard_ms.evaluation.attempts import Recorded, Teller
from hazard_ms.evaluation.choices import RAY
from hazard_ms.evaluation.regret.appraiser import Appraiser
from hazard_ms.evaluation.regret.causes import EpisodeRegret, beside, decisions_of, digest, lost_by, place_of
from hazard_ms.evaluation.regret.table import table
from hazard_ms.evaluation.replay import DIFFERENT, compare, job_of
from hazard_ms.evaluation.result import FAILED, DamagedResultError, EpisodeResult, result_files
from hazard_ms.evaluation.runner import play
from hazard_ms.evaluation.spread import Where, spread
from hazard_ms.evaluation.workers import Job, Outcome, Say
from hazard_ms.spec.registry import AGENTS, load


@dataclass(frozen=True)
class RegretJob(Job):
    """The episode of the result in the file `path`, to be simulated again and judged."""

    path: Path = Path()


def regret(folders: Sequence[Path], where: Where, load: tuple[str, ...]) -> list[EpisodeRegret]:
    """The regret of all results in `folders` and the folders in them, each also in a file beside its result.

    Files that are there and fit their result are kept. `where`: processes and machines, which must all share the
    folders; `load`: modules that the episodes need. Raises ValueError for a folder without results, and for results
    that cannot be played again.
    """
    if where.backend == RAY:  # whose processes are elsewhere
        folders = [folder.absolute() for folder in folders]
    found = _records(folders)
    if not found:
        raise ValueError(f"folders must hold results of `hazard-ms evaluate`, got none in {_listed(folders)}")
    made = {path: kept for path in found if (kept := _kept(path)) is not None}
    jobs = [_job(path, result, load) for path, result in found.items() if path not in made]
    failed = []
    with spread(jobs, where.workers, where.backend, where.address, attempt) as outcomes:
        for job, outcome in outcomes:
            assert isinstance(job, RegretJob)
            if outcome.result is None:
                failed.append(f"{job.path}: {outcome.error}")
                print(f"no regret: {failed[-1]}", flush=True)
                continue
            made[job.path] = EpisodeRegret.read(place_of(job.path))
            print(f"{len(made)}/{len(found)} {job.path.name}: {line(made[job.path])}", flush=True)
    if made:
        print(table([made[path] for path in sorted(made)]))
    if failed:
        raise ValueError(f"all {len(found)} episodes must replay as their results say, got {len(failed)} that do not")
    return [made[path] for path in sorted(made)]


def line(found: EpisodeRegret) -> str:
    """The regret of one episode in words."""
    parts = [f"{name} {100 * share:.1f}" for name, share in found.lost.items() if abs(share) >= 0.0005]
    what = "the value is not lost" if found.averts else "the value"
    return f"{100 * found.value:.1f} of {100 * found.start:.1f} % of {what}; lost by {', '.join(parts) or 'nothing'}"


def regret_of(record: EpisodeResult, known: str, appraiser: Appraiser) -> EpisodeRegret:
    """The regret of the episode of `record`, whose file has the SHA-256 `known`, after `appraiser` has watched it."""
    count = len(appraiser.appraisals)
    landings = [*appraiser.bests[1 : count + 1], appraiser.value][:count]
    fallbacks = [decision.fallback for decision in record.decisions[:count]]
    frames = [decision.waited + decision.frames for decision in record.decisions[:count]]
    decisions = decisions_of(appraiser.appraisals, fallbacks, landings, frames)
    broken_off = record.ended in FAILED and len(appraiser.bests) > count
    ended = appraiser.bests[count] - appraiser.value if broken_off else 0.0
    start = appraiser.bests[0] if appraiser.bests else 0.0
    return EpisodeRegret(
        result=known,
        agent=record.agent,
        seed=record.seed,
        scene=record.scene,
        start=start,
        value=appraiser.value,
        lost=lost_by(decisions, ended),
        decisions=decisions,
        averts=appraiser.averts,
    )


def attempt(job: Job, say: Say) -> Outcome:
    """Simulate one episode again in this process, with one thread, judge its decisions, and write their regret."""
    assert isinstance(job, RegretJob) and job.actions is not None
    torch.set_num_threads(1)
    try:
        known, record = digest(job.path), EpisodeResult.read(job.path)
        appraiser = Appraiser(len(job.actions), told=sees_all(record.agent))
        player = Recorded(job.actions, job.options.agent, job.waits)
        played = play(job.options, [Teller(job.options, say), appraiser], player)
        verdict, why = compare(record, played)
        if verdict == DIFFERENT:
            return Outcome(None, f"its replay must be the same episode, got another{why}")
        regret_of(record, known, appraiser).write(place_of(job.path))
        return Outcome(played)
    except Exception as error:
        return Outcome(None, f"{type(error).__name__}: {error}")


def sees_all(name: str) -> bool:
    """Whether an agent is a registered one that sees what is hidden, and plans with all of it."""
    entry = AGENTS.get(name.partition(":")[0])
    known = "known=true" in name.lower()
    return entry is not None and issubclass(load(entry.agent), PrivilegedAgent) and not known


def _job(path: Path, result: EpisodeResult, load: tuple[str, ...]) -> RegretJob:
    played = job_of(result, load)
    return RegretJob(played.options, played.decision_seconds, played.actions, played.waits, path=path)


def _records(folders: Sequence[Path]) -> dict[Path, EpisodeResult]:
    """The results of one robot in `folders` by their files; a file that holds none is left out."""
    found = {}
    for path in result_files(folders):
        try:
            result = EpisodeResult.read(path)
        except DamagedResultError as damaged:
            print(f"left out: {damaged}")
            continue
        if result.robot_collisions is None:
            found[path] = result
        else:
            print(f"left out: {path} was played by a team, whose decisions cannot be judged yet")
    return found


def _kept(path: Path) -> EpisodeRegret | None:
    """The regret beside a result that an earlier run left, None where there is none that fits the result."""
    try:
        return beside(path)
    except ValueError as damaged:
        print(f"{damaged}: it is made again", flush=True)
        return None


def _listed(folders: Sequence[Path]) -> str:
    return ", ".join(map(str, folders))
