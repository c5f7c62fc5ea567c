"""The commands `hazard-ms play` and `hazard-ms evaluate`; each imports what it needs when it is called."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import tyro

from hazard_ms.evaluation.options import EpisodeOptions, PlayOptions, SweepOptions


def play(options: Annotated[tyro.conf.OmitArgPrefixes[PlayOptions], tyro.conf.arg(name="")]) -> int:
    """Play one episode of one agent; with --output, write its film, its result as JSON and its page."""
    from hazard_ms.agents.base import user_path
    from hazard_ms.evaluation.runner import play as run
    from hazard_ms.evaluation.runner import summary
    from hazard_ms.evaluation.watchers import Progress

    user_path()
    options.check()
    if options.output is None:
        print(summary(run(options.episode, [Progress(options.episode.agent)])))
        return 0
    print(_filmed(options.episode, options.output, options.every))
    for suffix, what in ((".mp4", "video"), (".json", "result"), (".html", "page")):
        print(f"{what}: {options.output.with_suffix(suffix).resolve()}")
    return 0


def _filmed(episode: EpisodeOptions, path: Path, every: int) -> str:
    """Play and film the episode, and write its result and page beside the film. Returns the summary."""
    from hazard_ms.evaluation.page import write_page
    from hazard_ms.evaluation.runner import play as run
    from hazard_ms.evaluation.runner import summary
    from hazard_ms.evaluation.watchers import Progress
    from hazard_ms.pictures.compositor import RENDERED
    from hazard_ms.pictures.film import Film

    camera = {"width": RENDERED[0], "height": RENDERED[1]}
    subtitle = f"agent {episode.agent}, seed {episode.seed}, {episode.physics} physics"
    with Film(path, subtitle, every) as film:
        watchers = [Progress(episode.agent), film]
        result = run(episode, watchers, render_mode="rgb_array", human_render_camera_configs=camera)
    result.write(path.with_suffix(".json"))
    write_page(path.with_suffix(".html"), result, path)
    return summary(result)


def evaluate(options: Annotated[tyro.conf.OmitArgPrefixes[SweepOptions], tyro.conf.arg(name="")]) -> int:
    """Play agents on the scenes of a split; print the scores with 95 % intervals.

    Resumes an interrupted run: episodes whose files are there are not played again.
    """
    from hazard_ms.agents.base import user_path
    from hazard_ms.evaluation.sweep import evaluate as run

    user_path()
    return run(options)
