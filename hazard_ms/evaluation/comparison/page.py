"""The page of a comparison: tables, charts, and links to the page and the film of each episode."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from markupsafe import Markup

from hazard_ms.evaluation import page as episode_page
from hazard_ms.evaluation.comparison import charts, curves, losses
from hazard_ms.evaluation.comparison.folders import Group, Kept
from hazard_ms.evaluation.comparison.summary import interval
from hazard_ms.spec.storage.files import make_folder, write

TEMPLATE = Path(__file__).with_name("comparison.html")
OTHER_VERB = "#c8ced8"  # colour of a verb that is not one of ours


def page(
    found: Sequence[Group],
    summaries: Sequence[dict[str, Any]],
    pages: Mapping[Path, Path],
    output: Path,
    left_out: Sequence[str] = (),
) -> str:
    """The page of groups of results with their `summaries`, HTML, to be written to `output`.

    `pages`: where the page of the episode of each result's file is; `left_out`: a line for each file that was not read.
    """
    origins = Counter(_origin(kept) for group in found for made in group.agents.values() for kept in made.values())
    return episode_page.rendered(
        TEMPLATE,
        groups=[_shown(group, made, pages, output) for group, made in zip(found, summaries, strict=True)],
        interval=interval,
        fates=charts.FATE_COLOURS,
        outcomes=curves.OUTCOMES,
        origins=origins.most_common(),
        left_out=left_out,
    )


def episode_pages(found: Sequence[Group], output: Path) -> dict[Path, Path]:
    """The page of each episode, by its result's file, in a new folder beside `output`.

    Pages beside results are not used: whoever made the results may have made them, scripts included. Raises ValueError
    where a page cannot be written.
    """
    folder, made, taken = output.with_name(f"{output.stem}_episodes"), dict[Path, Path](), set[str]()
    for kept in (kept for group in found for own in group.agents.values() for kept in own.values()):
        beside = kept.path.with_suffix(".html")
        name, number = beside.name, 2
        while name in taken:
            name, number = f"{beside.stem}-{number}.html", number + 1
        taken.add(name)
        make_folder(folder)
        write(
            folder / name,
            episode_page.page(kept.result, episode_page.link(kept.path.with_suffix(".mp4"), folder / name)),
        )
        made[kept.path] = folder / name
    return made


def _shown(group: Group, summary: dict[str, Any], pages: Mapping[Path, Path], output: Path) -> dict[str, Any]:
    """What the template shows of a group, besides its summary."""
    results = {agent: [kept.result for kept in made.values()] for agent, made in group.agents.items()}
    frames = curves.times(group.max_frames)
    values = {agent: curves.value_curve(own, frames) for agent, own in results.items()}
    verbs = sorted({verb for row in summary["agents"].values() for verb in row["skills"]})
    colours = {verb: episode_page.COLOURS.get(verb, OTHER_VERB) for verb in verbs}
    rows = summary["agents"]
    phases = list(dict.fromkeys(phase for row in rows.values() for phase in row["seconds_per_episode"]))
    shades = {phase: charts.colour(k) for k, phase in enumerate(phases)}
    seconds = {
        agent: [(f"{p}: {s:.1f} s an episode", s, shades[p], 1.0) for p, s in row["seconds_per_episode"].items()]
        for agent, row in rows.items()
    }
    lost = {agent: row["lost"] for agent, row in rows.items() if "lost" in row}
    return summary | {
        "env_id": group.results[0].env_id,
        "with_regret": any("regret" in row for row in rows.values()),
        "with_averted": any("averted" in row for row in rows.values()),
        "colours": {agent: charts.colour(k) for k, agent in enumerate(group.agents)},
        "apart": {(d["agent"], d["other"]): d["value"] for d in summary["differences"]},
        "averted_apart": {(d["agent"], d["other"]): d["averted"] for d in summary["differences"]},
        "value_chart": Markup(charts.lines(values, frames)),
        "fate_charts": {a: Markup(charts.areas(curves.fate_curves(own, frames), frames)) for a, own in results.items()},
        "verbs": colours,
        "skill_chart": Markup(charts.bars({a: _pieces(row, colours) for a, row in rows.items()}, "frames")),
        "phases": shades,
        "wall_chart": Markup(charts.bars(seconds, "s")),
        "lost": lost,
        "loss_chart": Markup(charts.bars({a: losses.pieces(row) for a, row in lost.items()}, "%")) if lost else "",
        "loss_parts": {part: (losses.named(part), fill) for part, fill in losses.COLOURS.items()},
        "loss_links": {file.name: episode_page.link(where, output) for file, where in pages.items()},
        "rows": [_row(group, seed, scene, pages, output) for seed, scene in group.episodes],
    }


def _pieces(row: dict[str, Any], colours: Mapping[str, str]) -> list[tuple[str, float, str, float]]:
    """Frames per episode by verb and outcome, as the pieces of a bar."""
    return [
        (
            f"{verb.replace('_', ' ')}, {outcome}: {part['frames'] / row['episodes']:.0f} frames an episode",
            part["frames"] / row["episodes"],
            colours[verb],
            charts.OPACITY[outcome],
        )
        for verb, outcomes in row["skills"].items()
        for outcome, part in outcomes.items()
        if part["tries"]
    ]


def _row(group: Group, seed: int, scene: str, pages: Mapping[Path, Path], output: Path) -> dict[str, Any]:
    """One episode: the Value of each agent, with links; None where it did not play."""
    cells: list[dict[str, Any] | None] = []
    for made in group.agents.values():
        kept = made.get((seed, scene))
        if kept is None:
            cells.append(None)
            continue
        where = pages.get(kept.path)
        links = {
            "page": where and episode_page.link(where, output),
            "film": episode_page.link(kept.path.with_suffix(".mp4"), output),
        }
        cells.append({"value": kept.result.tally.value, **links})
    return {"seed": seed, "scene": scene, "cells": cells}


def _origin(kept: Kept) -> str:
    """Version of the package and kind of machine of a result."""
    machine = ", ".join(f"{name} {value}" for name, value in kept.result.machine.items() if value is not None)
    return f"hazard-ms {kept.result.versions.get('hazard-ms', 'of an unknown version')} on {machine}"
