"""Detectors, and how what they find in pictures becomes things that an agent knows."""
