"""Perturbations by name: what differs from training in an evaluation, and how much, as text "lighting:2,camera:1".

The kinds are those of LIBERO-Plus (arXiv 2510.13626) without its textures of backgrounds, and control and hazard.
Levels go from 0, which changes nothing, to MOST_LEVEL; docs/benchmark.md 4.4 lists all of them. What a level changes
follows from it and from the episode's seed alone. An amount is drawn from LEAST_SHARE of the level's most to all of
it, which is more than any amount of a lower level.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

MOST_LEVEL = 3  # [ours]; LIBERO-Plus sorts its perturbations into five levels by how many of its models fail
LEAST_SHARE = 0.75  # of a level's most, that an amount is at least [-] [ours]
LONGEST = 1_000  # text that is read [characters] [ours]


@dataclass(frozen=True)
class Perturbation:
    """The level of each kind, from 0, which changes nothing, to MOST_LEVEL."""

    lighting: int = 0  # how bright and how warm light is, and from where it comes
    camera: int = 0  # where the robot's cameras are, where they look, and how wide
    objects: int = 0  # where things that move and are no targets lie
    words: int = 0  # the sentence of the task
    start: int = 0  # where the robot starts, and its heading
    noise: int = 0  # noise of the sensor in colour pictures of the robot's cameras
    control: int = 0  # how far the arm's joints go beside where they are sent, and how far a base that slips turns
    hazard: int = 0  # the severity of the hazards of `realistic`, in place of the usual one

    @classmethod
    def read(cls, text: Any) -> Perturbation:
        """The perturbation that a text such as "lighting:2,camera:1" names; the empty text names none.

        Raises ValueError for unknown kinds and levels, for a kind named twice, and for a value that is not text.
        """
        from hazard_ms.spec.checks import one_of  # loads numpy

        if not isinstance(text, str) or len(text) > LONGEST:
            raise ValueError(f"perturb must be text such as 'lighting:2,camera:1', got {text!r:.100}")
        levels: dict[str, int] = {}
        for part in text.split(",") if text else ():
            kind, _, level = (word.strip() for word in part.partition(":"))
            one_of(kind, KINDS, "a kind in perturb")
            if kind in levels:
                raise ValueError(f"perturb must name each kind once, got {kind!r} twice in {text!r:.100}")
            levels[kind] = int(one_of(level, LEVELS, f"the level of {kind} in perturb"))
        return cls(**levels)

    def __str__(self) -> str:
        """The text that names it: kinds in their order, without those of level 0."""
        return ",".join(f"{kind}:{getattr(self, kind)}" for kind in KINDS if getattr(self, kind))

    @property
    def rearranges(self) -> bool:
        """Whether it changes scenes, which have to be built anew for another seed."""
        return self.objects > 0 or self.start > 0

    def severity(self, severity: str, preset: str) -> str:
        """The severity of the hazards where `severity` is the one that was asked for.

        Raises ValueError for a level of hazard with a `preset` that has one strength only, and beside a severity.
        """
        from hazard_ms.spec.severity import SCALED, SEVERITIES, USUAL  # loads numpy

        if not self.hazard:
            return severity
        if preset != SCALED:
            raise ValueError(f"hazard in perturb must be 0 for all physics but {SCALED!r}, got {self.hazard}")
        if severity != USUAL:
            raise ValueError(
                f"severity must be {USUAL!r} beside hazard in perturb, which replaces it, got {severity!r}"
            )
        return tuple(SEVERITIES)[self.hazard - 1]


KINDS = tuple(field.name for field in fields(Perturbation))
LEVELS = tuple(str(level) for level in range(MOST_LEVEL + 1))


def canonical(text: Any) -> str:
    """The one text of all that name the same perturbation. Raises ValueError as `Perturbation.read` does."""
    return str(Perturbation.read(text)) if text != "" else ""


def amount(most: float, share: float) -> float:
    """An amount of at most `most`, in its unit; `share`, from 0 to 1, is drawn."""
    return most * (LEAST_SHARE + (1.0 - LEAST_SHARE) * share)
