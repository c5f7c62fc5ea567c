"""The commands `hazard-ms play`, `evaluate`, `replay` and `serve`; each imports what it needs when it is called."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import tyro

from hazard_ms.cli.web.options import ServeOptions
from hazard_ms.evaluation.choices import HUMAN
from hazard_ms.evaluation.options import EpisodeOptions, PlayOptions, ReplayOptions, SweepOptions

if TYPE_CHECKING:
    from hazard_ms.evaluation.result import EpisodeResult
    from hazard_ms.evaluation.watchers import Watcher

SUFFIXES = {".mp4": "video", ".json": "result", ".html": "page"}  # of the files of an episode


def play(options: Annotated[tyro.conf.OmitArgPrefixes[PlayOptions], tyro.conf.arg(name="")]) -> int:
    """Play one episode of one agent; with --output, write its film, its result as JSON and its page.

    With --agent human, opens the page of `hazard-ms serve`, where you play.

    Exits with 1 if the simulation broke.

    Raises:
        ValueError: for an output whose name is too long.
    """
    from hazard_ms.agents.base import user_path
    from hazard_ms.evaluation.report import summary
    from hazard_ms.evaluation.result import BROKEN
    from hazard_ms.evaluation.sweep import LONGEST_NAME
    from hazard_ms.evaluation.watchers import Progress

    user_path()
    if options.episode.agent == HUMAN:
        print("You play on the page of `hazard-ms serve`, which starts now; choose the task and the seed there.")
        return serve(ServeOptions(load=options.episode.load))
    options.check()
    if options.output is not None and len(os.fsencode(options.output.with_suffix(".html").name)) > LONGEST_NAME:
        raise ValueError(
            f"output must have a name of at most {LONGEST_NAME - 1} bytes, got {options.output.name!r:.100}"
        )
    if options.output is None:
        result = _played(options.episode, [Progress(options.episode.agent)])
    else:
        result = _filmed(options.episode, options.output, options.every)
    print(summary(result, options.episode.goal))
    if options.output is not None:
        for suffix, what in SUFFIXES.items():
            print(f"{what}: {options.output.with_suffix(suffix).resolve()}")
    return int(result.ended == BROKEN)


def _played(episode: EpisodeOptions, watchers: Sequence[Watcher], **keywords: Any) -> EpisodeResult:
    """Play the episode, of one robot or of a team, in an environment made with `keywords` besides."""
    from hazard_ms.evaluation.runner import play as run
    from hazard_ms.evaluation.teams.player import play as run_team

    return (run_team if episode.team else run)(episode, watchers, **keywords)


def _filmed(episode: EpisodeOptions, path: Path, every: int) -> EpisodeResult:
    """Play and film the episode; its film, result and page appear together at its end."""
    from hazard_ms.evaluation.page import address, page
    from hazard_ms.evaluation.watchers import Progress
    from hazard_ms.pictures.compositor import RENDERED
    from hazard_ms.pictures.film import Film
    from hazard_ms.pictures.team_film import TeamFilm
    from hazard_ms.spec.storage.files import drafts, make_folder

    camera = {"width": RENDERED[0], "height": RENDERED[1]}
    subtitle = f"agent {episode.agent}, seed {episode.seed}, {' '.join([*episode.strength, episode.physics])} physics"
    make_folder(path.parent)
    with drafts(*(path.with_suffix(suffix) for suffix in SUFFIXES)) as (shot, told, shown):
        with (TeamFilm if episode.team else Film)(shot, subtitle, every) as film:
            watchers = [Progress(episode.agent), film]
            result = _played(episode, watchers, render_mode="rgb_array", human_render_camera_configs=camera)
        told.write(result.to_json())
        shown.write(page(result, address(shot.path, path.name)))
    return result


def evaluate(options: Annotated[tyro.conf.OmitArgPrefixes[SweepOptions], tyro.conf.arg(name="")]) -> int:
    """Play agents on the scenes of a split or a folder; print the scores with 95 % intervals.

    Resumes an interrupted run: finished episodes are not played again. Exits with 1 if a simulation broke, or an agent
    failed in an episode.
    """
    from hazard_ms.agents.base import user_path
    from hazard_ms.evaluation.sweep import evaluate as run

    user_path()
    return run(options)


def replay(options: Annotated[tyro.conf.OmitArgPrefixes[ReplayOptions], tyro.conf.arg(name="")]) -> int:
    """Simulate recorded episodes again by their decisions, in new processes, and compare with what was recorded.

    Prints `exact` if all hashes are equal, `same score` if every target has the same fate, as on another kind of
    processor, else `different`. Exits with 1 if an episode is different.
    """
    from hazard_ms.agents.base import user_path
    from hazard_ms.evaluation.replay import replay as run

    user_path()
    return run(options)


def serve(options: Annotated[tyro.conf.OmitArgPrefixes[ServeOptions], tyro.conf.arg(name="")]) -> int:
    """Serve a page to play, watch and compare rescues in a browser on this machine, and print its address.

    It needs `pip install hazard_ms[web]`. Only this machine can reach it, and only by the printed address.
    """
    from hazard_ms.agents.base import user_path
    from hazard_ms.cli.web.serving import serve as run

    user_path()
    return run(options)
