"""Scenes: rooms as data, furniture and objects placed by seed, and their names and splits."""
