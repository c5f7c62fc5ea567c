"""Flood: water that rises and advances from one side, lifts, drags and soaks."""
