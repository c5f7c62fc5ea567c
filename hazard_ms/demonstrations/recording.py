"""`hazard-ms demos record`: plays episodes in processes of their own, and stores each as soon as it is over."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

import torch
from tqdm import tqdm

from hazard_ms.agents.base import agent, check_name
from hazard_ms.demonstrations import claims, store
from hazard_ms.demonstrations.card import write_card
from hazard_ms.demonstrations.layout import DECISIONS, FAILURES, FRAMES, MANIFEST, PRIVILEGED, TRUTH, Entry, shelves
from hazard_ms.demonstrations.options import RecordOptions
from hazard_ms.demonstrations.reading import described, entries
from hazard_ms.demonstrations.repair import repair
from hazard_ms.demonstrations.watching.foresight import Foresight
from hazard_ms.demonstrations.watching.recorder import Recorder
from hazard_ms.evaluation.attempts import Teller
from hazard_ms.evaluation.attempts import attempt as play_again
from hazard_ms.evaluation.choices import RAY
from hazard_ms.evaluation.replay import EXACT, compare, job_of
from hazard_ms.evaluation.result import BROKEN, EpisodeResult, versions
from hazard_ms.evaluation.runner import play
from hazard_ms.evaluation.spread import spread
from hazard_ms.evaluation.watchers import Watcher
from hazard_ms.evaluation.workers import SILENCE, Job, Outcome, Say
from hazard_ms.skills.failures import BLOCKED
from hazard_ms.spec import Goal
from hazard_ms.spec.storage.files import make_folder

MOST_BLOCKED = 3  # skills of one episode that may have been blocked, for it to be kept [ours]
REWARD = "normalized_dense"  # that recorded frames hold: what gym.make gives if no other is asked for
ELSEWHERE = "another process is recording it"


@dataclass(frozen=True)
class RecordJob(Job):
    """The episode that is to be recorded, and how."""

    record: RecordOptions = RecordOptions()


def record(options: RecordOptions) -> int:
    """Record the episodes that are not there yet. Returns 1 if one of them could not be recorded, else 0.

    Raises ValueError for what cannot be played, and where the folder holds episodes of another recipe or version.
    """
    options.check()
    check_name(options.agent)
    if options.backend == RAY:  # whose processes are elsewhere
        options = replace(options, output=options.output.absolute())
    dataset = options.dataset
    make_folder(dataset)
    if not (dataset / MANIFEST).is_symlink():  # which is refused
        (dataset / MANIFEST).touch()  # a dataset, even if no episode of it should be kept
    repair(dataset)
    done = {entry.seed for entry in recorded(dataset, options.recipe)}
    jobs = [RecordJob(e, SILENCE, record=options) for e in options.episode_options() if e.seed not in done]
    if len(jobs) < options.episodes:
        print(f"{options.episodes - len(jobs)} of {options.episodes} episodes are already recorded", flush=True)
    failed = 0
    played = spread(jobs, options.workers, options.backend, options.address, attempt)
    with played as outcomes, tqdm(total=len(jobs), unit="episode", disable=not jobs) as bar:
        for job, outcome in outcomes:
            bar.update()
            new = [entry for entry in recorded(dataset, options.recipe) if entry.seed == job.options.seed]
            failed += not new
            told = [line(dataset, entry, options.env.goal) for entry in new[:1]]
            bar.write(told[0] if told else f"seed {job.options.seed}: not recorded: {outcome.error}")
    write_card(dataset)
    every = recorded(dataset, options.recipe)
    lost = sum(bool(entry.reason) for entry in every)
    print(f"{dataset}: {len(every) - lost} episodes kept, {lost} in {FAILURES}/")
    return int(failed > 0)


def recorded(dataset: Path, recipe: dict[str, Any]) -> list[Entry]:
    """The entries of a dataset and of its failures.

    Raises ValueError for one whose recipe is another one, and for one of another version of hazard_ms.
    """
    ours = versions()["hazard-ms"]
    found = [entry for shelf in shelves(dataset) for entry in entries(shelf)]
    for entry in found:
        if (theirs := entry.versions.get("hazard-ms", ours)) != ours:
            raise ValueError(
                f"output must hold episodes of hazard-ms {ours} only, got {entry.name} in {dataset} of {theirs}; "
                "name another folder"
            )
        if entry.recipe != recipe:
            others = {key: entry.recipe.get(key) for key in recipe if entry.recipe.get(key) != recipe[key]}
            wanted = {key: recipe[key] for key in others}
            raise ValueError(
                f"output must hold episodes with {wanted} only, got {entry.name} in {dataset} with {others}; "
                "name another folder"
            )
    return found


def line(dataset: Path, entry: Entry, goal: Goal) -> str:
    """A line of text about how a recorded episode of a task with this `goal` went."""
    fate = f"in {FAILURES}/: {entry.reason}" if entry.reason else "kept"
    how = f"{100 * entry.value:.1f} % of the value"
    if goal.verb:
        ended = described((dataset / FAILURES if entry.reason else dataset) / entry.name)[0].ended
        how = f"{'succeeded' if ended == goal.done else 'failed'} ({ended})"
    return f"{entry.name}: {how}, {entry.frames} frames, {sum(entry.seconds.values()):.0f} s, {fate}"


def attempt(job: Job, say: Say) -> Outcome:
    """Record one episode in this process, with one thread."""
    assert isinstance(job, RecordJob)
    torch.set_num_threads(1)
    dataset, seed = job.record.dataset, job.options.seed
    try:
        with claims.claimed(dataset, seed) as mine:
            if not mine:
                return Outcome(None, ELSEWHERE)
            if any(entry.seed == seed for entry in recorded(dataset, job.record.recipe)):
                return Outcome(None)  # another process has recorded it meanwhile
            return Outcome(_recorded(job, say))
    except Exception as error:
        return Outcome(None, f"{type(error).__name__}: {error}")


def _recorded(job: RecordJob, say: Say) -> EpisodeResult:
    """Play the episode of `job`, and store it with all that is known of it."""
    options = job.record
    part = store.begin(options.dataset, job.options.seed)
    teacher = agent(job.options.agent)
    recorder = Recorder(teacher.privileged, options.state)
    foresight = Foresight(recorder)
    with _camera(part, options) as pictures:
        watchers = [Teller(job.options, say), recorder, foresight, *pictures]
        keywords: dict[str, Any] = {"obs_mode": "state"} if options.state else {}
        keywords |= {"cameras": options.mounted} if options.mounted else {}
        result = play(job.options, watchers, teacher, reward_mode=REWARD, **keywords)
    succeeded = bool(recorder.frames()["success"][-1:].any())
    reason, verified = why_not(result, foresight.bests[0], options.keep, succeeded, options.env.goal.verb), False
    seconds = {**result.phase_seconds, "labels": foresight.seconds}
    if options.verify:
        start = time.perf_counter()
        again = play_again(job_of(result, job.options.load), say)
        verdict, why = compare(result, again.result, again.error)
        verified, seconds["verify"] = verdict == EXACT, time.perf_counter() - start
        reason = reason if verified else f"simulated again, it is {verdict}{why}"
    put(part, options, result, (recorder, foresight), Verdict(reason, verified, seconds, teacher.privileged))
    return result


class Verdict(NamedTuple):
    """The verdict on a recorded episode, and how it was come to."""

    reason: str  # why it goes into the failures; empty if it does not
    verified: bool  # whether it was simulated again, with equal hashes
    seconds: dict[str, float]  # wall times by phase [s]
    privileged: bool  # whether its teacher sees what is hidden


def put(
    part: Path, options: RecordOptions, result: EpisodeResult, watched: tuple[Recorder, Foresight], verdict: Verdict
) -> Path:
    """Store the episode of `result`, which the recorder and the foresight have `watched`, from its folder `part` on.

    Returns its folder. Raises OSError where it cannot be written, and where there is an episode of its name.
    """
    recorder, foresight = watched
    store.put_arrays(part / DECISIONS, recorder.decisions())
    store.put_arrays(part / FRAMES, recorder.frames())
    store.put_arrays(part / PRIVILEGED / TRUTH, foresight.arrays())
    teaching = {"teacher": result.agent, "privileged": verdict.privileged, "reason": verdict.reason}
    reach = {"reach": foresight.bests[0], "recipe": options.recipe, "obs": options.recipe["obs"]}
    store.describe(part, result, {**recorder.meta(), **teaching, **reach, "every": options.recipe["every"]})
    known = replace(store.entry_of(part), verified=verdict.verified, seconds=verdict.seconds)
    entry = replace(known, versions=result.versions, machine=result.machine)
    return store.publish(part, options.dataset, entry)


@contextlib.contextmanager
def _camera(part: Path, options: RecordOptions) -> Iterator[list[Watcher]]:
    """The watcher that takes pictures, if any are wanted."""
    if not options.pictures:
        yield []
        return
    from hazard_ms.demonstrations.watching.camera import Cameras

    with Cameras(part, options.pictures, options.every, options.mounted) as cameras:
        yield [cameras]


def why_not(result: EpisodeResult, reach: float, keep: float, succeeded: bool, verb: str = "") -> str:
    """The reason for which an episode is not kept; empty if it is.

    `reach`: value of the best plan from its start; `succeeded`: whether it reached its task's goal; `verb`: of that.
    """
    blocked = sum(decision.reason == BLOCKED for decision in result.decisions)
    if result.ended == BROKEN:
        return result.ended
    if verb and keep > 0.0 and not succeeded:
        return "the goal was not reached"
    if result.tally.value < keep * reach and not succeeded:
        return f"{100 * result.tally.value:.1f} % of the value, of {100 * reach:.1f} % that can be reached"
    if blocked > MOST_BLOCKED and keep > 0.0:
        return f"{blocked} skills were blocked"
    return ""
