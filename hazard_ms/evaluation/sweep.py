"""Episodes of agents on the scenes of a split or a folder, each in a file of its own, spread over processes.

Episodes whose files are there are not played again, so an interrupted run is resumed by starting it again. An agent
that raises, calls sys.exit, kills its process or hangs costs that episode alone.
"""

from __future__ import annotations

import json
import os
from collections import Counter
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from hazard_ms.evaluation.averted.alone import asked, losses
from hazard_ms.evaluation.averted.loss import Loss
from hazard_ms.evaluation.options import EpisodeOptions, SweepOptions
from hazard_ms.evaluation.report import report, summary
from hazard_ms.evaluation.result import BROKEN, FAILED, DamagedResultError, EpisodeResult, file_hashes
from hazard_ms.evaluation.spread import in_shard, shard, spread
from hazard_ms.evaluation.workers import Job
from hazard_ms.sensing.detection.perception import eyes_of
from hazard_ms.spec.registry.version import __version__
from hazard_ms.spec.storage.files import make_folder

LONGEST_NAME = 255  # of a file, in the file systems of Linux and macOS [bytes]


def evaluate(options: SweepOptions) -> int:
    """Play the missing episodes of this shard and print the table. Returns 1 if one broke or failed, else 0.

    Files that hold no whole result are named, and their episodes played again, as are those that failed, and those of
    an agent whose own files have changed since. Raises ValueError for what cannot be played, where the folder holds
    results of another version, and where a result cannot be written.
    """
    from hazard_ms.agents.base import check_name  # loads torch
    from hazard_ms.agents.team import check_team_name

    part, parts = shard(options.shard)
    every = options.episode_options()
    episodes = [e for e in every if in_shard(options.place(e).name, part, parts)]
    for agent in options.agents:
        (check_team_name if options.env.team else check_name)(agent)
    _check_names(options, every)
    make_folder(options.output)
    found = {e: result for e in episodes if (result := kept(options, e)) is not None}
    wanted = asked(options)
    if wanted:
        found = {e: result for e, result in found.items() if result.lost is not None or result.ended == BROKEN}
    others = {str(r.versions.get("hazard-ms")) for r in found.values()} - {__version__}
    if others:
        raise ValueError(
            f"output must hold results of hazard-ms {__version__} only, got {options.output} "
            f"with results of {', '.join(sorted(others))}"
        )
    alone = losses(options, episodes) if wanted else {}
    failed = _play_all([e for e in episodes if e not in found], options, alone)
    results = [found.get(e) or EpisodeResult.read(options.place(e)) for e in episodes if e not in failed]
    print(report(options, results, [e.agent for e in failed]))
    if parts > 1:
        print(f"this is shard {part}/{parts}, with {len(episodes)} of {len(every)} episodes")
    for episode, line in failed.items():
        print(f"no result: {line}; to play it again: {episode.command}")
    for result in results:
        if result.error:
            print(
                f"not finished: {result.agent}, seed {result.seed}: {result.error}; to see it again: {result.command}"
            )
    return int(bool(failed) or any(r.ended in (BROKEN, *FAILED) for r in results))


def _check_names(options: SweepOptions, episodes: list[EpisodeOptions]) -> None:
    agents: dict[Path, str] = {}
    for e in episodes:
        if agents.setdefault(options.place(e), e.agent) != e.agent:
            raise ValueError(
                "agents must differ in more than punctuation, since their results are named after them, got "
                f"{agents[options.place(e)]} and {e.agent}"
            )
    longest = max((len(os.fsencode(options.place(e).name)) for e in episodes), default=0)
    if longest > LONGEST_NAME:
        raise ValueError(
            f"a result's file must have a name of at most {LONGEST_NAME} bytes, got {longest}: "
            "give agents and perception shorter paths"
        )


def kept(options: SweepOptions, episode: EpisodeOptions) -> EpisodeResult | None:
    """The result that an earlier run left in its file, None where there is none, a part, or one that failed."""
    place = options.place(episode)
    try:
        found = EpisodeResult.read(place) if place.exists() else None
    except DamagedResultError as damaged:
        print(f"{damaged}: its episode is played again", flush=True)
        return None
    if found is not None and not _is_of(found, episode):
        print(f"{place} holds another episode than its name says: its episode is played again", flush=True)
        return None
    if found is not None and found.ended in FAILED:
        print(f"{place} holds an episode that failed ({found.error}): it is played again", flush=True)
        return None
    if found is not None and found.files != file_hashes(episode.agent, episode.perception):
        print(f"{place} was played with files that have changed since: its episode is played again", flush=True)
        return None
    return found


def _is_of(result: EpisodeResult, episode: EpisodeOptions) -> bool:
    """Whether a result is that of an episode, by what both name."""
    e = episode
    told = (result.env_id, result.agent, result.seed, result.clock, result.perception, result.eyes, result.settings)
    settings = json.loads(json.dumps(e.settings))
    return told == (e.env_id, e.agent, e.seed, e.clock, e.perception, eyes_of(e.perception), settings)


def _play_all(
    episodes: list[EpisodeOptions], options: SweepOptions, alone: Mapping[EpisodeOptions, Loss | None]
) -> dict[EpisodeOptions, str]:
    """Play `episodes`, and write each result at once. Returns those that have none, with their errors.

    `alone`: what is lost in each if nobody acts, where that is asked for.
    """
    jobs = [Job(e, options.timeout, averted=e in alone) for e in episodes]
    failed: dict[EpisodeOptions, str] = {}
    done: Counter[str] = Counter()
    with spread(jobs, options.workers, options.backend, options.address) as outcomes:
        for job, outcome in outcomes:
            done["all"] += 1
            if outcome.result is None:
                line = failed[job.options] = f"{job.options.agent}, seed {job.options.seed}: {outcome.error}"
            else:
                replace(outcome.result, lost_alone=alone.get(job.options)).write(options.place(job.options))
                line = summary(outcome.result, job.options.goal)
            if outcome.attempts > 1:
                done["again"] += 1
                line += "; it was played twice, since a worker died"
            print(f"{done['all']}/{len(jobs)} {line}", flush=True)
    if done["again"]:
        print(f"workers died in {done['again']} episodes, which were played a second time")
    return failed
