"""Checks of laws and scenes: the cases of docs/physics.md with their expected numbers, and faults of scenes.

`hazard-ms validate` also says which cases are tests only.
"""
