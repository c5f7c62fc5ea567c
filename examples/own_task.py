"""A task with another goal, from outside the package: keep what water ruins dry until help comes after 20 seconds.

python examples/own_task.py --video dry.mp4
"""

from dataclasses import replace
from sys import argv

from torch import Tensor

import hazard_ms
from hazard_ms import CATEGORIES, Goal, SceneSpec, Situation, Task, Term, hazard, rescue

HELP = 600  # frame at which help comes
ENOUGH = 0.5  # share of the targets that must be dry then


def dry(situation: Situation) -> Tensor:
    """Share of the targets that the water has not ruined, in the bag or not, [E]."""
    target, ruined = situation.world.target, situation.episode.damage.damaged
    return (target & ~ruined).sum(1) / target.sum(1).clamp(min=1)


def scene(name: str) -> SceneSpec:
    """The scene of this name, in which everything precious that water ruins is a target."""
    spoilt = {c.name for c in CATEGORIES.values() if c.value > 1 and not c.waterproof}
    made = rescue([]).build(name)
    return replace(made, target_categories=tuple(sorted(spoilt & {b.category for b in made.bodies})))


def keep_dry(physics: str) -> Task:
    """The rescue from a flood with other targets and another goal; the bag is a dry place."""
    plain = rescue([hazard("flood", physics)])
    goal = Goal(
        success=lambda s: (s.world.frame >= HELP) & (dry(s) >= ENOUGH),
        fail=lambda s: dry(s) < ENOUGH,
        sparse=lambda s: (s.world.frame == HELP) * dry(s),
        dense=lambda s: (s.world.frame == HELP) * dry(s) + plain.goal.dense(s),
        largest=1.0 + plain.goal.largest,
        info=(Term("dry", dry, "share of the targets that are dry", low=0.0, high=1.0),),
        done="help came",
    )
    text = f"Keep the targets dry until frame {HELP}: what is in your bag stays dry."
    return replace(plain, build=scene, goal=goal, text=text)


if __name__ == "__main__":
    raise SystemExit(hazard_ms.main(["play", "--load", __file__, "-e", "HazardKeepDry-v1", *argv[1:]]))

hazard_ms.register_task("HazardKeepDry-v1", keep_dry, max_frames=HELP)
