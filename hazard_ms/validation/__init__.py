"""Checks of the package itself: the cases of docs/physics.md, `hazard-ms validate`, which says what only tests check, and
faults of scenes, `hazard-ms scenes check`.
"""
