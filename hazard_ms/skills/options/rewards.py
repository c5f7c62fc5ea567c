"""Rewards of the environments of skills, alike for one rescue and for many at once.

    value    what a decision rescued, as a share of the value of all targets, what is damaged half: the rewards of an
             episode add up to its score Value
    paper    that of the original's learner: the change of a potential, less what decisions and mistakes cost

The potential counts what is rescued, and how far the next thing to do is away:

    20 rescued - 10 (something is in the hand, and will go into the bag) - 10 metres

metres: to the nearest target that is neither rescued nor in the hand, wherever it is now; where carts are the safe
place and something is in the hand, to the nearest cart; 0 if there is none. It may know what the agent has not seen.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

VALUE, PAPER = "value", "paper"
REWARDS = (VALUE, PAPER)
# of the original's code, as its learner was trained [HAZARD, section 4.2]
RESCUED = 20.0  # for each rescued target
HOLDING = 10.0  # less while something is in the hand
METRE = 10.0  # less for each metre
DECISION = 0.1  # less for each decision
FORBIDDEN = 5.0  # less for a decision that cannot be taken


def potential(
    rescued: ArrayLike, holding: ArrayLike, carts: ArrayLike, to_target: ArrayLike, to_cart: ArrayLike
) -> NDArray[np.float64]:
    """The potential of the reward `paper`, [...].

    `rescued`: number of targets; `holding`: whether something is in the hand; `carts`: whether carts are the safe
    place; `to_target`, `to_cart`: distances to the nearest ones [m], 0 if there is none; [...] each.
    """
    bringing = np.logical_and(holding, carts)
    metres = np.where(bringing, to_cart, to_target)
    in_hand = np.logical_and(holding, np.logical_not(carts))
    return np.asarray(RESCUED * np.asarray(rescued) - HOLDING * in_hand - METRE * metres, np.float64)


def paper(before: Any, after: Any, allowed: ArrayLike) -> NDArray[np.float64]:
    """The reward `paper` of decisions between two potentials, [...]; `allowed`: whether they could be taken."""
    return np.asarray(after - before - DECISION - np.where(allowed, 0.0, FORBIDDEN), np.float64)
