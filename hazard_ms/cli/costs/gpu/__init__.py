"""Measures a GPU: rates of batches, how far it strays from the CPU, and where the host waits for it."""
