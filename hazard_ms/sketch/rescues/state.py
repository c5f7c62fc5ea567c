"""The state of N rescues at once, and the spread of the worlds that they are drawn from when agents train."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from hazard_ms.sketch.rescues.scene import Bools, Floats, Ints, Stack
from hazard_ms.spec.catalogue import DAMAGED_SHARE, MOST_VALUE
from hazard_ms.spec.checks import finite

VALUES = (1.0, 5.0)  # that a target can have (docs/benchmark.md 1)


@dataclass(frozen=True)
class Domain:
    """The spread of rescues around what was measured, by default none. Raises ValueError for impossible numbers."""

    pace: tuple[float, float] = (1.0, 1.0)  # least and greatest factor on all times, one for each episode
    ease: tuple[float, float] = (1.0, 1.0)  # least and greatest factor on the share of attempts that work
    missed: float = 0.0  # share of sightings that do not happen
    revalued: float = 0.0  # share of targets whose value is drawn anew
    # factors on the share of pick-ups that work after failures with the same target: at once, and after a walk
    again: tuple[float, float] = (1.0, 1.0)

    def __post_init__(self) -> None:
        for name in ("pace", "ease"):
            low, high = finite(getattr(self, name), 2, name)
            if not 0.0 < low <= high:
                raise ValueError(f"{name} must be positive numbers, the least first, got {(low, high)}")
        for name in ("missed", "revalued"):
            if not 0.0 <= getattr(self, name) <= 1.0:
                raise ValueError(f"{name} must be a share from 0 to 1, got {getattr(self, name)!r}")
        if not all(0.0 <= factor <= 1.0 for factor in finite(self.again, 2, "again")):
            raise ValueError(f"again must be shares from 0 to 1, got {self.again}")


AS_MEASURED = Domain()
# In recorded episodes 93 % of 2,028 first pick-ups worked, 26 % of 74 that followed a failure with the same target at
# once, and 69 % of 36 with other pick-ups in between: what was out of reach from one place mostly stays so.
AGAIN = (0.28, 0.75)
TRAINING = Domain((0.8, 1.3), (0.85, 1.0), 0.1, 0.3, AGAIN)  # wide enough to cover what the sketch leaves out [ours]


@dataclass
class Rescues:
    """N rescues, in scenes with T targets, C carts, L landmarks (J things in this order) and H hazards."""

    scene: Ints  # number of the scene in the stack, [N]
    frame: Ints  # [N]
    site: Ints  # the site that the robot has arrived at, [N]; -1: it is on the way
    place: Floats  # of the robot [m], [N, 2]
    stand: Ints  # the stand that is nearest to it, [N]
    heading: Floats  # [rad], [N]
    held: Ints  # the target in the hand, or -1, [N]
    missed: Ints  # the target that the robot failed to pick up from where it is, or -1, [N]
    goal: Ints  # the thing, out of J, that the robot wanders to, or -1, [N]; options do not use it
    value: Floats  # of each target, [N, T]; 0 where there is none
    rescued_at: Ints  # [frame], [N, T]; -1: not rescued
    spoiled: Bools  # whether a target was damaged when it was taken, [N, T]
    laid: Ints  # site where the robot lost a target, which then stays there, [N, T]; -1: it never did
    known: Bools  # whether each thing was seen, [N, J]
    seen_site: Ints  # where each target was last seen, [N, T]
    seen_frame: Ints  # of the last two sightings of each target, the newest first, [N, T, 2]; -1: none
    seen_level: Floats  # of each hazard at the target then, in its unit, [N, T, 2, H]
    seen_damaged: Bools  # whether a target was damaged when last seen, [N, T]
    failures: Ints  # failures with each target and cart, [N, T + C]
    visits: Ints  # searches at each landmark, [N, L]
    spots: NDArray[np.uint16]  # floor around each landmark that was seen, one bit each, [N, L]
    looked: Bools  # whether the robot has just looked around, [N]
    over: Bools  # [N]
    score: Floats  # value rescued so far as a share of all; with measures, what is averted so far: see Sketch, [N]
    pace: Floats  # factor on all times, [N]
    ease: Floats  # factor on the share of attempts that work, [N]
    out_at: Ints  # frame in which each fire was put out, [N, F]; -1: it burns
    fire_known: Bools  # whether each was seen, [N, F]
    fire_frame: Ints  # in which it was last seen, [N, F]
    fire_flames: Ints  # that it had then, [N, F]
    fire_failures: Ints  # to put it out, [N, F]
    armed: Ints  # the extinguisher in the hand, or -1, [N]
    tool_known: Bools  # whether each was seen, [N, E]
    tool_site: Ints  # where each is, [N, E]
    tool_left: Floats  # frames that each lasts, [N, E]
    tool_failures: Ints  # to pick each up, [N, E]

    @classmethod
    def allocate(cls, count: int, stack: Stack) -> Rescues:
        """Make N = `count` rescues in scenes of `stack`, all over until they are restarted."""
        targets, carts = stack.value.shape[1], stack.cart_site.shape[1]
        marks, hazards = stack.landmark_site.shape[1], stack.limit.shape[2]
        shapes: dict[str, tuple[int, ...]] = {
            "place": (2,),
            "known": (targets + carts + marks,),
            "seen_frame": (targets, 2),
            "seen_level": (targets, 2, hazards),
            "failures": (targets + carts,),
            "visits": (marks,),
            "spots": (marks,),
        }
        for name in ("out_at", "fire_known", "fire_frame", "fire_flames", "fire_failures"):
            shapes[name] = (stack.fire_site.shape[1],)
        for name in ("tool_known", "tool_site", "tool_left", "tool_failures"):
            shapes[name] = (stack.tool_site.shape[1],)
        for name in ("value", "rescued_at", "spoiled", "laid", "seen_site", "seen_damaged"):
            shapes[name] = (targets,)
        kinds = {"Ints": np.int64, "Floats": np.float64, "Bools": np.bool_}
        made = cls(
            **{
                f.name: np.zeros((count, *shapes.get(f.name, ())), kinds.get(str(f.type), np.uint16))
                for f in fields(cls)
            }
        )
        made.over[:] = True
        return made

    def restart(self, rows: Ints, scene: Ints, stack: Stack, chance: Floats, domain: Domain) -> None:
        """Begin new episodes in the scenes `scene` [R] at `rows` [R].

        `chance`: uniform numbers, [R, 2 + 2 TARGET_SLOTS], which choose a world out of `domain`.
        """
        for each in fields(self):
            getattr(self, each.name)[rows] = 0
        self.scene[rows] = scene
        self.place[rows], self.heading[rows] = stack.position[scene, 0], stack.heading[scene]
        for name in ("held", "missed", "goal", "rescued_at", "laid", "seen_frame", "out_at", "armed"):
            getattr(self, name)[rows] = -1
        self.pace[rows] = domain.pace[0] + chance[:, 0] * (domain.pace[1] - domain.pace[0])
        self.ease[rows] = domain.ease[0] + chance[:, 1] * (domain.ease[1] - domain.ease[0])
        anew, drawn = (part[:, : self.value.shape[1]] for part in np.split(chance[:, 2:], 2, axis=1))
        self.tool_site[rows], self.tool_left[rows] = stack.tool_site[scene], stack.tool_charge[scene]
        other = 1.0 + np.floor(drawn * MOST_VALUE) if stack.measures else np.where(drawn < 0.5, *VALUES)
        values = np.where(anew < domain.revalued, other, stack.value[scene])
        self.value[rows] = np.where(stack.there[scene], values, 0.0)

    def copies(self, rows: Ints) -> Rescues:
        """Rescues that are as `rows` [R] are now; a row may be there several times."""
        return Rescues(**{each.name: getattr(self, each.name)[rows] for each in fields(self)})

    def ease_of(self, rows: Ints, target: Ints, again: tuple[float, float]) -> Floats:
        """The factor on the share of pick-ups of `target` [R] that work, [R]; `again` as of Domain."""
        repeated = np.where(self.missed[rows] == target, *again)
        return np.asarray(self.ease[rows] * np.where(self.failures[rows, target] > 0, repeated, 1.0))

    def rescue(self, rows: Ints, target: Ints, frame: Ints) -> None:
        """Count the `target` [R] of each of `rows` [R] as safe since `frame` [R]."""
        self.rescued_at[rows, target] = frame
        total = np.maximum(self.value[rows].sum(axis=1), 1.0)
        share = np.where(self.spoiled[rows, target], DAMAGED_SHARE, 1.0) / total
        np.add.at(self.score, rows, share * self.value[rows, target])
