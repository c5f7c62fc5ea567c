"""Futures of a running episode in which something is done about the hazard, and what there is to be done."""
