"""Measures the frames that mitigations take in a test home: a door shut, an extinguisher fetched, fires fought.

    ./run python results/mitigations.py [SEED [FRAME]]
    ./run python results/mitigations.py doors [HOMES]

The first prints one line for each action: its frames, the flames and burning things before and after it, and the frames
of jet that are left. The fires are fought from FRAME on, by default 400. The second shuts the three doors nearest to
the robot in each of the first HOMES of `train`, by default 8, each from the start of an episode, and prints the frames
that it takes beyond the planned way.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence

import numpy as np

from hazard_ms.agents.mitigating import prospects
from hazard_ms.agents.mitigating.doing import Mitigator
from hazard_ms.agents.mitigating.prospects import Prospect
from hazard_ms.agents.truth import Truth
from hazard_ms.sketch.futures.surroundings import charge_of
from hazard_ms.sketch.rescue_problem import RescueScene
from hazard_ms.skills.actions import wait
from hazard_ms.skills.decision import Action, Decision
from hazard_ms.skills.executor import SkillEnv

TASK, SIZE = "HazardHouseFire-v1", 128  # and the edge of the pictures [pixels]
NEAREST, HOMES = 3, 8  # doors that are shut in a home, and homes


class Probe:
    """Does one measure after another in a home, and prints what each takes."""

    def __init__(self, seed: int, split: str = "test") -> None:
        camera = {"width": SIZE, "height": SIZE}
        self.env = SkillEnv.make(TASK, split=split, sensor_configs=camera, effects="off")
        self.begin(seed)

    def begin(self, seed: int) -> None:
        """Begin the episode of a seed anew."""
        self.decision: Decision = self.env.reset(seed=seed)[0]
        brief, base = self.env.brief(), self.env.base
        truth = Truth(self.env, False)
        truth.furnish(self.decision)
        truth.reveal()
        self.mitigator = Mitigator(truth, brief)
        self.scene = RescueScene(base.specs[0], brief.robot, base.agent.build.radius, brief.max_frames)

    def way(self, to: Prospect) -> float:
        """Frames of the way from the robot to a measure."""
        return float(self.scene.ways.frames(np.array(self.decision.agent_position), to.first, edge=to.edge))

    def do(self, what: Prospect) -> None:
        """Do a measure to its end, and print what its actions came to."""
        print(f"{what.kind} {what.numbers}, {self.way(what):.0f} frames away:")
        self.mitigator.begin([what], self.scene)
        while (action := self.mitigator.next(self.decision)) is not None:
            self.step(action)
            if self.env.frame >= self.env.max_frames:
                return

    def step(self, action: Action) -> None:
        """Do an action and print what it came to."""
        before = self._burning()
        self.decision, *_, info = self.env.step(action)
        held, result = self.env.stage.held, info["result"]
        left = charge_of(self.env.base, held) if held >= 0 else 0.0
        what = f"{result.frames} frames {result.reason}, burning {before} to {self._burning()}, jet left {left:.0f}"
        print(f"  frame {self.decision.frame}: {action} {what}", flush=True)

    def _burning(self) -> dict[int, int]:
        return {seat.number: seat.burning for seat in prospects.seats_of(self.env.base)}


def shut_doors(homes: int) -> None:
    """Shut doors in so many homes of `train`, and print the frames that each takes beyond the way to it."""
    probe, beyond, tried = Probe(0, "train"), list[float](), 0
    for seed in range(homes):
        for number in range(NEAREST):
            probe.begin(seed)
            base, here = probe.env.base, np.array(probe.decision.agent_position)
            doors = prospects.doors(base, here[None])
            if number >= len(doors):
                break
            way, tried = probe.way(doors[number]), tried + 1
            probe.do(doors[number])
            if float(base.world.openings.share[0, doors[number].numbers[0]]) <= 0.0:
                beyond.append(probe.env.frame - way)
    mean = f", on average {np.mean(beyond):.0f} frames beyond the way to them" if beyond else ""
    print(f"{len(beyond)} of {tried} doors in {homes} homes were shut{mean}")
    probe.env.close()


def main(arguments: Sequence[str]) -> None:
    """Measure what the arguments name, by default a door and fires in home 0. Raises ValueError for no number."""
    if arguments[:1] == ["doors"]:
        shut_doors(int(arguments[1]) if len(arguments) > 1 else HOMES)
        return
    seed, start = int(arguments[0]) if arguments else 0, int(arguments[1]) if len(arguments) > 1 else 400
    probe = Probe(seed)
    env, here = probe.env, np.array(probe.decision.agent_position)
    probe.do(prospects.doors(env.base, here[None])[0])
    env.run(wait(env.stage, max(0, start - env.frame)))
    env.look()
    probe.decision = env.decision()
    probe.do(min(prospects.tools_of(env.base, probe.scene), key=probe.way))
    here = np.array(probe.decision.agent_position)
    for fight in prospects.fights(
        env.base, probe.scene, np.array([s.place for s in prospects.seats_of(env.base)]), here
    )[:2]:
        probe.do(fight)
    if env.stage.held >= 0 and env.frame < env.max_frames:
        probe.step(Action("drop"))
    env.close()


if __name__ == "__main__":
    main(sys.argv[1:])
