"""Simulates the episodes of a submission again, decision by decision, in new processes, and compares.

The track says what is simulated: task, scene, physics, robot, perception. The submission gives decisions and waits
alone. Nothing that it names is imported: where its agent is one of ours that is privileged, ours is asked, since it
tells the map what it knows.
"""

from __future__ import annotations

import hashlib
import json
import random
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from datetime import datetime, timezone
from pathlib import Path

import torch

from hazard_ms.agents.base import PrivilegedAgent
from hazard_ms.evaluation.attempts import attempt as play
from hazard_ms.evaluation.metrics import Tally
from hazard_ms.evaluation.replay import DIFFERENT, EXACT, compare, other_versions
from hazard_ms.evaluation.result import BROKEN, FAILED, STUCK, EpisodeResult, machine, versions
from hazard_ms.evaluation.spread import Where, spread
from hazard_ms.evaluation.submissions.faults import COURSE, CUT, DAMAGED, HASH, SCORE, START, Fault, faults_of
from hazard_ms.evaluation.submissions.packing import Submission, name_of, read_submission
from hazard_ms.evaluation.submissions.report import Claim, Report, Sample, Seen
from hazard_ms.evaluation.submissions.tracks import TRACKS, Place, Track
from hazard_ms.evaluation.workers import SILENCE, Job, Outcome, Say
from hazard_ms.machine.cores import maker
from hazard_ms.skills.decision import STOP
from hazard_ms.spec.checks import whole
from hazard_ms.spec.foreign.files import sha256_of
from hazard_ms.spec.registry import AGENTS, load

NOBODY = "random"  # an agent that is never asked: decisions are those of the record
UNASKED = ("time", "failed", BROKEN, STUCK)  # ends of episodes that no agent chooses
NO_HASH = "0" * 64  # of a simulation that did not begin
HERE = Where()  # one process for each core


@dataclass(frozen=True)
class Simulation(Job):
    """The decisions of a record, to be simulated in the episode that `track` asks for."""

    track: Track = TRACKS["published"]


def verify(path: Path, track: Track | None, episodes: int = 0, seed: int = 0, where: Where = HERE) -> Report:
    """The report on a submission in a file; `track` is the one that it must be of, None where it names none.

    `episodes`: how many are drawn by `seed` and simulated, 0 for all; `where`: in which processes. Raises ValueError
    for a file that is not there, for more episodes than the track has, and as `simulated` does.
    """
    digest = sha256_of(path)
    try:
        submission = read_submission(path)
    except ValueError as error:
        return _report(digest, None, track, [], [Fault(DAMAGED, path.name, str(error)[:1_000])])
    if track is None:
        fault = Fault(DAMAGED, path.name, f"track must be a known one, got {submission.manifest.track!r:.100}")
        return _report(digest, submission, None, [], [fault])
    whole(episodes, 0, len(track.places), "episodes")
    faults = faults_of(submission, track)
    if faults:
        return _report(digest, submission, track, [], faults)
    wanted = track.places
    sample = Sample(episodes, seed) if 0 < episodes < len(wanted) else None
    if sample:
        wanted = sorted(random.Random(seed).sample(wanted, episodes), key=wanted.index)
    seen, found = simulated(submission, track, wanted, where)
    return replace(_report(digest, submission, track, seen, found), sample=sample)


def simulated(
    submission: Submission, track: Track, places: Sequence[Place], where: Where = HERE
) -> tuple[list[Seen], list[Fault]]:
    """Simulate the episodes at `places` of a submission without faults; each is printed as it ends.

    Raises ValueError where that says nothing of the submission: where the process of an episode dies twice, and where
    one differs on a processor without AVX2, or on a machine with other packages or a processor of another maker.
    """
    rows = submission.rows()
    records = {place: rows[name_of(place)][1] for place in places}
    seen: dict[Place, Seen] = {}
    faults: dict[Place, list[Fault]] = {}
    jobs = {place: _job(record, place, track) for place, record in records.items()}
    alone = {place: _nobody(job) for place, job in jobs.items() if track.averted}
    lost: dict[Place, EpisodeResult | None] = {}
    for place, outcome in _played(alone, where):
        lost[place] = outcome.result
    for place, outcome in _played(jobs, where):
        record, played = records[place], outcome.result
        nobody = lost.get(place)
        if played is not None and nobody is not None:
            played = replace(played, lost_alone=nobody.lost)
        verdict, faults[place] = compared(record, played, outcome.error)
        if faults[place] and played is not None:
            _check_machine(played)
        seen[place] = _seen(place, record, played, verdict)
        line = f"{len(seen)}/{len(places)} {name_of(place)}: {verdict}"
        print("; ".join([line, *(fault.what for fault in faults[place])]), flush=True)
    return [seen[place] for place in places], [fault for place in places for fault in faults[place]]


def compared(record: EpisodeResult, played: EpisodeResult | None, error: str = "") -> tuple[str, list[Fault]]:
    """Compare a record with its simulation: the verdict of a replay, and a fault where anything differs."""
    where = name_of((record.env_id, record.seed))
    verdict, why = compare(record, played, error)
    why = why.removeprefix(", ")
    if played is None:
        return verdict, [Fault(COURSE, where, why or "it could not be simulated")]
    if record.links != played.links:
        common = min(len(record.links), len(played.links))
        if record.links[:common] == played.links[:common]:
            what = f"its record has {len(record.links)} hashes, the simulation {len(played.links)}, the first alike"
            return verdict, [Fault(CUT, where, what)]
        if record.links[0] != played.links[0]:
            return verdict, [Fault(START, where, why)]
        return verdict, [Fault(COURSE if verdict == DIFFERENT else HASH, where, why)]
    if (record.targets, record.robot_collisions) != (played.targets, played.robot_collisions):
        return verdict, [Fault(SCORE, where, why)]
    alone = record.robot_collisions is None  # of a robot alone, any record ends by a stop
    told = record.ended in UNASKED if alone else record.ended not in FAILED
    if record.frames != played.frames or (told and record.ended != played.ended):
        what = f"it ends at frame {record.frames} ({record.ended}), the simulation at {played.frames} ({played.ended})"
        return verdict, [Fault(CUT, where, what)]
    own = record.to_dict()["score"]
    again = replace(played, clock=record.clock, decisions=record.decisions).to_dict()["score"]  # thought is a claim
    if any(again.get(name) != value for name, value in own.items()):
        return verdict, [Fault(SCORE, where, f"the simulation has {again}, the record {own}")]
    if verdict != EXACT:
        return verdict, [Fault(COURSE, where, why)]
    return verdict, list(_decisions(record, played))


def _decisions(record: EpisodeResult, played: EpisodeResult) -> Iterator[Fault]:
    """The first decision that went otherwise than the record says, or that was never taken."""
    where = name_of((record.env_id, record.seed))
    if len(record.decisions) > len(played.decisions):
        what = f"it has {len(record.decisions)} decisions, the simulation ends after {len(played.decisions)}"
        yield Fault(COURSE, where, what)
        return
    for k, (told, found) in enumerate(zip(record.decisions, played.decisions, strict=False)):
        again = replace(found, note=told.note, fallback=told.fallback, thought=told.thought)
        if told != again:
            yield Fault(COURSE, where, f"decision {k}, {told.verb} at frame {told.frame}, had another outcome")
            return


def attempt(job: Job, say: Say) -> Outcome:
    """Simulate one episode in this process, a hidden scene from a file of its own, and tell what the processor is.

    The scene is made here, so that no machine of a cluster needs the files of another one.
    """
    assert isinstance(job, Simulation)
    with job.track.scene_file((job.options.env_id, job.options.seed)) as scene:
        done = play(replace(job, options=replace(job.options, scene=scene)), say)
    if done.result is None:
        return done
    own = {"processor": maker(), "instructions": torch.backends.cpu.get_cpu_capability()}
    return done._replace(result=replace(done.result, machine=done.result.machine | own))


def _job(record: EpisodeResult, place: Place, track: Track) -> Simulation:
    options = track.options(place, _asked(record.agent), record.perception)
    actions = tuple((d.verb, d.target) for d in record.decisions)
    waits, robots = (tuple(getattr(d, name) for d in record.decisions) for name in ("waited", "robot"))
    return Simulation(options, SILENCE, actions, waits, averted=track.averted, robots=robots, track=track)


def _nobody(job: Simulation) -> Simulation:
    """The same episode if nobody acts."""
    robots = job.options.team or ("",)
    return replace(job, actions=((STOP, None),) * len(robots), waits=(), robots=robots)


def _asked(agent: str) -> str:
    """The agent that is asked beside the record: one of ours that is privileged, without its parameters, else none."""
    name = agent.partition(":")[0]
    entry = AGENTS.get(name)
    return name if entry is not None and issubclass(load(entry.agent), PrivilegedAgent) else NOBODY


def _played(jobs: dict[Place, Simulation], where: Where) -> Iterator[tuple[Place, Outcome]]:
    places = {id(job): place for place, job in jobs.items()}
    with spread(list(jobs.values()), where.workers, where.backend, where.address, attempt) as outcomes:
        for job, outcome in outcomes:
            if outcome.died:
                raise ValueError(f"each episode must be simulated, got {name_of(places[id(job)])}: {outcome.error}")
            yield places[id(job)], outcome


def _check_machine(played: EpisodeResult) -> None:
    """Raise ValueError for a simulation by a machine that differs in what can change an episode."""
    if not str(taken := played.machine.get("instructions")).startswith("AVX"):
        raise ValueError(f"all machines must compute with AVX2, got one where torch uses {taken}")
    others = other_versions(played.versions)
    if others:
        raise ValueError(f"all machines must have the versions of this one, got one with {others}")
    if (there := played.machine.get("processor")) != maker():
        raise ValueError(f"all machines must have processors of the same maker, got {there} there and {maker()} here")


def _seen(place: Place, record: EpisodeResult, played: EpisodeResult | None, verdict: str) -> Seen:
    found = played or replace(record, targets=tuple(replace(f, rescued=False, frame=None) for f in record.targets))
    told = [[*([d.robot] if d.robot else []), d.verb, d.target, d.waited] for d in record.decisions]
    decided = json.dumps(told).encode()
    return Seen(
        *place,
        scene=record.scene,
        verdict=verdict,
        tally=Tally.of(found.targets),
        frames=found.frames,
        decisions=hashlib.sha256(decided).hexdigest(),
        course=found.links[-1].sha256 if played is not None and found.links else NO_HASH,
        averted=None if played is None else played.averted,
    )


def _report(
    digest: str, submission: Submission | None, track: Track | None, seen: Sequence[Seen], faults: Sequence[Fault]
) -> Report:
    manifest = submission and submission.manifest
    return Report(
        submission=digest,
        track=track.name if track else "",
        episodes=len(track.places) if track else 0,
        agent=manifest.agent if manifest else "",
        card=manifest.card if manifest else None,
        seen=tuple(seen),
        faults=tuple(faults),
        date=datetime.now(timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ"),
        played_with=manifest.versions if manifest else {},
        played_on=manifest.machine if manifest else {},
        versions=versions(),
        machine={**machine(), "processor": maker()},
        claim=_claim([r for _, r in submission.rows().values()]) if submission and seen else None,
    )


def _claim(results: Sequence[EpisodeResult]) -> Claim:
    names = list(dict.fromkeys(name for result in results for name in result.counters))
    mean = {name: sum(r.counters.get(name, 0.0) for r in results) / len(results) for name in names}
    return Claim(
        counters=mean,
        agent_seconds=sum(r.phase_seconds.get("agent", 0.0) for r in results) / len(results),
        thought_seconds=sum(d.thought for r in results for d in r.decisions) / len(results),
    )
