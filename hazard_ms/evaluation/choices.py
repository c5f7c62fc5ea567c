"""Names that help texts and the completion of shells offer for an option.

Other values are let through to the check of the option, which accepts what a third party registered and names the
nearest name for what is unknown. Nothing heavy is imported, so that help is quick.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import tyro
from tyro.constructors import PrimitiveConstructorSpec

# As hazards.presets, spec.severity, simulation.lighting, env and scenes.splits name them; tests/cli compares them.
PRESETS = ("paper", "shipped", "realistic")
SEVERITIES = ("moderate", "severe", "extreme")
LIGHTINGS = ("day", "evening", "night", "failing", "random")
EFFECTS = ("full", "fast", "off")
SPLITS = ("train", "test", "large", "new_objects", "hard", "held_out")

BACKENDS = ("serial", "local", "ray")  # where episodes are played
AVERTED = ("task", "yes", "no")  # whether sweeps tell what is averted
HUMAN = "human"  # the agent of episodes that people played: no choice, nobody could ask it


class Offered(tuple[str, ...]):
    """Names that are offered but not enforced: any text counts as one of them."""

    def __contains__(self, _: object) -> bool:
        return True


def offer(names: Iterable[str], other: str = "") -> PrimitiveConstructorSpec[str]:
    """A rule for tyro: read any text, and offer `names`; `other` describes what is accepted besides."""
    offered = Offered(names)
    return PrimitiveConstructorSpec(
        nargs=1,
        metavar="{" + ",".join([*offered, *([other] if other else [])]) + "}",
        instance_from_str=lambda words: words[0],
        is_instance=lambda value: isinstance(value, str),
        str_from_instance=lambda value: [value],
        choices=offered,
    )


def flag(*spellings: str, old: str | None = None) -> Any:
    """Further spellings of an option: a short one, and one of `old`.

    Help texts show tyro's name last. Where there is an old spelling, that is tyro's name, and `spellings` hold the
    option's own.
    """
    return tyro.conf.arg(name=old, aliases=list(spellings))
