"""Walk to a thing, take it and put it into the bag, from pictures: one policy walks, another takes.

    hazard-ms demos record -e HazardFetch-v1 --load hazard_ms.tasks.practice -a oracle \\
        --obs rgb --cameras head+wrist --perturb control:2 -n 600 -o demos
    python examples/fetch_from_pictures.py walk demos/HazardFetch-v1/oracle --minutes 30 --out learned/walk
    python examples/fetch_from_pictures.py take demos/HazardFetch-v1/oracle --out learned/take
    python examples/fetch_from_pictures.py play learned/walk learned/take --episodes 25

Both are those of `act_from_pictures.py`. The one that walks sees all that is before it at the full resolution of its
camera, in which a thing 4 m away is three pixels wide. Beside what it sends it foresees whether it has arrived, and
where the thing then is before it: of the latter only its teacher knows, and nothing acts on it, but who foresees it
learns sooner what to look for. While it is shown how, its base slips now and then, or it would never see a thing beside
its way and turn back to it. Its teacher knows where a thing is that nobody sees: where it is not in the picture, the
policy is shown to turn left. It does not feel its joints, from which it would tell how a walk goes on without a look
at the picture. The one that takes begins where the walk ends. If nothing is in the hand after TAKES tenths of a second,
the other one turns to a side and walks again.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import act_from_pictures as act
import numpy as np
import torch
import tyro

WALK = "walk to "  # how a walk's subtask begins
VIEWS = ["far", "head"]  # of the policy that walks
LOOKS = 2  # actions of a walk that are carried out before it looks again
AFTER = 3  # pictures after a walk that show that it has arrived
TAKES = 45  # tenths of a second in which something must be in the hand; 99 % of demonstrations need less than 30
AWAY = 6  # tenths of a second in which it turns left then, by about 100 degrees
ARRIVED, MORE, TURN = -3, 3, -4  # where it foresees whether it has arrived; numbers beside an action; where it turns
EDGE, SEARCHES = np.pi / 3, 3  # where pictures end to the left and right [rad]; see `walk`
DRIVE = 2  # the last numbers of an action: forward, turn


def arrival(one: Any) -> int:
    """The first frame of a demonstration after its first walk."""
    words = np.array([text.startswith(WALK) for text in one.meta["subtasks"]])
    walking = words[one.frames["subtask"]]
    return int(np.argmin(walking)) if walking[0] else 0


def walk(one: Any) -> act.Rows:
    """The rows of a demonstration's walk and AFTER rows behind it, and the same in a mirror, with what is seen alone.

    Sent are the actions of the walk, then nothing for the base; whether it has arrived; and the place of the thing
    before the robot, forward and left [m]. Where it is not in the picture, in rows that are there SEARCHES times, it
    turns left.
    """
    every, end = one.meta["every"], arrival(one)
    last, actions = -(-end // every), act.sent(one)
    taken = int(np.argmax(one.frames["held"] >= 0))
    x, y, heading = one.frames["base"][: (last + AFTER) * every : every].T
    east, north = one.frames["hand"][taken, :2, None] - np.stack([x, y])
    forward, left = (np.cos(heading) * a + np.sin(heading) * b for a, b in ((east, north), (north, -east)))
    sent = np.concatenate([actions[:last], np.repeat(actions[last - 1 : last], len(x) - last, 0)])
    sent[last:, -DRIVE:] = 0.0
    rows = act.rows_of(one, VIEWS, np.column_stack([sent, np.arange(len(x)) >= last, forward, left]), slice(len(x)))
    chunks = torch.cat([rows.chunks, rows.chunks * torch.tensor([*[1.0] * (sent.shape[1] - 1), -1.0, 1.0, 1.0, -1.0])])
    hidden = torch.from_numpy(np.abs(np.arctan2(left, forward)) > EDGE).repeat(2)
    chunks[hidden, :, TURN - 1 : TURN + 1] = torch.tensor([0.0, 1.0])
    picked = torch.arange(len(hidden)).repeat_interleave(torch.where(hidden, SEARCHES, 1))
    pictures = [torch.cat([view, view.flip(-1)])[picked] for view in rows.pictures]
    return act.Rows(pictures, rows.body[:, -1:].repeat(2, 1)[picked], chunks[picked])


def take(one: Any) -> act.Rows:
    """The rows of a demonstration after its walk."""
    first = -(-arrival(one) // one.meta["every"]) if one.result.env_id.startswith("HazardFetch") else 0
    return act.rows_of(one, [*one.films], act.sent(one), slice(first, None))


def train_walk(folders: list[Path], /, *, out: Path, minutes: float = 30.0, seed: int = 0) -> None:
    """Train the policy that walks, for some minutes, on the datasets in `folders`, and write it."""
    every = [one for one in act.read(folders) if arrival(one)]
    act.learn(every[0], VIEWS, [walk(one) for one in every], out, minutes, seed)


def train_take(folders: list[Path], /, *, out: Path, minutes: float = 30.0, seed: int = 0) -> None:
    """Train the policy that takes and stows, for some minutes, on the datasets in `folders`, and write it."""
    every = act.read(folders)
    act.learn(every[0], [*every[0].films], [take(one) for one in every], out, minutes, seed)


class Fetching:
    """Who walks until it has arrived, and then takes; without success it walks again."""

    def __init__(self, walks: Path, takes: Path) -> None:
        self.walker, self.taker = act.Policy(walks), act.Policy(takes)
        self.since: int | None = None  # the step since which it takes
        self.until = 0  # the step until which it turns away from where it took nothing

    def coming(self, seen: dict[str, Any], steps: int) -> np.ndarray:
        """The actions to carry out before it is asked again, [K, A], after `steps` of an episode."""
        if steps == 0:
            self.since, self.until = None, 0
        if self.since is not None and steps - self.since >= TAKES and not seen["agent_pos"][-1]:
            self.since, self.until = None, steps + AWAY
        if self.since is None:
            foreseen = self.walker.act(seen)
            if steps < self.until:
                foreseen[:, TURN - 1 : ARRIVED + 1] = 0.0, 1.0, 0.0
            on_the_way = int((foreseen[:, ARRIVED] < 0.5).cumprod().sum())
            if on_the_way:
                return foreseen[: min(on_the_way, LOOKS), :-MORE]
            self.since = steps
        return self.taker.act(seen)[: act.CARRIED]


def play(
    walks: Path, takes: Path, /, *, episodes: int = 25, seed: int = 0, split: str = "test", hazards: act.Names = ()
) -> list[bool]:
    """Play episodes with both policies, beside hazards such as fire. Returns which of them succeeded."""
    who = Fetching(walks, takes)
    return act.run(who.walker.env(split, hazards), who.coming, range(seed, seed + episodes))


if __name__ == "__main__":
    commands = {"walk": train_walk, "take": train_take, "play": play}
    tyro.extras.subcommand_cli_from_dict(commands, description=__doc__)
