"""Measures what things cost: frames, kernels and effects, printed with versions and machine."""
