"""The numbers of the page: what was played in chosen folders, and the scores, curves and episodes of one group."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Any

from hazard_ms.cli.web.compare.shelf import Book, Shelf, film_of
from hazard_ms.evaluation.choices import HUMAN
from hazard_ms.evaluation.comparison import curves
from hazard_ms.evaluation.comparison.folders import Group, grouped, title
from hazard_ms.evaluation.comparison.summary import summary

MOST_AGENTS = 20  # of a group; each is compared with each other [ours]
MOST_EPISODES = 1_000  # of an agent in a group [ours]
MOST_REFUSED = 200  # files that the page lists [ours]
DIGITS = 4  # of the shares of curves [ours]


def is_person(agent: str) -> bool:
    """Whether the agent of a result is a person."""
    return agent.partition(":")[0] == HUMAN


def overview(shelf: Shelf) -> dict[str, Any]:
    """All folders with their settings, and the files that cannot be shown, as plain data."""
    titles: dict[str, Counter[str]] = {key: Counter() for key in shelf.folders}
    agents: dict[str, set[str]] = {key: set() for key in shelf.folders}
    for book in shelf.books.values():
        titles[book.folder][title(book.kept.result)] += 1
        agents[book.folder].add(book.kept.result.agent)
    return {
        "folders": [
            {
                "key": key,
                "name": name,
                "results": titles[key].total(),
                "settings": [settings for settings, _ in titles[key].most_common()],
                "agents": _agents(sorted(agents[key])),
            }
            for key, name in shelf.folders.items()
        ],
        "refused": [{"name": each.name, "reason": each.reason} for each in shelf.refused[:MOST_REFUSED]],
        "refused_count": len(shelf.refused),
    }


def contents(books: Sequence[Book]) -> list[dict[str, Any]]:
    """The groups among results: their settings, agents and number of results, as plain data."""
    found: dict[str, list[Book]] = {}
    for book in books:
        found.setdefault(title(book.kept.result), []).append(book)
    return [
        {
            "settings": name,
            "results": len(own),
            "agents": _agents(sorted({book.kept.result.agent for book in own})),
        }
        for name, own in sorted(found.items())
    ]


def numbers(settings: str, books: Sequence[Book]) -> dict[str, Any]:
    """Everything about the group with these settings among `books`, as plain data.

    "agents", "differences" and "settings" are those of `summary`; "values" and "fates" are curves over "frames", and
    "rows" are the episodes with what each agent made of them. Raises ValueError where nothing has these settings.
    """
    own, left_out = _bounded([book for book in books if title(book.kept.result) == settings])
    if not own:
        raise ValueError(f"settings must be those of a result in the chosen folders, got {settings!r:.100}")
    (group,) = grouped(book.kept for book in own)
    keys = {book.kept.path: book.key for book in own}
    frames = curves.times(group.max_frames)
    results = {agent: [kept.result for kept in made.values()] for agent, made in group.agents.items()}
    return summary(group) | {
        "people": [agent for agent in group.agents if is_person(agent)],
        "frames": frames.tolist(),
        "values": {agent: _rounded(curves.value_curve(made, frames)) for agent, made in results.items()},
        "fates": {
            agent: {name: _rounded(curve) for name, curve in curves.fate_curves(made, frames).items()}
            for agent, made in results.items()
        },
        "rows": [_row(group, seed, scene, keys) for seed, scene in group.episodes],
        "left_out": [{"name": name, "reason": reason} for name, reason in left_out[:MOST_REFUSED]],
        "left_out_count": len(left_out),
    }


def _bounded(books: Sequence[Book]) -> tuple[list[Book], list[tuple[str, str]]]:
    """Results of which each is another episode, or another agent's, and the names of all others with the reason."""
    counts = Counter(book.kept.result.agent for book in books)
    shown = {agent for agent, _ in sorted(counts.items(), key=lambda item: (-item[1], item[0]))[:MOST_AGENTS]}
    made: dict[tuple[str, int, str], Book] = {}
    own, left_out = Counter[str](), []
    for book in books:
        result = book.kept.result
        name = (result.agent, *book.kept.episode)
        if result.agent not in shown:
            left_out.append((book.name, f"only the {MOST_AGENTS} agents with the most results are compared"))
        elif name in made:
            left_out.append((book.name, f"the same agent and episode as {made[name].name}, which counts"))
        elif own[result.agent] >= MOST_EPISODES:
            left_out.append((book.name, f"only {MOST_EPISODES} episodes of an agent are compared"))
        else:
            made[name] = book
            own[result.agent] += 1
    return list(made.values()), left_out


def _row(group: Group, seed: int, scene: str, keys: dict[Any, str]) -> dict[str, Any]:
    """One episode: for each agent that played it, by name, the key of its result, its Value and how it ended."""
    cells = {}
    for agent, made in group.agents.items():
        kept = made.get((seed, scene))
        if kept is not None:
            cells[agent] = {
                "key": keys[kept.path],
                "value": kept.result.tally.value,
                "ended": kept.result.ended,
                "film": film_of(kept) is not None,
                "judged": kept.regret is not None,
            }
    return {"seed": seed, "scene": scene, "cells": cells}


def _agents(names: Sequence[str]) -> list[dict[str, Any]]:
    return [{"name": name, "person": is_person(name)} for name in names[:MOST_AGENTS]]


def _rounded(curve: Any) -> list[float]:
    return [round(float(share), DIGITS) for share in curve]
