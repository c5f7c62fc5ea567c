"""Lines of the table of splits: means over scenes that all agents have played, and nothing of any others."""

from __future__ import annotations

from typing import Any

from results.splits import AGENTS, line

CHOSEN = ("hall/00", "hall/01")


def rows(**values: tuple[float, ...]) -> list[dict[str, Any]]:
    """The rows of agents with these Values, one in each of CHOSEN; numbers as text, as in the file."""
    return [
        {"agent": agent, "scene": scene, "seed": str(seed), "value": str(value)}
        for agent, own in values.items()
        for seed, (scene, value) in enumerate(zip(CHOSEN, own, strict=False))
    ]


def test_a_line_holds_means_and_paired_differences() -> None:
    """Values of 0.6 and 0.4 have resampled means of 0.4 to 0.6; the differences from greedy are 0.1 in both scenes."""
    made = rows(planner=(0.6, 0.4), greedy=(0.5, 0.3), mcts=(0.6, 0.2))
    other = [{"agent": agent, "scene": "park/00", "seed": "0", "value": "1"} for agent in AGENTS]
    cells = [cell.strip() for cell in line("fire", "hard", [*made, *other], CHOSEN).strip("| \n").split("|")]
    assert cells[:4] == ["fire", "hard", "2", "50.0 [40.0, 60.0]"]
    assert cells[6:] == ["10.0 [10.0, 10.0]", "10.0 [0.0, 20.0]"]


def test_splits_that_not_all_have_played_have_no_line() -> None:
    assert line("fire", "hard", rows(planner=(0.6, 0.4), greedy=(0.5, 0.3), mcts=(0.6,)), CHOSEN) == ""
    assert line("wind", "large", [], ()) == ""
