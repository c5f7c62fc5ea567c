"""Settings of proximal policy optimisation: ours over options, and those of the original's learner."""

from __future__ import annotations

from dataclasses import dataclass

from hazard_ms.sketch.environments.choices import OPTIONS
from hazard_ms.sketch.environments.choices import PAPER as SIX
from hazard_ms.sketch.environments.rewarded import PAPER as PAPER_REWARD
from hazard_ms.sketch.environments.rewarded import VALUE


@dataclass(frozen=True)
class Settings:
    """The settings of a training."""

    actions: str  # "options" or "paper"
    rescues: int  # at once
    steps: int  # decisions of each rescue between two updates
    batch: int  # decisions of a step of the optimiser
    epochs: int  # passes over the decisions of an update
    rates: tuple[float, float]  # of learning, at the beginning and at the end
    entropy: tuple[float, float]  # its coefficient in the loss, at the beginning and at the end
    discount: float
    trace: float  # GAE lambda
    clip: float
    check: int  # updates from one look at validation scenes to the next
    patience: int  # checks without a better policy after which learning ends; 0: it goes on
    scale: float  # factor on rewards: with rewards of 20 the critic's loss swamps the policy's
    decisions: int  # to learn from, unless others are asked for
    reward: str  # unless another is asked for


# [ours], all of them. Value counts what is rescued late as much as what is rescued early, hence the discount.
OURS = Settings(OPTIONS, 64, 64, 1024, 4, (7e-4, 1e-4), (0.01, 0.001), 1.0, 0.95, 0.2, 8, 0, 1.0, 1_000_000, VALUE)
# The original's [HAZARD], which has 1 rescue at once: with 16, its 32 steps in 32 batches give batches of 16
# decisions in place of 1, in which advantages can be compared. The ends and the scale are [ours].
PAPER = Settings(
    SIX, 16, 32, 16, 4, (2.5e-4, 2.5e-4), (0.01, 0.01), 0.99, 0.95, 0.1, 16, 8, 0.05, 100_000, PAPER_REWARD
)
BY_ACTIONS = {settings.actions: settings for settings in (OURS, PAPER)}
