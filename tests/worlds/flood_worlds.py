"""Rooms and tanks for the tests of floods: those that `hazard-ms validate` uses, too."""

from dataclasses import fields

from hazard_ms.hazards.flood.flood import Flood
from hazard_ms.validation.experiments.tank import GRAVITY, SAILS, Tank, Thing, begin, frames, room

__all__ = ["GRAVITY", "SAILS", "Tank", "Thing", "begin", "frames", "on_a_plane", "room"]


def on_a_plane(law: Flood) -> Flood:
    """A flood whose surface is a plane, and whose water acts on things as that of `law` does."""
    return Flood(**{part.name: getattr(law, part.name) for part in fields(Flood)})
