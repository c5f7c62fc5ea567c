"""Walk to a thing, take it and put it into the bag, from pictures: one policy walks, another takes.

    hazard-ms demos record -e HazardFetch-v1 --load hazard_ms.tasks.practice -a oracle \\
        --obs rgb --cameras head+wrist --perturb control:2 -n 600 -o demos
    python examples/fetch_from_pictures.py walk demos/HazardFetch-v1/oracle --minutes 30 --out learned/walk
    python examples/fetch_from_pictures.py take demos/HazardFetch-v1/oracle --out learned/take
    python examples/fetch_from_pictures.py play learned/walk learned/take --episodes 25

Both are those of `act_from_pictures.py`. The one that walks sees all that is before it at the full resolution of its
camera, in which a thing 4 m away is three pixels wide, and feels how fast it turns, so that it goes on looking around.
Beside what it sends it foresees whether it has arrived, and where the thing then is before it: of the latter only its
teacher knows, and nothing acts on it, but who foresees it learns sooner what to look for. While it is shown how, its
base slips now and then, or it would never see a thing beside its way and turn back to it. The one that takes begins
where it has arrived. If nothing is in the hand after TAKES tenths of a second, the other one walks again.
"""

from __future__ import annotations

import argparse
import importlib
from pathlib import Path
from typing import Any

import act_from_pictures as act
import gymnasium as gym
import numpy as np

from hazard_ms.demonstrations.reading import demonstrations

WALK = "walk to "  # how a walk's subtask begins
VIEWS = ["far", "head"]  # of the policy that walks
LOOKS = 2  # actions of a walk that are carried out before it looks again
AFTER = 3  # pictures after a walk that show that it has arrived
TAKES = 45  # tenths of a second in which something must be in the hand; 99 % of demonstrations need less than 30
ARRIVED, MORE = -3, 3  # where it foresees whether it has arrived; numbers that it foresees beside actions
DRIVE = 2  # the last numbers of an action: forward, turn


def arrival(one: Any) -> int:
    """The first frame of a demonstration after its first walk."""
    words = np.array([text.startswith(WALK) for text in one.meta["subtasks"]])
    walking = words[one.frames["subtask"]]
    return int(np.argmin(walking)) if walking[0] else 0


def walk(one: Any) -> act.Rows:
    """The rows of a demonstration's walk, and AFTER rows behind it.

    Sent are the actions of the walk, then nothing for the base; whether it has arrived; and the place of the thing
    before the robot, forward and left [m].
    """
    every, end = one.meta["every"], arrival(one)
    last, actions = -(-end // every), act.sent(one)
    taken = int(np.argmax(one.frames["held"] >= 0))
    x, y, heading = one.frames["base"][: (last + AFTER) * every : every].T
    right, up = one.frames["hand"][taken, :2, None] - np.stack([x, y])
    thing = np.column_stack(
        [np.cos(heading) * right + np.sin(heading) * up, np.cos(heading) * up - np.sin(heading) * right]
    )
    sent = np.concatenate([actions[:last], np.repeat(actions[last - 1 : last], len(x) - last, 0)])
    sent[last:, -DRIVE:] = 0.0
    told = np.column_stack([sent, np.arange(len(x)) >= last, thing])
    return act.rows_of(one, VIEWS, True, told, slice(len(x)))


def take(one: Any) -> act.Rows:
    """The rows of a demonstration after its walk."""
    first = -(-arrival(one) // one.meta["every"]) if one.result.env_id.startswith("HazardFetch") else 0
    return act.rows_of(one, [*one.films], False, act.sent(one), slice(first, None))


def train(part: str, folders: list[Path], minutes: float, out: Path, seed: int) -> None:
    """Train one of the policies on the datasets in `folders`."""
    every = [one for folder in folders for one in demonstrations(folder)]
    made = [walk(one) for one in every if arrival(one)] if part == "walk" else [take(one) for one in every]
    views = VIEWS if part == "walk" else [*every[0].films]
    act.learn(act.together(made), act.settings_of(every[0], views, part == "walk"), minutes, out, seed)


def play(walks: Path, takes: Path, episodes: int, seed: int, split: str, hazards: list[str]) -> list[bool]:
    """Play episodes of HazardFetch-v1 with both policies. Returns which of them succeeded."""
    importlib.import_module(act.PRACTICE)
    walker, taker = act.Policy(walks), act.Policy(takes)
    made = {**walker.settings["env"], "split": split, "render_mode": None, **({"hazards": hazards} if hazards else {})}
    env: Any = gym.make("hazard_ms.lerobot:HazardRobot-v1", **made)
    succeeded = []
    for number in range(seed, seed + episodes):
        (seen, _), over, steps, since, info = env.reset(seed=number), False, 0, None, {}  # since when it takes
        while not over:
            if since is None or (steps - since >= TAKES and not seen["agent_pos"][-1]):
                coming = walker.act(seen)[:LOOKS]
                on_the_way = coming[:, ARRIVED] < 0.5
                since = None if on_the_way[0] else steps
                actions = coming[: max(1, int(on_the_way.cumprod().sum())), :-MORE]
            else:
                actions = taker.act(seen)[: act.CARRIED]
            for action in actions:
                if not over:
                    seen, _, terminated, truncated, info = env.step(action)
                    steps, over = steps + 1, terminated or truncated
        succeeded.append(info["is_success"])
        print(f"seed {number}: {'success' if succeeded[-1] else 'failed'} after {steps} steps", flush=True)
    env.close()
    print(f"{sum(succeeded)} of {episodes} succeeded, {100 * np.mean(succeeded):.0f} %, {split}, {hazards or 'calm'}")
    return succeeded


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(required=True)
    for part in ("walk", "take"):
        (one := commands.add_parser(part)).set_defaults(do=train, part=part)
        one.add_argument("folders", type=Path, nargs="+")
        one.add_argument("--minutes", type=float, default=30.0)
        one.add_argument("--out", type=Path, required=True)
        one.add_argument("--seed", type=int, default=0)
    (two := commands.add_parser("play")).set_defaults(do=play)
    two.add_argument("walks", type=Path)
    two.add_argument("takes", type=Path)
    two.add_argument("--episodes", type=int, default=25)
    two.add_argument("--seed", type=int, default=0)
    two.add_argument("--split", default="test")
    two.add_argument("--hazards", nargs="*", default=[])
    given = vars(parser.parse_args())
    given.pop("do")(**given)


if __name__ == "__main__":
    main()
