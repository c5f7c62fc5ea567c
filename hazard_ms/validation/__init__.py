"""The cases of docs/physics.md with their expected numbers, `hazard-ms validate`; it says which are tests only."""
