"""The curves of PPO that learns to walk and to pick up: `./run python results/ppo_low_level.py` draws them.

ppo_walk_to.csv and ppo_pick_up.csv beside this file are what `examples/ppo_low_level.py` wrote with `--task walk_to
--minutes 15` and with `--task pick_up --minutes 60`; the drawing is docs/ppo_low_level.svg.
"""

from __future__ import annotations

import csv
from pathlib import Path

HERE = Path(__file__).parent
CHART = HERE.parent / "docs" / "ppo_low_level.svg"
MOTIONS = ("walk_to", "pick_up")


def main() -> None:
    """Draw the shares of successes over frames, and print where they ended."""
    import matplotlib

    matplotlib.use("svg")
    matplotlib.rcParams.update({"svg.hashsalt": "ppo_low_level", "font.size": 11})
    from matplotlib import pyplot

    figure, ax = pyplot.subplots(figsize=(6.0, 3.2))
    for motion in MOTIONS:
        with (HERE / f"ppo_{motion}.csv").open(encoding="utf-8") as file:
            rows = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]
        ax.plot([row["frames"] / 1000.0 for row in rows], [100.0 * row["success"] for row in rows], label=motion)
        for share in (0.5, 0.9, 0.99):
            first = next((row for row in rows if row["success"] >= share), None)
            if first is not None:
                print(f"{motion}: {share:.0%} of the last 100 after {first['frames']:,.0f} frames")
        last = rows[-1]
        print(f"{motion}: {last['frames']:,.0f} frames in {last['minutes']:.0f} minutes: {last['success']:.1%}")
    ax.set(xlabel="frames, thousands", ylabel="success of the last 100 [%]", ylim=(0, 102), xlim=(0, None))
    ax.grid(alpha=0.3)
    ax.legend(frameon=False)
    figure.tight_layout()
    figure.savefig(CHART, metadata={"Date": None})


if __name__ == "__main__":
    main()
