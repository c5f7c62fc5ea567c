"""Rooms and tanks for the tests of floods: those that `hazard-ms validate` uses, too."""

from hazard_ms.validation.experiments.tank import GRAVITY, SAILS, Tank, Thing, begin, frames, on_a_plane, room

__all__ = ["GRAVITY", "SAILS", "Tank", "Thing", "begin", "frames", "on_a_plane", "room"]
