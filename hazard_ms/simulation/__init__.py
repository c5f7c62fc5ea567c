"""Scenes in the simulator: the bodies as tensors, how they are built, lit, moved and kept."""
