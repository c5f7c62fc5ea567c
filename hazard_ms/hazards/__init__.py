"""Processes that change a world: parameters, state and pure kernels."""
