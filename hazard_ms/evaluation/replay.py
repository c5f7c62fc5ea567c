"""Simulates recorded episodes again, decision by decision, and compares them with their records."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping

from hazard_ms.evaluation.options import EpisodeOptions, ReplayOptions
from hazard_ms.evaluation.result import EpisodeResult, result_files, versions
from hazard_ms.evaluation.spread import spread
from hazard_ms.evaluation.workers import SILENCE, Job
from hazard_ms.sensing.detection.perception import with_eyes

EXACT, SAME_SCORE, DIFFERENT = "exact", "same score", "different"


def replay(options: ReplayOptions) -> int:
    """Play the episodes of result files again in new processes, and print how each compares with its record.

    Returns 1 if one of them is different, else 0. Raises ValueError for files that hold no result.
    """
    files = [found for path in options.files for found in (result_files([path]) if path.is_dir() else [path])]
    if not files:
        raise ValueError(f"files must hold at least one result of an episode, got {', '.join(map(str, options.files))}")
    records = [(path, EpisodeResult.read(path)) for path in files]
    jobs = [job_of(record, options.load) for _, record in records]
    left = {id(job): record for job, record in zip(jobs, records, strict=True)}
    found: Counter[str] = Counter()
    with spread(jobs, options.workers) as outcomes:
        for job, outcome in outcomes:
            path, record = left[id(job)]
            verdict, why = compare(record, outcome.result, outcome.error)
            found[verdict] += 1
            print(f"{path}: {verdict}{why}{apart(record.versions)}", flush=True)
    print(", ".join(f"{n} {verdict}" for verdict, n in found.most_common()))
    return int(found[DIFFERENT] > 0)


def episode_of(record: EpisodeResult, load: tuple[str, ...] = ()) -> EpisodeOptions:
    """The episode that a result is of; `load` are modules that it needs, which no file can name.

    Raises ValueError for settings that no episode has.
    """
    settings = dict(record.settings)
    scene = settings.pop("scenes", record.scene)
    try:
        hazards = tuple(settings.pop("hazards", ()))
        return EpisodeOptions(
            env_id=record.env_id,
            **settings,
            hazards=hazards,
            load=load,
            agent=record.agent,
            seed=record.seed,
            scene=scene,
            perception=with_eyes(record.perception, record.eyes),
        )
    except TypeError as error:
        raise ValueError(f"settings must be those of an episode, got {record.settings!r:.200}: {error}") from None


def compare(record: EpisodeResult, played: EpisodeResult | None, error: str = "") -> tuple[str, str]:
    """Compare a record with its replay: EXACT, SAME_SCORE or DIFFERENT, and a text that says where they differ.

    exact: all links are equal, and so are the fates of all targets and the collisions of robots; same score: only the
    latter two are.
    """
    if played is None or (error and played.error != record.error):
        return DIFFERENT, f", it could not be played: {error}"
    if record.robot_collisions != played.robot_collisions:
        hits = f"{record.robot_collisions} collisions of robots in the file, {played.robot_collisions} now"
        return DIFFERENT, f"{_since(record, played)}; {hits}"
    if record.targets != played.targets:
        before, now = (100 * result.tally.value for result in (record, played))
        return DIFFERENT, f"{_since(record, played)}; {before:.1f} % of the value in the file, {now:.1f} % now"
    if record.links != played.links:
        return SAME_SCORE, _since(record, played)
    return EXACT, ""


def other_versions(recorded: Mapping[str, str]) -> str:
    """The packages of which a record was made with another version, as "sapien 3.0.2, here 3.0.3"; empty if none."""
    here = versions()
    return "; ".join(f"{n} {v}, here {here.get(n, 'absent')}" for n, v in recorded.items() if here.get(n) != v)


def apart(recorded: Mapping[str, str]) -> str:
    """The words to add to a verdict about a record that was made with these versions of packages."""
    others = other_versions(recorded)
    return f"; recorded with {others}" if others else ""


def _since(record: EpisodeResult, played: EpisodeResult) -> str:
    """A text that says from which frame on two episodes differ, as far as their links tell."""
    pairs = zip(record.links, played.links, strict=False)
    frame = next((a.frame for a, b in pairs if a != b), None)
    if frame is not None:
        return f", differs from frame {frame} of {record.frames} on"
    return f", the links do not say where, got {len(played.links)} instead of {len(record.links)}"


def job_of(record: EpisodeResult, load: tuple[str, ...] = ()) -> Job:
    """The job that plays the decisions of a result again; `load` as for `episode_of`, which says what it refuses."""
    actions = tuple((d.verb, d.target) for d in record.decisions)
    waits, robots = (tuple(getattr(d, name) for d in record.decisions) for name in ("waited", "robot"))
    return Job(episode_of(record, load), SILENCE, actions, waits, robots=robots)
