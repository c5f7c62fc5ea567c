"""Scenes made by seed: rooms, flats and regions in the open, the same bytes on every machine."""
