"""The curve of PPO that learns to pick things up: `./run python results/ppo_pick_up.py` draws docs/ppo_pick_up.svg.

ppo_pick_up.csv beside this file is what `examples/ppo_low_level.py --task pick_up --minutes 60` has written.
"""

from __future__ import annotations

import csv
from pathlib import Path

HERE = Path(__file__).parent
CURVE = HERE / "ppo_pick_up.csv"
CHART = HERE.parent / "docs" / "ppo_pick_up.svg"


def main() -> None:
    """Draw the share of successes over frames, and print where it ended."""
    import matplotlib

    matplotlib.use("svg")
    matplotlib.rcParams.update({"svg.hashsalt": "ppo_pick_up", "font.size": 11})
    from matplotlib import pyplot

    with CURVE.open(encoding="utf-8") as file:
        rows = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]
    figure, ax = pyplot.subplots(figsize=(6.0, 3.2))
    ax.plot([row["frames"] / 1000.0 for row in rows], [100.0 * row["success"] for row in rows])
    ax.set(xlabel="frames, thousands", ylabel="success of the last 100 [%]", ylim=(0, 102), xlim=(0, None))
    ax.grid(alpha=0.3)
    figure.tight_layout()
    figure.savefig(CHART, metadata={"Date": None})
    last = rows[-1]
    print(
        f"{last['frames']:,.0f} frames in {last['minutes']:.0f} minutes: success {last['success']:.1%} of the last 100"
    )


if __name__ == "__main__":
    main()
