"""Streets for the tests of wind: those that `hazard-ms validate` uses, too."""

from hazard_ms.validation.yard import GRAVITY, STILL, Block, Thing, Yard, begin, push, run, street

__all__ = ["GRAVITY", "STILL", "Block", "Thing", "Yard", "begin", "push", "run", "street"]
