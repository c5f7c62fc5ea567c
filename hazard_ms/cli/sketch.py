"""The commands `hazard-ms sketch ...`; each imports what it needs when it is called, so that help is quick."""

from __future__ import annotations

import functools
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro

from hazard_ms.evaluation.choices import PRESETS, flag, offer
from hazard_ms.spec import registry

if TYPE_CHECKING:
    from hazard_ms.evaluation.result import EpisodeResult
    from hazard_ms.sketch.fidelity import Fidelity, SceneScore
    from hazard_ms.sketch.rescues.scene import SketchScene

POLICIES = ("greedy", "nearest", "rule")  # as hazard_ms.sketch.policies has them; tests/cli compares them


def fit(
    files: tyro.conf.Positional[tuple[Path, ...]],
    output: Annotated[Path | None, flag("-o")] = None,
    source: str = "",
) -> int:
    """Measure how long skills take and how often they work, from played episodes and probes of pick-ups.

    Args:
        files: Results of episodes, folders of them, and rows of `hazard-ms bench --pickups -o FILE.jsonl`.
        output: File for the tables; the shipped ones are hazard_ms/sketch/skill_times.json.
        source: Origin of the numbers: commit, machine, number of episodes.
    """
    from hazard_ms.sketch import fit_times, skill_times
    from hazard_ms.spec.storage.files import write

    attempts: dict[str, list[fit_times.Attempt]] = defaultdict(list)
    for file in files:
        if file.suffix == ".jsonl":
            for robot, probed in fit_times.probed(file):
                attempts[robot].append(probed)
            continue
        for result in _results(file):
            for d in result.decisions:
                carts = d.verb == "drop" and d.target is not None
                made = fit_times.attempt(d.verb, d.ok, d.reason, d.frames, carts)
                if made is not None:
                    attempts[str(result.settings.get("robot_uids", "fetch"))].append(made)
    tables = skill_times.read(skill_times.SHIPPED)
    for robot, found in attempts.items():
        tables[robot] = fit_times.fit(robot, found, skill_times.shipped(robot), source)
    if output is not None:
        write(output, skill_times.as_json(tables))
    for robot, times in sorted(tables.items()):
        print(f"{robot}: {times.source}")
        for skill in skill_times.SKILLS:
            success, frames, failed = times.typical(skill)
            print(f"  {skill:8s} works {success:5.1%}   frames: {frames:4.0f} if it does, {failed:4.0f} if not")
    return 0


def check(
    folders: tyro.conf.Positional[tuple[Path, ...]],
    env_id: Annotated[str, offer(registry.TASKS), flag("-e")] = "",
    agents: tuple[Annotated[str, offer(POLICIES)], ...] = ("greedy", "rule"),
    trials: int = 64,
) -> int:
    """Compare the sketch with real episodes of the same agents and scenes. Exits with 1 if they differ too much.

    Args:
        folders: Folders of results, as `hazard-ms evaluate -o FOLDER` makes them.
        env_id: Only this task.
        agents: Agents to compare, among those that the sketch can play.
        trials: Rescues in the sketch for each real episode.

    Raises:
        ValueError: for unknown agents, and for folders without results of any of them.
    """
    from hazard_ms.sketch import fidelity, skill_times
    from hazard_ms.sketch.policies import POLICIES as KNOWN
    from hazard_ms.spec.checks import one_of

    for agent in agents:
        one_of(agent, KNOWN, "agent")
    played: dict[tuple[str, str], list[EpisodeResult]] = defaultdict(list)
    for result in (r for folder in folders for r in _results(folder)):
        if result.agent in agents and env_id in ("", result.env_id):
            played[result.env_id, result.agent].append(result)
    if not played:
        raise ValueError(
            f"folders must hold results of {', '.join(agents)}, got none in {', '.join(map(str, folders))}"
        )
    found: dict[str, list[Fidelity]] = defaultdict(list)
    scene_of = functools.cache(_scene)
    for (task, agent), results in sorted(played.items()):
        scenes = [scene_of(r.env_id, r.scene, r.seed, r.max_frames, _settings(r)) for r in results]
        robot = str(results[0].settings["robot_uids"])
        sketched = fidelity.sketched(agent, scenes, [r.seed for r in results], skill_times.load(robot), trials)
        found[task].append(fidelity.compared(agent, [_score(r) for r in results], sketched))
    print(fidelity.table(found))
    return 0 if all(each.good for rows in found.values() for each in rows) else 1


def speed(
    env_id: Annotated[str, offer(registry.TASKS), flag("-e")] = "HazardFire-v1",
    scenes: int = 8,
    physics: Annotated[str, offer(PRESETS)] = "paper",
) -> int:
    """Print how many decisions per second the sketch and its environments make on one core.

    Args:
        env_id: Task.
        scenes: Number of training scenes.
        physics: Preset of the hazards.
    """
    from hazard_ms.sketch import skill_times
    from hazard_ms.sketch.scenes import level_ranges, training_scenes
    from hazard_ms.sketch.speed import report

    ranges = level_ranges(env_id, physics)
    print(report(training_scenes(env_id, physics, scenes), skill_times.load("fetch"), ranges))
    return 0


def _results(path: Path) -> Iterator[EpisodeResult]:
    """The results of one robot in a file or in a folder."""
    from hazard_ms.evaluation.result import EpisodeResult, result_files

    for file in result_files([path]) if path.is_dir() else [path]:
        if (result := EpisodeResult.read(file)).robot_collisions is None:
            yield result


def _score(result: EpisodeResult) -> SceneScore:
    from hazard_ms.sketch.fidelity import SceneScore

    tally = result.tally
    return SceneScore(result.scene, result.seed, tally.value, float(tally.last_rescue), float(tally.rescued))


def _settings(result: EpisodeResult) -> tuple[str, str, tuple[str, ...] | None, str]:
    """The preset, the robot, the chosen hazards and the severity of an episode."""
    told = result.settings
    hazards = tuple(told["hazards"]) if told.get("hazards") else None
    return str(told["physics"]), str(told["robot_uids"]), hazards, str(told.get("severity", "severe"))


def _scene(
    env_id: str, name: str, seed: int, max_frames: int, settings: tuple[str, str, tuple[str, ...] | None, str]
) -> SketchScene:
    """The scene of an episode in the sketch."""
    from hazard_ms.sketch.scenes import scenes_of

    physics, robot, hazards, severity = settings
    return scenes_of(env_id, [name], [seed], physics, robot, max_frames, hazards, severity)[0]


SketchCommand = (
    Annotated[int, tyro.conf.subcommand(name="fit", constructor=fit)]
    | Annotated[int, tyro.conf.subcommand(name="check", constructor=check)]
    | Annotated[int, tyro.conf.subcommand(name="speed", constructor=speed)]
)
