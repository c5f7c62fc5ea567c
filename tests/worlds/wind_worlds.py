"""Streets for the tests of wind: those that `hazard-ms validate` uses, too."""

from hazard_ms.validation.experiments.wind import LAW, SHIPPED, apart, box
from hazard_ms.validation.experiments.yard import GRAVITY, STILL, Block, Thing, Yard, begin, push, run, street

__all__ = [
    "LAW",
    "SHIPPED",
    "apart",
    "box",
    "GRAVITY",
    "STILL",
    "Block",
    "Thing",
    "Yard",
    "begin",
    "push",
    "run",
    "street",
]
