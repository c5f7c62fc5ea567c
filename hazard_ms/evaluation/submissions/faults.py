"""Faults of submissions by name, and those that are found without a simulation."""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, Any

from hazard_ms.agents.base import PrivilegedAgent
from hazard_ms.agents.latency import OFF, frames_of
from hazard_ms.evaluation.result import BROKEN, FAILED, FORMAT, EpisodeResult
from hazard_ms.evaluation.submissions.packing import MANIFEST, Entry, Submission, mean_values, name_of
from hazard_ms.evaluation.submissions.tracks import Track
from hazard_ms.evaluation.teams.fields import TEAM_FORMAT
from hazard_ms.sensing.detection.perception import eyes_of
from hazard_ms.skills.options.features import FRAMES_PER_SECOND
from hazard_ms.spec.foreign.plain import Within
from hazard_ms.spec.registry import AGENTS, load
from hazard_ms.spec.registry.version import __version__

DAMAGED = "damaged file"
ORDER = "wrong order"
MISSING = "missing episode"
REPEATED = "repeated seed"
HASH = "forged hash"
VERSION = "other version"
PHYSICS = "other physics"
RULES = "other rules"
SCENE = "other scene"
SCORE = "edited score"
START = "other start"
CUT = "cut episode"
COURSE = "other course"
COPIED = "copied decisions"
CARD = "wrong card"
KINDS = {  # what each means
    DAMAGED: "it is cut off, no archive, or not in the form of a submission",
    ORDER: "its episodes are not in the order of its track",
    MISSING: "an episode of its track is missing, or an episode does not belong to its track",
    REPEATED: "an episode is there twice, or in the place of another",
    HASH: "a file has another SHA-256 than its manifest says, or the simulation has other hashes than the record",
    VERSION: "it was played with another version of hazard_ms",
    PHYSICS: "an episode was played with other settings",
    RULES: "an episode was played by another agent, perception or clock than the submission says",
    SCENE: "an episode was played in another scene than its seed chooses",
    SCORE: "a score does not follow from its targets, or the simulation has other targets or robot collisions",
    START: "the simulation starts in another state than the record, which must be of another scene or physics",
    CUT: "an episode stops before it is over, or its record stops before the episode",
    COURSE: "the simulation of the decisions takes another course than the record",
    COPIED: "its decisions are those of another submission",
    CARD: "its card makes a false claim",
}
MOST = 200  # faults that are told of one submission [ours]


@dataclass(frozen=True)
class Fault:
    """One fault: its kind, where it is, and what was found there."""

    kind: Annotated[str, Within(1, 40)]
    where: Annotated[str, Within(0, 1_000)]
    what: Annotated[str, Within(0, 2_000)]

    def __str__(self) -> str:
        """The fault in one line."""
        return f"{self.kind}: {self.where}: {self.what}"


def faults_of(submission: Submission, track: Track) -> list[Fault]:
    """The faults of a submission that show without a simulation; none if its episodes can be simulated."""
    found = [*_order(submission, track), *_hashes(submission)]
    try:
        rows = submission.rows()
    except ValueError as error:
        return [*found, Fault(DAMAGED, MANIFEST, str(error)[:1_000])]
    for entry in submission.manifest.episodes:
        if entry.name in rows:
            found += _episode(entry, *rows[entry.name], submission, track)
    own = mean_values([result for _, result in rows.values()])
    told = submission.manifest.values
    if any(abs(told.get(task, -1.0) - mean) > 1e-12 for task, mean in own.items()) or told.keys() != own.keys():
        found.append(Fault(SCORE, MANIFEST, f"it says {_shown(told)}, its episodes have {_shown(own)}"))
    return [*found, *_card(submission), *_version("versions", submission.manifest.versions)][:MOST]


def _order(submission: Submission, track: Track) -> Iterator[Fault]:
    """Faults in which episodes there are, and in what order."""
    entries, names = submission.manifest.episodes, list(submission.files)
    if submission.manifest.track != track.name:
        yield Fault(RULES, MANIFEST, f"track must be {track.name}, got {submission.manifest.track}")
    places = [entry.place for entry in entries]
    for place, count in Counter(places).items():
        if count > 1:
            yield Fault(REPEATED, MANIFEST, f"{name_of(place)} is listed {count} times")
    wanted = track.places
    for place in wanted:
        if place not in places:
            yield Fault(MISSING, MANIFEST, f"{name_of(place)} is not listed")
    for place in places:
        if place not in wanted:
            yield Fault(MISSING, MANIFEST, f"{name_of(place)} does not belong to track {track.name}")
    if sorted(places) == sorted(wanted) and places != wanted:
        first = next(a for a, b in zip(places, wanted, strict=True) if a != b)
        yield Fault(ORDER, MANIFEST, f"{name_of(first)} is in the place of another episode")
    listed = [entry.name for entry in entries]
    if set(names) != set(listed):
        odd = sorted(set(names) ^ set(listed))[0]
        yield Fault(MISSING, odd, "it must be both in the archive and in the manifest")
    elif names != list(dict.fromkeys(listed)):
        yield Fault(ORDER, "archive", "its files must stand in the order of the manifest")


def _hashes(submission: Submission) -> Iterator[Fault]:
    for entry in submission.manifest.episodes:
        content = submission.files.get(entry.name)
        if content is not None and (own := hashlib.sha256(content).hexdigest()) != entry.sha256:
            yield Fault(HASH, entry.name, f"its SHA-256 is {own[:12]}..., the manifest says {entry.sha256[:12]}...")


def _episode(
    entry: Entry, row: dict[str, Any], result: EpisodeResult, submission: Submission, track: Track
) -> Iterator[Fault]:
    """Faults in what the file of one episode says."""
    where, manifest = entry.name, submission.manifest
    if (result.env_id, result.seed) != entry.place:
        yield Fault(REPEATED, where, f"it holds {name_of((result.env_id, result.seed))}")
        return
    if entry.place not in track.places:
        return
    if result.format != (number := FORMAT if isinstance(track.robot, str) else TEAM_FORMAT):
        yield Fault(VERSION, where, f"format must be {number}, got {result.format}")
    yield from _version(where, result.versions)
    expected = track.settings(entry.place)
    own = {name: value for name, value in result.settings.items() if name != "scenes" or track.scenes is None}
    if own != expected:
        odd = sorted(n for n in own.keys() | expected.keys() if own.get(n) != expected.get(n))[0]
        yield Fault(PHYSICS, where, f"{odd} must be {expected.get(odd)!r}, got {own.get(odd)!r:.100}")
    if (scene := track.scene(entry.place)) != result.scene:
        yield Fault(SCENE, where, f"scene must be {scene}, got {result.scene!r:.100}")
    yield from _rules(where, result, submission, track)
    if row.get("score") != result.to_dict()["score"]:
        yield Fault(SCORE, where, f"it says {row.get('score')!r:.200}, its targets give {result.to_dict()['score']!r}")
    if manifest.agent != result.agent:
        yield Fault(RULES, where, f"agent must be {manifest.agent!r:.100}, got {result.agent!r:.100}")
    yield from _end(where, result)


def _rules(where: str, result: EpisodeResult, submission: Submission, track: Track) -> Iterator[Fault]:
    if not track.perceives(result.perception) or result.perception != submission.manifest.perception:
        names = " or ".join(track.detectors)
        yield Fault(RULES, where, f"perception must be {names}, the same in all, got {result.perception!r:.100}")
    elif result.eyes != eyes_of(result.perception):
        yield Fault(RULES, where, f"eyes must be {eyes_of(result.perception)}, got {result.eyes}")
    if result.clock != track.clock:
        yield Fault(RULES, where, f"clock must be {track.clock}, got {result.clock!r:.100}")
    for k, d in enumerate(result.decisions):
        most = 0 if track.clock == OFF else frames_of(d.thought, 1.0 / FRAMES_PER_SECOND)
        last = k == len(result.decisions) - 1  # the episode may end while the agent thinks
        if d.waited > most or (d.waited < most and not last):
            yield Fault(RULES, where, f"decision {k} must wait {most} frames, got {d.waited}")
            return


def _end(where: str, result: EpisodeResult) -> Iterator[Fault]:
    """Faults in how an episode ends, which every record of a whole episode tells alike."""
    last = result.links[-1].frame if result.links else None
    if last != result.frames and result.ended not in (*FAILED, BROKEN):
        yield Fault(CUT, where, f"its hashes end at frame {last}, the episode at {result.frames}")
    elif result.ended == "time" and result.frames != result.max_frames:
        yield Fault(CUT, where, f"it ends by time at frame {result.frames} of {result.max_frames}")


def _version(where: str, versions: dict[str, str]) -> Iterator[Fault]:
    if (found := versions.get("hazard-ms")) != __version__:
        yield Fault(VERSION, where, f"hazard-ms must be {__version__}, which verifies, got {found!r:.100}")


def _card(submission: Submission) -> Iterator[Fault]:
    entry = AGENTS.get(submission.manifest.agent.removeprefix("independent:").partition(":")[0])
    if entry is not None and issubclass(load(entry.agent), PrivilegedAgent) and not submission.manifest.card.privileged:
        yield Fault(CARD, MANIFEST, f"privileged must be true for {entry.name}, got false")


def _shown(values: dict[str, float]) -> str:
    return ", ".join(f"{task} {100 * value:.1f} %" for task, value in list(values.items())[:10])
