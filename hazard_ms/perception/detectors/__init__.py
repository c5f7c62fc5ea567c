"""Detectors that look at the picture."""
