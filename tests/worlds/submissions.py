"""Submissions for tests: real short episodes, and what somebody could change in a submission afterwards."""

from __future__ import annotations

import hashlib
import json
import re
import subprocess
from collections.abc import Callable
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from hazard_ms.evaluation.attempts import attempt
from hazard_ms.evaluation.metrics import Tally
from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.evaluation.result import EpisodeResult
from hazard_ms.evaluation.submissions.card import Card
from hazard_ms.evaluation.submissions.packing import Manifest, mean_values, pack, packed, submission_of
from hazard_ms.evaluation.submissions.report import Report, Seen
from hazard_ms.evaluation.submissions.signing import sign
from hazard_ms.evaluation.submissions.tracks import PAIR, TRACKS, Track
from hazard_ms.evaluation.workers import Job, Word
from hazard_ms.skills.decision import STOP, WALK_ONE_STEP
from hazard_ms.skills.team import TeamSkills
from hazard_ms.spec.registry.mitigations import TELL

TRIAL, TRIAL_TEAMS = TRACKS["trial"], TRACKS["trial-teams"]
SHORT = "tests.evaluation.test_play:Short"  # looks around, takes a step, and stops
CARD = Card("short", ("somebody",), "Looks around, takes a step, and stops.", "nothing", {}, False, "none")
FIRST, SECOND = "episodes/HazardFire-v1-0000.json", "episodes/HazardFire-v1-0001.json"
Row = dict[str, Any]


def short_episode(seed: int) -> EpisodeResult:
    """A real episode of three decisions in the test split."""
    result = attempt(Job(EpisodeOptions(split="test", seed=seed, agent=SHORT), 60.0), ignore).result
    assert result is not None and len(result.decisions) == 3
    return result


def begun_episode(seed: int, **settings: Any) -> EpisodeResult:
    """A real episode in the test split that is stopped at once."""
    options = EpisodeOptions(**{"split": "test", "seed": seed, "agent": SHORT, **settings})
    result = attempt(Job(options, 60.0, actions=()), ignore).result
    assert result is not None and [decision.verb for decision in result.decisions] == [STOP]
    return result


def ignore(word: Word) -> None:
    """Nobody listens."""


def team_episodes() -> list[EpisodeResult]:
    """Two real episodes in which robot 0 tells of a thing that it alone sees, and robot 1 takes a step towards it."""
    env = TeamSkills.make("HazardFire-v1", PAIR, split="test", effects="off")
    made = []
    for place in TRIAL_TEAMS.places:
        env.reset(seed=place[1])
        first, second = env.knowledge.values()
        thing = first.labeller.names[next(i for i in first.seen.objects if i not in second.seen.objects)]
        told = ((TELL, f"{thing} is here"), (TELL, "I wait"), (WALK_ONE_STEP, thing), (STOP, None), (STOP, None))
        job = Job(TRIAL_TEAMS.options(place, "joint"), 60.0, told, robots=tuple(f"fetch-{k}" for k in (0, 1, 1, 0, 1)))
        done = attempt(job, ignore)
        assert done.result is not None and not done.error and done.result.decisions[3].frames > 1
        made.append(done.result)
    env.close()
    return made


def honest(results: list[EpisodeResult], card: Card = CARD, track: Track = TRIAL) -> bytes:
    """The submission of the two episodes of a track."""
    return pack({(r.env_id, r.seed): r for r in results}, track, card)


def changed(
    content: bytes,
    row: Callable[[Row], Any] = lambda row: None,
    manifest: Callable[[Row], Any] = lambda manifest: None,
    files: Callable[[dict[str, bytes]], dict[str, bytes]] = lambda files: files,
) -> bytes:
    """A submission whose first episode is changed by `row`, with hashes that fit; then the manifest, then the files."""
    submission = submission_of(content, "it")
    rows = {name: json.loads(text) for name, text in submission.files.items()}
    row(rows[FIRST])
    texts = {name: json.dumps(made).encode() for name, made in rows.items()}
    results = [EpisodeResult.from_dict(made) for made in rows.values()]
    told = json.loads(json.dumps(asdict(submission.manifest)))
    told["values"] = mean_values(results)
    for entry, text in zip(told["episodes"], texts.values(), strict=True):
        entry["sha256"] = hashlib.sha256(text).hexdigest()
    manifest(told)
    return packed(_manifest(told), files(texts))


def _manifest(told: Row) -> Manifest:
    from hazard_ms.spec.foreign import plain

    made: Manifest = plain.made(Manifest, told, "manifest")
    return made


def rescored(row: Row) -> None:
    """Give a changed row the score that its targets have."""
    row["score"] = json.loads(json.dumps(EpisodeResult.from_dict(row).to_dict()["score"]))


def make_key(folder: Path, name: str = "key") -> Path:
    """A new key of OpenSSH, and a file of signers beside it that knows it as `name`."""
    key = folder / name
    subprocess.run(["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-C", "", "-f", str(key)], check=True)
    with (folder / "signers").open("a") as signers:
        signers.write(f"{name} {key.with_suffix('.pub').read_text()}")
    return key


def report_of(name: str, values: dict[tuple[str, int], float], number: int = 0, **changes: Any) -> Report:
    """A report on a submission that nobody simulated: one target of two value points in each episode."""

    def seen(place: tuple[str, int], value: float) -> Seen:
        digest = f"{number:032x}{place[1]:032x}"
        tally = Tally(2 * value, 2.0, int(value > 0), 0, 100 if value > 0 else 0)
        return Seen(*place, f"kitchen_b/{place[1]:02d}", "exact", tally, 1500, digest, digest)

    fields: dict[str, Any] = {
        "submission": f"{number:016x}" * 4,
        "track": "trial",
        "episodes": len(values),
        "agent": name,
        "card": replace(CARD, name=name, authors=(f"author of {name}",)),
        "seen": tuple(seen(place, value) for place, value in values.items()),
        "faults": (),
        "date": f"2027-01-{number + 1:02d}T12:00:00Z",
        **changes,
    }
    return Report(**fields)


def written(report: Report, folder: Path, key: Path | None) -> Path:
    """The file of a report in a folder, signed by a key if there is one."""
    name = re.sub(r"\W+", ".", report.agent)
    path = folder / f"{name}-{report.submission[-4:]}.report.json"
    path.write_text(report.to_json())
    if key is not None:
        sign(path, key)
    return path
