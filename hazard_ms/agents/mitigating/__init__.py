"""Agents that do something about the hazard itself: the measures that there are, and how they are done."""
