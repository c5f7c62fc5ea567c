"""The archive of a submission: a manifest with the SHA-256 of every file, then one result for each episode.

It is made of data alone: no code, no weights, no pictures. The same results make the same bytes.
"""

from __future__ import annotations

import dataclasses
import hashlib
import io
import json
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from hazard_ms.evaluation.result import EpisodeResult, machine, result_files, versions
from hazard_ms.evaluation.submissions.card import Card
from hazard_ms.evaluation.submissions.tracks import Place, Track
from hazard_ms.machine.cores import maker
from hazard_ms.spec.foreign import plain
from hazard_ms.spec.foreign.archives import read_archive
from hazard_ms.spec.foreign.files import printable, read_foreign
from hazard_ms.spec.foreign.plain import Within

FORMAT = 1  # goes up when a field changes its meaning, goes away or is new
MANIFEST = "manifest.json"
LARGEST = 20_000_000  # of a submission [bytes]; one of 75 episodes has 300,000 [ours]
MOST_UNPACKED = 200_000_000  # of all its files together [bytes] [ours]
MOST_EPISODES = 500  # [ours]
FIRST_DAY = (1980, 1, 1, 0, 0, 0)  # of all members, so that the same results make the same bytes (APPNOTE.TXT 4.4.6)
Hash = Annotated[str, Within(64, 64)]  # SHA-256, as hexadecimal digits
Short = Annotated[str, Within(0, 200)]  # [characters] [ours]
Share = Annotated[float, Within(-1e9, 1 + 1e-9)]


@dataclass(frozen=True)
class Entry:
    """One episode in a manifest: its task, its seed, and the SHA-256 of its file."""

    env_id: Short
    seed: Annotated[int, Within(0, 2**32 - 1)]
    sha256: Hash

    @property
    def place(self) -> Place:
        """Task and seed."""
        return self.env_id, self.seed

    @property
    def name(self) -> str:
        """The name of its file in the archive."""
        return name_of(self.place)


@dataclass(frozen=True)
class Manifest:
    """The first file of a submission: what it says it is. `values`: the mean Value of each task, 0 to 1."""

    track: Short
    agent: Annotated[str, Within(0, 1_000)]
    perception: Annotated[str, Within(0, 1_000)]
    card: Card
    values: dict[str, Share]
    versions: dict[str, Short]
    machine: dict[str, Any]
    episodes: Annotated[tuple[Entry, ...], Within(1, MOST_EPISODES)]
    format: int = FORMAT


@dataclass(frozen=True)
class Submission:
    """A submission as it was read: its SHA-256, its manifest, and what its files hold, in their order."""

    sha256: str
    manifest: Manifest
    files: dict[str, bytes]  # without the manifest

    def rows(self) -> dict[str, tuple[dict[str, Any], EpisodeResult]]:
        """The episode in each file, as plain data and as a result. Raises ValueError for a file without a result."""
        found = {}
        for name, content in self.files.items():
            row = plain.parse(content, name)
            try:
                found[name] = row, EpisodeResult.from_dict(row)
            except ValueError as error:
                raise ValueError(f"{name} must hold the result of an episode: {error}") from None
        return found


def name_of(place: Place) -> str:
    """The name of an episode's file in the archive: episodes/HazardFire-v1-0003.json."""
    return f"episodes/{place[0]}-{place[1]:04d}.json"


def results_of(folders: Sequence[Path], track: Track, agent: str | None) -> dict[Place, EpisodeResult]:
    """The results in `folders` that a track asks for, of one agent, in the order of the track.

    `agent` may be left out where there is only one. Raises ValueError for several agents, an episode that is there
    twice, and episodes that are missing.
    """
    wanted = set(track.places)
    found: dict[str, dict[Place, EpisodeResult]] = {}
    odd = ""  # what the first that is left out is played by
    for path in result_files(folders):
        result = EpisodeResult.read(path)
        place = (result.env_id, result.seed)
        if place not in wanted:
            continue
        if why := _odd(result, place, track):
            odd = odd or f"; left out: {path.name}, whose {why}"
            continue
        own = found.setdefault(result.agent, {})
        if place in own:
            raise ValueError(f"folders must hold {name_of(place)} of {result.agent} once, got it twice")
        own[place] = result
    if agent is None and len(found) > 1:
        raise ValueError(f"agent must be one of {', '.join(sorted(found))}, got none")
    own = found.get(agent or next(iter(found), ""), {})
    missing = [place for place in track.places if place not in own]
    if missing:
        first = name_of(missing[0])
        raise ValueError(
            f"folders must hold all {len(track.places)} episodes of track {track.name}, got {len(own)}; "
            f"the first that is missing: {first}{odd}"
        )
    return {place: own[place] for place in track.places}


def _odd(result: EpisodeResult, place: Place, track: Track) -> str:
    """What in a result is not by the rules of a track, as far as it tells; empty: nothing."""
    settings = {name: value for name, value in result.settings.items() if name != "scenes" or track.scenes is None}
    told = settings | {"scene": result.scene, "clock": result.clock}
    wanted = track.settings(place) | {"scene": track.scene(place), "clock": track.clock}
    for name in sorted(told.keys() | wanted.keys()):
        if told.get(name) != wanted.get(name):
            return f"{name} must be {wanted.get(name)!r}, got {told.get(name)!r:.100}"
    return (
        ""
        if track.perceives(result.perception)
        else f"perception must be {' or '.join(track.detectors)}, got {result.perception!r:.100}"
    )


def pack(results: dict[Place, EpisodeResult], track: Track, card: Card) -> bytes:
    """The archive of the episodes `results`, which are those that the track asks for, in its order."""
    files = {name_of(place): result.to_json().encode() for place, result in results.items()}
    entries = [Entry(*place, hashlib.sha256(files[name_of(place)]).hexdigest()) for place in results]
    first = next(iter(results.values()))
    manifest = Manifest(
        track=track.name,
        agent=first.agent,
        perception=first.perception,
        card=card,
        values=mean_values(list(results.values())),
        versions=versions(),
        machine={**machine(), "processor": maker()},
        episodes=tuple(entries),
    )
    return packed(manifest, files)


def packed(manifest: Manifest, files: dict[str, bytes]) -> bytes:
    """The archive of a manifest and the files that it names."""
    made = io.BytesIO()
    told = json.dumps(dataclasses.asdict(manifest), indent=1, allow_nan=False) + "\n"
    with zipfile.ZipFile(made, "w") as archive:
        for name, content in {MANIFEST: told.encode(), **files}.items():
            member = zipfile.ZipInfo(name, FIRST_DAY)
            member.external_attr, member.compress_type = 0o100644 << 16, zipfile.ZIP_DEFLATED
            archive.writestr(member, content, compresslevel=9)
    return made.getvalue()


def read_submission(path: Path) -> Submission:
    """The submission in a file. Raises ValueError for one that is damaged, hostile, or of another format."""
    return submission_of(read_foreign(path, LARGEST), path.name)


def submission_of(content: bytes, what: str) -> Submission:
    """The submission in the bytes of a file, which errors call `what`. Raises ValueError as `read_submission` does."""
    files = read_archive(content, what, MOST_UNPACKED, MOST_EPISODES + 1)
    if next(iter(files), "") != MANIFEST:
        raise ValueError(f"{printable(what)} must begin with {MANIFEST}, got {next(iter(files), 'nothing')!r:.100}")
    row = plain.parse(files.pop(MANIFEST), MANIFEST)
    if isinstance(row, dict) and row.get("format") != FORMAT:
        raise ValueError(f"format of {MANIFEST} must be {FORMAT}, got {row.get('format')!r:.100}")
    manifest: Manifest = plain.made(Manifest, row, MANIFEST)
    return Submission(hashlib.sha256(content).hexdigest(), manifest, files)


def mean_values(results: Sequence[EpisodeResult]) -> dict[str, float]:
    """The mean Value of each task, 0 to 1."""
    tasks = dict.fromkeys(result.env_id for result in results)
    every = {task: [r.tally.value for r in results if r.env_id == task] for task in tasks}
    return {task: sum(values) / len(values) for task, values in every.items()}
